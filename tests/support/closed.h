// Closed meshes for the tests of what is inside them.
#pragma once

#include <cmath>
#include <map>

#include "engine/simulation.h"
#include "tests/support/must.h"
#include "tests/support/without_contacts.h"

namespace weft {

/// Points on a sphere: an octahedron whose triangles are cut into four so many times.
inline Mesh ball(double radius, int cuts, Vec3 centre = {}) {
  std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> triangles = {{0, 2, 4}, {4, 2, 1}, {1, 2, 5}, {5, 2, 0}, {4, 3, 0}, {1, 3, 4}, {5, 3, 1}, {0, 3, 5}};
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (is_new) points.push_back(points[a] + points[b]);
      Vec3& p = points[at->second];
      p = (1 / length(p)) * p;
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  RenderMesh render;
  for (const Vec3& p : points) render.positions.push_back(static_cast<float>(radius) * p + centre);
  render.triangles = triangles;
  return must(weld_mesh(std::move(render)));
}

/// The sphere of degrees of latitude and longitude that engines make: `segments` thin triangles about either pole.
inline Mesh globe(double radius, std::uint32_t segments, std::uint32_t rings) {
  RenderMesh render;
  const auto at = [&](std::uint32_t ring, std::uint32_t segment) {   // 0: the north pole
    const double down = M_PI * ring / rings, around = 2 * M_PI * segment / segments;
    const double x = std::sin(down) * std::cos(around), z = std::sin(down) * std::sin(around);
    return Vec3{static_cast<float>(radius * x), static_cast<float>(radius * std::cos(down)), static_cast<float>(radius * z)};
  };
  render.positions = {at(0, 0), at(rings, 0)};
  for (std::uint32_t ring = 1; ring < rings; ++ring)
    for (std::uint32_t segment = 0; segment < segments; ++segment) render.positions.push_back(at(ring, segment));
  const auto number = [&](std::uint32_t ring, std::uint32_t segment) {
    return ring == 0 ? 0 : ring == rings ? 1 : 2 + (ring - 1) * segments + segment % segments;
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
      const std::uint32_t a = number(ring, segment), b = number(ring, segment + 1), c = number(ring + 1, segment), d = number(ring + 1, segment + 1);
      if (ring > 0) render.triangles.push_back({a, b, c});
      if (ring + 1 < rings) render.triangles.push_back({b, d, c});
    }
  return must(weld_mesh(std::move(render)));
}

/// A free cloth that holds a gas, without gravity, damping or bending; its mesh is given to create.
inline Scene gas_scene(const Gas& gas = {}) {
  Scene scene = without_contacts();
  scene.gravity = {};
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.pressure = gas;
  cloth.bending = false;
  cloth.fabric.damping = 0;
  cloth.start.imperfection = 0;
  return scene;
}

}  // namespace weft
