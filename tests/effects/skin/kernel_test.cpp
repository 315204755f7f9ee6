// The pass skin against its twin.
#include <gtest/gtest.h>

#include "shaders/skin/skin.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

using KernelSkin = GpuTest;

Affine any_map(Random& random) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) map.matrix()(r, c) = between(random, -1, 1);
  return narrowed(map);
}

// Random joints, weights and places; anchors get targets, free particles their animated places and backstops.
TEST_F(KernelSkin, does_what_its_twin_does) {
  Random random(7);
  for (const bool storage : {false, true}) {
    Scene scene = sheet(9);
    scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
    scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = 0.3, .backstop_distance = 0.02, .backstop_radius = 0.5};
    std::vector<Mesh> meshes = must(make_meshes(scene));
    meshes[0].skin = two_joints(meshes[0]);
    for (std::size_t k = 0; k < 6; ++k) meshes[0].skin->joints.push_back({"", 0, {}});
    for (std::size_t p = 0; p < meshes[0].points.size(); ++p) {
      double sum = 0;
      std::array<double, 4> weights;
      for (double& w : weights) sum += w = between(random, 0, 1);
      for (std::size_t k = 0; k < 4; ++k) {
        meshes[0].skin->joints_of[p][k] = static_cast<std::uint16_t>(random() % 8);
        meshes[0].skin->weights[p][k] = static_cast<float>(weights[k] / sum);
      }
    }
    const CookedFabric fabric = must(cook(scene, meshes));
    const auto& points = fabric.own.of<SkinLists>().points;
    ASSERT_EQ(points.size(), fabric.positions.size());
    std::vector<gpu::Joint> joints;
    std::vector<Eigen::Affine3d> from, to;
    for (int k = 0; k < 8; ++k) {
      const Affine a = any_map(random), b = any_map(random);
      joints.push_back(joint_between(a, b));
      from.push_back(widened(a));
      to.push_back(widened(b));
    }
    joints[3] = joint_between({{}, {}, {}, {}}, {{}, {}, {}, {}});   // takes all to one place
    from[3].matrix().topRows(3).setZero();
    to[3].matrix().topRows(3).setZero();
    const gpu::MotionLimits limits{1.5f, 0.25f};

    SinglePass passes(device(), scene, fabric, storage);
    FrameInput input = frame_of(4);
    input.joints = joints;
    input.motion_limits = std::span(&limits, 1);
    const auto anchors = anchors_at_rest(fabric, 0);
    input.anchors = anchors;
    input.anchors_move = true;
    passes.begin(input);
    passes.run("skin");
    const auto targets = passes.get<gpu::vec4>(buffers::motion_targets, 4 * fabric.positions.size());
    const auto told = passes.get<gpu::Anchor>(buffers::anchors, fabric.anchors.size());
    for (const gpu::SkinPoint& point : points) {
      SCOPED_TRACE(point.particle);
      const std::array<std::uint32_t, 4> of{point.joints.x & 0xffff, point.joints.x >> 16, point.joints.y & 0xffff, point.joints.y >> 16};
      const std::array<double, 4> weights{point.weights.x, point.weights.y, point.weights.z, point.weights.w};
      const auto blend_from = reference::blend(from, of, weights), blend_to = reference::blend(to, of, weights);
      const reference::Vector x_from = blend_from * vector(point.rest), x_to = blend_to * vector(point.rest);
      if (point.anchor != WEFT_NONE) {
        EXPECT_LT((vector(told[point.anchor].from) - x_from).norm(), 40 * kRounding);
        EXPECT_LT((vector(told[point.anchor].to) - x_to).norm(), 40 * kRounding);
        EXPECT_EQ(told[point.anchor].particle, point.particle);
        continue;
      }
      const gpu::vec4* target = &targets[4 * point.particle];
      EXPECT_LT((vector(target[0]) - x_from).norm(), 40 * kRounding);
      EXPECT_LT((vector(target[1]) - x_to).norm(), 40 * kRounding);
      EXPECT_FLOAT_EQ(target[0].w, 0.45f);
      EXPECT_EQ(target[1].w, 0.25f);
      EXPECT_EQ(target[2].w, 0.5f);
      const auto behind = [&](const reference::Vector& x, const Eigen::Affine3d& map) {
        return reference::Vector(x - 0.52 * (map.linear() * vector(point.normal)).normalized());
      };
      // A short normal turns far by rounding.
      const double size = (blend_from.linear() * vector(point.normal)).norm(), size_to = (blend_to.linear() * vector(point.normal)).norm();
      EXPECT_LT((vector(target[2]) - behind(x_from, blend_from)).norm(), 60 * kRounding / std::min(1.0, size));
      EXPECT_LT((vector(target[3]) - behind(x_to, blend_to)).norm(), 60 * kRounding / std::min(1.0, size_to));
    }
  }
}

// A frame begins to the bit where the one before has ended.
TEST_F(KernelSkin, frames_join_to_the_bit) {
  Random random(8);
  Scene scene = sheet(9);
  scene.cloths[0].motion_constraints.emplace();
  std::vector<Mesh> meshes = must(make_meshes(scene));
  meshes[0].skin = two_joints(meshes[0]);
  const CookedFabric fabric = must(cook(scene, meshes));
  SinglePass passes(device(), scene, fabric);
  const std::array maps{any_map(random), any_map(random), any_map(random), any_map(random)};
  const gpu::MotionLimits limits{1, 1};
  std::vector<gpu::vec4> before;
  for (int frame = 0; frame < 2; ++frame) {
    const std::vector<gpu::Joint> joints{joint_between(maps[frame], maps[frame + 1]), joint_between(maps[frame + 1], maps[frame + 2])};
    FrameInput input = frame_of(4);
    input.joints = joints;
    input.motion_limits = std::span(&limits, 1);
    passes.begin(input);
    passes.run("skin");
    const auto targets = passes.get<gpu::vec4>(buffers::motion_targets, 4 * fabric.positions.size());
    for (std::size_t k = 0; k < before.size(); k += 4) {
      EXPECT_EQ(before[k + 1].x, targets[k].x);
      EXPECT_EQ(before[k + 1].y, targets[k].y);
      EXPECT_EQ(before[k + 1].z, targets[k].z);
    }
    before = targets;
  }
}

}  // namespace
}  // namespace weft
