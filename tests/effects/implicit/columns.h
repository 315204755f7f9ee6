// Buffers of the implicit method as the columns of the reference.
#pragma once

#include "engine/reference/implicit.h"
#include "tests/support/single_pass.h"

namespace weft {

inline reference::Columns columns(const std::vector<gpu::vec4>& values, std::size_t first, std::size_t count) {
  reference::Columns made(3, count);
  for (std::size_t i = 0; i < count; ++i) made.col(static_cast<Eigen::Index>(i)) = vector(values[first + i]);
  return made;
}

inline double largest(const reference::Columns& values) { return values.colwise().norm().maxCoeff(); }

// A particle's sum has some 24 terms of up to 16 operations each; those that cancel are up to eight times what is left.
inline constexpr double kSummed = 24 * 16 * 8 * kRounding / 4;

// The passes of an iteration of conjugate gradients.
inline void iterate_gradients(SinglePass& passes, int iteration, const CookedFabric& fabric) {
  passes.run("implicit_multiply", iteration);
  passes.run("implicit_advance", iteration);
  const LevelLists& lists = fabric.own.of<LevelLists>();
  if (lists.ends.empty()) return;
  const int wide = static_cast<int>(lists.ends.size() - lists.low);
  passes.run("implicit_mean", iteration);
  for (int k = 0; k + 1 < wide; ++k) passes.run("implicit_mean_wide", iteration * (wide - 1) + k);
  passes.run("implicit_low", iteration);
  for (int k = 0; k < wide; ++k) passes.run("implicit_wide", iteration * wide + k);
  passes.run("implicit_spread", iteration);
}

}  // namespace weft
