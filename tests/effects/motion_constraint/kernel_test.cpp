// Motion constraints against their twin.
#include <gtest/gtest.h>

#include "engine/finite.h"
#include "shaders/motion_constraint/motion_constraint.ref.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelMotionConstraint = GpuTest;

// Particles anywhere about animated places and backstops anywhere, in every substep of a frame; and at the places themselves.
TEST_F(KernelMotionConstraint, does_what_its_twin_does) {
  Random random(11);
  constexpr std::uint32_t kCount = 600, kSubsteps = 4;
  Scene scene = loose_scene(kSubsteps);
  scene.solver.method = Method::jacobi;
  scene.cloths.emplace_back().motion_constraints.emplace().backstop_radius = 1;
  for (const bool storage : {false, true})
    for (int substep = 0; substep < static_cast<int>(kSubsteps); ++substep) {
      const CookedFabric fabric = loose_particles(random, kCount, scene.solver);
      std::vector<gpu::vec4> targets, p;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        const float max_distance = i % 7 == 0 ? 0 : i % 7 == 1 ? kTooLarge : static_cast<float>(between(random, 0, 0.5));
        targets.push_back(anywhere(random, 1, max_distance));
        targets.push_back(anywhere(random, 1, i % 5 == 0 ? 1 : static_cast<float>(between(random, 0, 1))));
        targets.push_back(anywhere(random, 1, i % 3 == 0 ? 0 : static_cast<float>(between(random, 0, 1))));
        targets.push_back(anywhere(random, 1, 0));
        p.push_back(anywhere(random, 1, fabric.positions[i].w));
        if (i % 11 == 2) {   // right at its place; right in the middle of its backstop
          targets[4 * i] = targets[4 * i + 1] = p[i];
          targets[4 * i].w = 0, targets[4 * i + 1].w = 1;
        }
        if (i % 11 == 5) targets[4 * i + 2].x = targets[4 * i + 3].x = p[i].x;
      }
      SinglePass passes(device(), scene, fabric, storage);
      passes.put(buffers::motion_targets, targets);
      passes.put(buffers::velocities, leading_to(p, fabric));
      passes.begin(frame_of(kSubsteps));
      passes.put_iterate(p);
      passes.run("stretch", substep);
      const auto after = passes.particles(buffers::positions);
      const double fraction = (substep + 1.0) / kSubsteps;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        const auto at = [&](std::uint32_t k) {
          const auto from = vector(targets[4 * i + k]), to = vector(targets[4 * i + k + 1]);
          return reference::Vector(from + fraction * (to - from));
        };
        const reference::MotionConstraint constraint{at(0), at(2), targets[4 * i].w, targets[4 * i + 1].w, targets[4 * i + 2].w};
        const reference::Vector wanted =
            fabric.positions[i].w == 0 ? vector(p[i]) : reference::within_motion_constraint(constraint, vector(p[i]));
        // A direction of a short vector is as exact as the vector is: a thousandth of its length, a thousand times as far.
        const double near = std::min((vector(p[i]) - constraint.stop).norm(), 1.0);
        EXPECT_LT((vector(after[i]) - wanted).norm(), 30 * kRounding / std::max(near, 1e-3)) << i;
      }
    }
}

}  // namespace
}  // namespace weft
