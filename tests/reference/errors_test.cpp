// Errors between runs, and what is measured on one pose: known shifts, stretches and turns; and that the reference keeps what it
// should keep.
#include "engine/reference/errors.h"

#include <Eigen/Geometry>

#include "tests/support/reference_scenes.h"

namespace weft::reference {
namespace {

TEST(Errors, a_shifted_run_is_wrong_by_the_shift_relative_to_the_sheet) {
  Scene scene = hung_sheet(4, true);
  scene.cloths[0].grid->size = {2, 0.5f};
  const CookedFabric fabric = cooked(scene);
  EXPECT_DOUBLE_EQ(sheet_size(fabric), 2);
  const Trajectory run = reference::run(scene, fabric, 4, fabric.h);
  EXPECT_EQ(run_error(run, run, sheet_size(fabric)), 0);
  Trajectory shifted = run;
  for (Positions& pose : shifted.poses) pose.colwise() += Eigen::Vector3d(0.03, 0, 0.04);
  EXPECT_NEAR(run_error(shifted, run, sheet_size(fabric)), 0.025, 1e-15);
  shifted.poses.pop_back();   // of the frames that both have
  EXPECT_NEAR(run_error(shifted, run, sheet_size(fabric)), 0.025, 1e-15);
  const Errors errors = errors_of(shifted, run, run, sheet_size(fabric));
  EXPECT_NEAR(errors.solver, 0.025, 1e-15);
  EXPECT_EQ(errors.time, 0);
}

TEST(Errors, strain_of_a_pose_is_that_of_the_same_positions_on_the_gpu) {
  const Scene scene = hung_sheet(6, true);
  const CookedFabric fabric = cooked(scene);
  std::vector<gpu::vec4> positions = fabric.positions;
  for (gpu::vec4& p : positions) p = {1.1f * p.x, p.y + 0.2f * p.x * p.x, p.z, p.w};
  const Strain gpu = weft::measure_strain(fabric, positions), pose = measure_strain(fabric, pose_of(fabric, positions));
  EXPECT_NEAR(pose.mean, gpu.mean, 1e-14);
  EXPECT_NEAR(pose.rms, gpu.rms, 1e-14);
  EXPECT_NEAR(pose.max, gpu.max, 1e-14);
}

// One particle of 2 kg at (1, 0, 0) that moves with 3 m/s along y, on a link of 0.01 m/N that is 0.1 m too long.
TEST(Errors, a_particle_has_the_energy_and_momentum_of_its_formulas) {
  Chain one = chain(1, 1, 2, 0.01, false);
  one.fabric.links[0].rest = 0.9f;
  Positions before(3, 2), after(3, 2);
  before << 0, 1, 0, -0.3, 0, 0;
  after << 0, 1, 0, 0, 0, 0;
  const Balance balance = balance_of(one.fabric, before, after, 0.1, {-10, 0, 0});
  EXPECT_TRUE(balance.momentum.isApprox(Eigen::Vector3d(0, 6, 0)));
  EXPECT_TRUE(balance.angular_momentum.isApprox(Eigen::Vector3d(0, 0, 6)));
  EXPECT_NEAR(balance.kinetic, 9, 1e-12);
  EXPECT_NEAR(balance.elastic, 0.5, 1e-6);   // the length is 0.9f
  EXPECT_NEAR(balance.height, 20, 1e-12);
  EXPECT_NEAR(balance.energy(), 29.5, 1e-6);
}

// A free, unevenly stretched sheet. Implicit steps only lose energy. (They do not keep the angular momentum: it changes by
// h sum m v_{n+1} x v_n a step.)
TEST(Errors, the_reference_keeps_momentum_and_never_gains_energy) {
  Scene scene = hung_sheet(6, false);
  scene.gravity = {0, 0, 0};
  scene.cloths[0].anchors.clear();
  CookedFabric fabric = cooked(scene);
  for (gpu::vec4& p : fabric.positions) p = {p.x + 0.2f * p.x * p.x + 0.1f * p.x * p.z, 0.05f * p.x * p.z, p.z * (1.05f + 0.1f * p.x), p.w};
  scene.solver.rate = 600;   // a pose a step
  const Trajectory free = run(scene, fabric, 60, fabric.h);
  double before = INFINITY;
  for (std::size_t k = 1; k < free.poses.size(); ++k) {
    const Balance balance = balance_of(fabric, free.poses[k - 1], free.poses[k], fabric.h, scene.gravity);
    // To the tolerance of a step, relative to what goes to and fro: 0.12 kg with up to 10 m/s.
    EXPECT_LT(balance.momentum.norm(), 1e-9);
    EXPECT_LT(balance.energy(), before);
    before = balance.energy();
  }
}

}  // namespace
}  // namespace weft::reference
