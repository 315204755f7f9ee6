// The reference as a program: it converges, keeps anchors, and refuses what it has no energies for.
#include "engine/reference/block_factor.h"
#include "engine/reference/energies.h"
#include "tests/support/reference_scenes.h"

namespace weft::reference {
namespace {

TEST(Reference, every_step_of_a_hung_sheet_converges) {
  for (const bool rigid : {false, true}) {
    Scene scene = hung_sheet(8, false);
    if (rigid) scene.cloths[0].fabric.stretch = scene.cloths[0].fabric.shear = INFINITY;
    const CookedFabric fabric = cooked(scene);
    const Trajectory trajectory = run(scene, fabric, 6, fabric.h);
    ASSERT_EQ(trajectory.poses.size(), 6u);
    EXPECT_DOUBLE_EQ(trajectory.frame_seconds, 1.0 / 60);
    EXPECT_LT(trajectory.poses.back().row(1).minCoeff(), -0.01) << "it does not fall";
  }
}

TEST(Reference, anchors_are_where_the_scene_has_them) {
  Scene scene = hung_sheet(4, true);
  scene.cloths[0].anchors[0].keys = {{0, {}, {0, 1, 0}, 0}, {0.1, {0.3f, 0.2f, -0.1f}, {0, 1, 0}, 40}};
  const CookedFabric fabric = cooked(scene);
  const Trajectory trajectory = run(scene, fabric, 5, fabric.h);
  for (std::size_t frame = 0; frame < trajectory.poses.size(); ++frame) {
    const auto targets = anchor_targets(scene, fabric, static_cast<double>(frame + 1) / 60);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const auto place = trajectory.poses[frame].col(fabric.anchors[k].particle);
      EXPECT_EQ(place, Eigen::Vector3d(targets[k].x, targets[k].y, targets[k].z)) << "frame " << frame << ", anchor " << k;
    }
  }
}

TEST(Reference, what_it_has_no_energy_for_is_refused_with_a_sentence) {
  Scene scene = hung_sheet(4, true);
  const CookedFabric fabric = cooked(scene);
  const auto refusal = [&](double h) {
    const auto trajectory = integrate_newton(scene, fabric, 1, {.h = h});
    return trajectory ? "none" : trajectory.error();
  };
  EXPECT_EQ(refusal(0.01), "a step of 0.01 s does not divide a frame of 0.0166667 s into whole steps");
  Scene folded = scene;
  folded.cloths[0].bending = true;
  folded.cloths[0].bend_rest = BendRest::mesh;
  const auto hinged = integrate_newton(folded, cooked(folded), 1, {.h = fabric.h});
  EXPECT_EQ(hinged ? "taken" : hinged.error(), "bend_rest: the reference has none");
  Scene contact_scene = scene;
  contact_scene.contacts.enabled = true;
  const auto with_contacts = integrate_newton(contact_scene, cooked(contact_scene), 1, {.h = fabric.h});
  EXPECT_EQ(with_contacts ? "taken" : with_contacts.error(), "contacts: the reference has none");
  scene.colliders.emplace_back();
  EXPECT_EQ(refusal(fabric.h), "colliders: the reference has none");
}

TEST(Reference, a_run_can_be_stopped) {
  const Scene scene = hung_sheet(4, true);
  const CookedFabric fabric = cooked(scene);
  double last = 0;
  const auto trajectory = integrate_newton(scene, fabric, 4, {.h = fabric.h}, [&](double done) {
    EXPECT_GT(done, last);
    last = done;
    return done < 0.5;
  });
  ASSERT_FALSE(trajectory);
  EXPECT_EQ(trajectory.error(), "the reference was stopped in frame 1 of 4");
}

// A link that only pulls lets its end come nearer and go no farther; so does a tether.
TEST(Reference, one_sided_links_let_go) {
  Chain free = chain(1, 1, 0.1, 0, false);
  free.fabric.links[0].only_pulls = true;
  free.fabric.positions[1] = {0.5f, 0, 0, 10};   // slack
  const double h = 1.0 / 600;
  const Trajectory fall = run(free.scene, free.fabric, 30, h);
  for (int frame = 0; frame < 30; ++frame) {
    const double n = 10 * (frame + 1), fallen = -free.scene.gravity.y * h * h * n * (n + 1) / 2, length = fall.poses[frame].col(1).norm();
    EXPECT_LE(length, 1 + kSoftening * 0.1);   // it is stopped within a step from 5 m/s: by less than 0.1 m
    if (std::hypot(0.5, fallen) < 1) {
      EXPECT_NEAR(fall.poses[frame](1, 1), -fallen, 1e-12) << "slack, and yet it pulls";
    }
  }
  Chain tethered = free;
  tethered.fabric.links.clear();
  tethered.fabric.tethers = {{WEFT_NONE, 0}, {WEFT_NONE, 0}, {0, 1}, {WEFT_NONE, 0}};
  tethered.fabric.tethers_per_particle = 2;
  const Trajectory same = run(tethered.scene, tethered.fabric, 30, h);
  EXPECT_EQ((fall.poses.back() - same.poses.back()).norm(), 0);
}

// A chain of stiff blocks, ordered by itself: its factor is in single precision, which is the error of what it gives back.
TEST(Reference, its_factor_solves_a_system_of_blocks) {
  constexpr std::uint32_t kCount = 40;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 1; i < kCount; ++i) pairs.emplace_back(i, (i * 7) % i);
  BlockFactor factor(kCount, pairs);
  std::srand(1);   // Eigen's Random
  const Positions x = Positions::Random(3, kCount);
  for (const double scale : {1.0, 100.0}) {   // twice, so that nothing is left of the first
    Positions r = x;
    factor.clear();
    for (std::uint32_t i = 0; i < kCount; ++i) factor.add(i, i, Eigen::Matrix3d::Identity());
    for (const auto& [a, b] : pairs) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Random();
      const Eigen::Matrix3d block = scale * direction * direction.transpose();
      factor.add(a, a, block);
      factor.add(b, b, block);
      factor.add(a, b, -block);
      const Eigen::Vector3d pull = block * (x.col(a) - x.col(b));
      r.col(a) += pull;
      r.col(b) -= pull;
    }
    ASSERT_TRUE(factor.factorise());
    EXPECT_LT((factor.solve(r) - x).norm(), 1e-6 * std::sqrt(3 * scale) * x.norm());
  }
}

}  // namespace
}  // namespace weft::reference
