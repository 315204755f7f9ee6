// Particles that colliders hold, for kernels and their twins (shaders/support/support.glsl).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "engine/effects/support/support.h"
#include "shaders/support/support.ref.h"
#include "tests/support/single_pass.h"

namespace weft {

/// A collider that holds cloth, far away.
inline void let_colliders_hold(Scene& scene, CookedFabric& fabric) {
  scene.colliders.resize(1);
  scene.colliders[0].centre = {0, -100, 0};
  fabric.own.of<SupportLists>().holds = true;
}

/// Every third particle has been put out, by up to 5 mm; of every sixth the solve has held 1 mm.
inline reference::Supports put_supports(SinglePass& passes, Random& random, const CookedFabric& fabric) {
  std::vector<gpu::vec4> values(fabric.positions.size());
  reference::Supports supports;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % 3 == 0 && fabric.positions[i].w > 0) values[i] = anywhere(random, 0.003, i % 2 == 0 ? 0 : 0.001f);
    supports.put_out.push_back(vector(values[i]));
    supports.held.push_back(values[i].w);
  }
  passes.put(buffers::supports, values);
  return supports;
}

/// m, of how much of steps was held.
inline double largest_gap_of_held(const SinglePass& passes, const reference::Supports& supports) {
  const auto values = passes.particles(buffers::supports);
  double gap = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double here = std::abs(values[i].w - supports.held[i]);
    gap = std::isfinite(here) ? std::max(gap, here) : INFINITY;
  }
  return gap;
}

/// By so much that their patch hands on momentum.
inline bool holds_any(const reference::Supports& supports, std::span<const std::uint32_t> members) {
  return std::ranges::any_of(members, [&](std::uint32_t i) { return reference::support_from(supports.put_out[i]).squaredNorm() > 0.1; });
}

}  // namespace weft
