// The pass skin with targets of the host's: what a frame begins and ends with, by where they come from.
#include <gtest/gtest.h>

#include "shaders/skin/skin.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

using KernelSkinTargets = GpuTest;
using reference::Vector;

// Of every source that a mesh can have, with places and normals anywhere, some of which are none.
TEST_F(KernelSkinTargets, ends_and_begins_where_the_source_says) {
  Random random(21);
  Scene scene = sheet(9);
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = 0.3, .backstop_distance = 0.02, .backstop_radius = 0.5};
  scene.cloths[0].skin.emplace().takes_targets = true;
  const std::vector<Mesh> meshes = must(make_meshes(scene));
  const CookedFabric fabric = must(cook(scene, meshes));
  const auto& lists = fabric.own.of<SkinLists>();
  const std::uint32_t vertices = lists.targets;
  ASSERT_EQ(vertices, meshes[0].render.positions.size());
  const std::vector<gpu::Joint> joints{joint_between(moved_by({1, 0, 0}), moved_by({0, 1, 0}))};
  const gpu::MotionLimits limits{1, 1};
  const compute::BufferRequest request{"host", 32 * vertices, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  const auto host = must(compute::Arena::create(device(), compute::Memory::device, "host", std::span(&request, 1)));
  for (const bool storage : {false, true})
    for (const gpu::uint source : {0u, WEFT_FROM_KEPT, WEFT_TO_HOST, WEFT_FROM_KEPT | WEFT_TO_KEPT, WEFT_FROM_KEPT | WEFT_TO_HOST,
                                   WEFT_TO_HOST | WEFT_HOST_NORMALS, WEFT_FROM_KEPT | WEFT_TO_HOST | WEFT_HOST_NORMALS}) {
      SCOPED_TRACE(source);
      std::vector<gpu::vec4> told, kept;
      for (std::uint32_t k = 0; k < 2 * vertices; ++k) told.push_back(anywhere(random, 5, 1e30f));
      told[7].x = NAN, told[8].y = 3e10f, told[9] = {-INFINITY, 0, 0, 0};
      told[vertices + 11] = {0, 0, 0, 0}, told[vertices + 12].z = NAN;
      for (std::size_t k = 0; k < lists.points.size(); ++k) {
        kept.push_back(anywhere(random, 5, 0));
        const Vector n = vector(anywhere(random, 1, 0)).normalized();
        kept.push_back({static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z()), 0});
      }
      must(compute::upload(device(), host[0], std::as_bytes(std::span(told))));
      SinglePass passes(device(), scene, fabric, storage);
      passes.put(buffers::skin_ends, kept);
      const HostCopy copies[] = {{&buffers::host_targets, 0, host[0].handle, 0, 16 * vertices},
                                 {&buffers::host_normals, 0, host[0].handle, 16 * vertices, 16 * vertices}};
      FrameInput input = frame_of(4);
      input.joints = joints;
      input.motion_limits = std::span(&limits, 1);
      input.skin_sources = std::span(&source, 1);
      input.host_copies = copies;
      const auto anchors = anchors_at_rest(fabric, 0);
      input.anchors = anchors;
      input.anchors_move = true;
      passes.begin(input);
      passes.run("skin");
      const auto targets = passes.get<gpu::vec4>(buffers::motion_targets, 4 * fabric.positions.size());
      const auto held = passes.get<gpu::Anchor>(buffers::anchors, fabric.anchors.size());
      const auto ends = passes.get<gpu::vec4>(buffers::skin_ends, 2 * lists.points.size());
      std::uint32_t none = 0;
      for (std::size_t k = 0; k < lists.points.size(); ++k) {
        const gpu::SkinPoint& point = lists.points[k];
        const std::uint32_t v = lists.target_rows[k].x;
        SCOPED_TRACE(v);
        const reference::Ends by_joints{vector(point.rest) + Vector(1, 0, 0), vector(point.rest) + Vector(0, 1, 0), vector(point.normal),
                                        vector(point.normal)};
        const auto [from, to, normal_from, normal_to] =
            reference::with_host_targets(by_joints, {vector(kept[2 * k]), vector(kept[2 * k + 1])}, {vector(told[v]), vector(told[vertices + v])}, source);
        if (source & WEFT_TO_HOST) {
          none += v >= 7 && v <= 9;
          EXPECT_LT((vector(ends[2 * k]) - to).norm(), 8 * kRounding);
          EXPECT_LT((vector(ends[2 * k + 1]) - normal_to).norm(), 8 * kRounding);
        } else {
          EXPECT_EQ(vector(ends[2 * k]), vector(kept[2 * k])) << "what is kept stays";
        }
        if (point.anchor != WEFT_NONE) {
          EXPECT_LT((vector(held[point.anchor].from) - from).norm(), 8 * kRounding);
          EXPECT_LT((vector(held[point.anchor].to) - to).norm(), 8 * kRounding);
          continue;
        }
        const gpu::vec4* target = &targets[4 * point.particle];
        EXPECT_LT((vector(target[0]) - from).norm(), 8 * kRounding);
        EXPECT_LT((vector(target[1]) - to).norm(), 8 * kRounding);
        EXPECT_LT((vector(target[2]) - (from - 0.52 * normal_from)).norm(), 20 * kRounding);
        EXPECT_LT((vector(target[3]) - (to - 0.52 * normal_to)).norm(), 20 * kRounding);
        EXPECT_FLOAT_EQ(target[0].w, 0.3f);
      }
      EXPECT_EQ(passes.counters().non_finite, none);
    }
}

}  // namespace
}  // namespace weft
