// The pass skin with morph targets against its twin.
#include <gtest/gtest.h>

#include "shaders/skin/skin.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

using KernelSkinMorphs = GpuTest;
using reference::Vector;

// A sheet with backstops, held at two corners, with two joints and morph targets that move any of its points anywhere.
struct Morphing {
  Scene scene;
  std::vector<Mesh> meshes;
  CookedFabric fabric;
};

Morphing morphing(Random& random, std::size_t targets) {
  Morphing made;
  made.scene = sheet(9);
  made.scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  made.scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = 0.3, .backstop_distance = 0.02, .backstop_radius = 0.5};
  made.meshes = must(make_meshes(made.scene));
  Skin& skin = made.meshes[0].skin.emplace(two_joints(made.meshes[0]));
  const auto any = [&] { return static_cast<float>(between(random, -1, 1)); };
  for (std::size_t m = 0; m < targets; ++m) {
    Skin::Morph& morph = skin.morphs.emplace_back();
    for (std::uint32_t p = 0; p < made.meshes[0].points.size(); ++p) {
      if (random() % 3 == 0) continue;
      morph.points.push_back(p);
      morph.deltas.push_back({any(), any(), any()});
      if (m != 1) morph.normal_deltas.push_back({any(), any(), any()});
    }
  }
  made.fabric = must(cook(made.scene, made.meshes));
  return made;
}

struct Told {
  std::vector<gpu::vec4> targets;
  std::vector<gpu::Anchor> anchors;
};

Told told(const compute::Device& device, const Morphing& made, const std::vector<gpu::Joint>& joints, const std::vector<gpu::vec2>& weights,
          bool storage) {
  SinglePass passes(device, made.scene, made.fabric, storage);
  const gpu::MotionLimits limits{1, 1};
  FrameInput input = frame_of(4);
  input.joints = joints;
  input.morph_weights = weights;
  input.motion_limits = std::span(&limits, 1);
  const auto anchors = anchors_at_rest(made.fabric, 0);
  input.anchors = anchors;
  input.anchors_move = true;
  passes.begin(input);
  passes.run("skin");
  return {passes.get<gpu::vec4>(buffers::motion_targets, 4 * made.fabric.positions.size()),
          passes.get<gpu::Anchor>(buffers::anchors, made.fabric.anchors.size())};
}

// Random deltas, normals and weights, also 0, below 0 and above 1.
TEST_F(KernelSkinMorphs, does_what_its_twin_does) {
  Random random(11);
  for (const bool storage : {false, true})
    for (const std::size_t targets : {1u, 7u}) {
      const Morphing made = morphing(random, targets);
      const auto& lists = made.fabric.own.of<SkinLists>();
      ASSERT_EQ(lists.morph_rows.size(), lists.points.size());
      const Affine from = moved_by({0.1f, 0.2f, 0.3f}), to = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 2}, {0, 0.5f, 0}};
      std::vector<gpu::vec2> weights;
      for (std::size_t m = 0; m < targets; ++m)
        weights.push_back(m == 2 ? gpu::vec2{0, 0} : gpu::vec2{static_cast<float>(between(random, -2, 2)), static_cast<float>(between(random, 0, 1))});
      const Told got = told(device(), made, {joint_between(from, to), joint_between(from, to)}, weights, storage);
      for (std::size_t k = 0; k < lists.points.size(); ++k) {
        const gpu::SkinPoint& point = lists.points[k];
        SCOPED_TRACE(point.particle);
        std::vector<Vector> deltas, turns;
        std::vector<double> w[2];
        for (std::uint32_t at = lists.morph_rows[k].x; at < lists.morph_rows[k].x + lists.morph_rows[k].y; ++at) {
          deltas.push_back(vector(lists.morph_deltas[at].position));
          turns.push_back(vector(lists.morph_normals[at]));
          w[0].push_back(weights[lists.morph_deltas[at].morph].x);
          w[1].push_back(weights[lists.morph_deltas[at].morph].y);
        }
        // A few sums of numbers of up to 20: the morphed place, and the map.
        const double tolerance = 400 * kRounding;
        Vector x[2], stop[2];
        for (int end = 0; end < 2; ++end) {
          const Eigen::Affine3d map = widened(end == 0 ? from : to);
          x[end] = map * reference::morphed(vector(point.rest), deltas, w[end]);
          stop[end] = map.linear() * reference::morphed(vector(point.normal), turns, w[end]);
        }
        if (point.anchor != WEFT_NONE) {
          EXPECT_LT((vector(got.anchors[point.anchor].from) - x[0]).norm(), tolerance);
          EXPECT_LT((vector(got.anchors[point.anchor].to) - x[1]).norm(), tolerance);
          continue;
        }
        for (int end = 0; end < 2; ++end) {
          EXPECT_LT((vector(got.targets[4 * point.particle + end]) - x[end]).norm(), tolerance);
          // A short normal turns far by rounding.
          EXPECT_LT((vector(got.targets[4 * point.particle + 2 + end]) - (x[end] - 0.52 * stop[end].normalized())).norm(),
                    tolerance / std::min(1.0, stop[end].norm()));
        }
      }
    }
}

