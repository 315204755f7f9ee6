// Scenes for the tests of the reference: cooked sheets, and fabrics put together by hand of particles and links.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/reference/trajectory.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {

/// A square sheet of 1 m without damping or tethers, hung from two corners of its top.
inline Scene hung_sheet(std::uint32_t cells, bool upright) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, upright};
  cloth.fabric.damping = 0;
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  return scene;
}

/// Particles one after another along +x from the origin, each linked to the one before; the first is held, and the last if asked.
struct Chain {
  Scene scene = without_contacts();           // of one undamped cloth, at 60 Hz
  CookedFabric fabric;
};
inline Chain chain(std::uint32_t links, double link_length, double particle_mass, double compliance, bool hold_last) {
  Chain made;
  made.scene.cloths.emplace_back().fabric.damping = 0;
  for (std::uint32_t i = 0; i <= links; ++i) {
    const bool held = i == 0 || (hold_last && i == links);
    const Vec3 place{static_cast<float>(i * link_length), 0, 0};
    made.fabric.positions.push_back({place.x, place.y, place.z, held ? 0 : static_cast<float>(1 / particle_mass)});
    made.fabric.velocities.push_back({0, 0, 0, std::bit_cast<float>(0u)});
    if (held) made.fabric.anchors.push_back({0, 0, i, i, place});
    if (i > 0) made.fabric.links.push_back({i - 1, i, static_cast<float>(link_length), static_cast<float>(compliance), false});
  }
  made.scene.cloths[0].anchors.emplace_back();
  made.fabric.cloths.push_back({"chain", 0, links + 1, 0, 0, 0, static_cast<std::uint32_t>(made.fabric.anchors.size())});
  return made;
}

inline Trajectory run(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, double h) {
  auto trajectory = integrate_newton(scene, fabric, frames, {.h = h});
  EXPECT_TRUE(trajectory) << trajectory.error();
  EXPECT_EQ(trajectory->not_converged, 0u);
  return std::move(*trajectory);
}

}  // namespace weft::reference