// Weights of 0 are the base shape to the bit, and a normal that its targets take away points up.
TEST_F(KernelSkinMorphs, weights_of_zero_change_nothing_and_a_normal_without_a_length_points_up) {
  Random random(12);
  Morphing made = morphing(random, 3);
  const std::vector<gpu::Joint> joints(2, joint_between(moved_by({0, 1, 0}), moved_by({1, 0, 0})));
  const Told morphed = told(device(), made, joints, std::vector<gpu::vec2>(3), false);
  made.meshes[0].skin->morphs.clear();
  made.fabric = must(cook(made.scene, made.meshes));
  const Told plain = told(device(), made, joints, {}, false);
  for (std::size_t k = 0; k < plain.targets.size(); ++k) {
    EXPECT_EQ(morphed.targets[k].x, plain.targets[k].x) << k;
    EXPECT_EQ(morphed.targets[k].y, plain.targets[k].y) << k;
    EXPECT_EQ(morphed.targets[k].z, plain.targets[k].z) << k;
  }
  made.meshes[0].skin->morphs = {{"", 0, {50}, {{0, 0, 0}}, {{0, -1, 0}}}};   // its normal is (0, 1, 0)
  made.fabric = must(cook(made.scene, made.meshes));
  const auto& lists = made.fabric.own.of<SkinLists>();
  const Told flat = told(device(), made, joints, {{1, 1}}, false);
  for (std::size_t k = 0; k < lists.points.size(); ++k)
    if (lists.morph_rows[k].y > 0) {
      const gpu::vec4* target = &flat.targets[4 * lists.points[k].particle];
      EXPECT_NEAR(target[0].y - target[2].y, 0.52f, 1e-6f);
    }
}

// A frame begins to the bit where the one before has ended.
TEST_F(KernelSkinMorphs, frames_join_to_the_bit) {
  Random random(13);
  const Morphing made = morphing(random, 5);
  std::vector<float> w[3];
  for (auto& frame : w)
    for (int m = 0; m < 5; ++m) frame.push_back(static_cast<float>(between(random, -1, 1)));
  const Affine at[] = {moved_by({0.3f, 0, 0}), moved_by({0, 0.7f, 0.1f}), moved_by({0.2f, 0.2f, 0})};
  std::vector<Told> frames;
  for (int f = 0; f < 2; ++f) {
    std::vector<gpu::vec2> weights;
    for (std::size_t m = 0; m < 5; ++m) weights.push_back({w[f][m], w[f + 1][m]});
    frames.push_back(told(device(), made, std::vector<gpu::Joint>(2, joint_between(at[f], at[f + 1])), weights, false));
  }
  for (std::size_t k = 0; k < frames[0].targets.size(); k += 2) {   // places, and then centres of backstops
    EXPECT_EQ(frames[0].targets[k + 1].x, frames[1].targets[k].x);
    EXPECT_EQ(frames[0].targets[k + 1].y, frames[1].targets[k].y);
    EXPECT_EQ(frames[0].targets[k + 1].z, frames[1].targets[k].z);
  }
  for (std::size_t k = 0; k < made.fabric.anchors.size(); ++k) {
    EXPECT_EQ(frames[0].anchors[k].to.x, frames[1].anchors[k].from.x);
    EXPECT_EQ(frames[0].anchors[k].to.y, frames[1].anchors[k].from.y);
    EXPECT_EQ(frames[0].anchors[k].to.z, frames[1].anchors[k].from.z);
  }
}

}  // namespace
}  // namespace weft
