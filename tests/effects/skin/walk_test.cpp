// The character in its skirt and its cape (assets/scenes/walk.json), over the first stride and a half: no crossing of cloth with cloth or with
// the body, which is counted exactly, no pair lost, and nobody beyond its max distance by a thousandth of it.
#include <gtest/gtest.h>

#include <algorithm>

#include "compute/commands.h"
#include "engine/effects/skin/skin.h"
#include "engine/reference/intersections.h"
#include "engine/simulation.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using WalkCase = GpuTest;

struct Frame {
  std::uint64_t crossings = 0;
  double beyond = -1;   // of a max distance: how far a particle is past it, at most; below 0 within
};

Frame look_at(const Simulation& simulation) {
  Frame frame;
  const auto positions = must(simulation.read_positions());
  const CookedFabric& fabric = simulation.fabric();
  std::vector<Vec3> places;
  for (const gpu::vec4& x : positions) places.push_back({x.x, x.y, x.z});
  frame.crossings = count_crossings(places, fabric.triangles, fabric.cloth_triangles);
  const auto& lists = fabric.own.of<SkinLists>();
  std::vector<Affine> joints(lists.first_pose.size());
  for (const SkinnedMesh& skinned : lists.meshes)
    std::ranges::copy(joints_at(simulation.scene(), skinned, simulation.meshes()[skinned.mesh], simulation.time()),
                      joints.begin() + skinned.first_joint);
  for (const gpu::SkinPoint& point : lists.points) {
    if (point.cloth == WEFT_NONE || positions[point.particle].w == 0) continue;
    const double off = double(length(places[point.particle] - skinned_point(point, joints)));
    frame.beyond = std::max(frame.beyond, (off - 2e-6) / double(point.max_distance) - 1);   // m: rounding
  }
  return frame;
}

TEST_F(WalkCase, nothing_crosses_and_nobody_is_beyond_its_max_distance) {
  const Scene scene = must(load_scene(WEFT_ASSETS "/scenes/walk.json"));
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_EQ(look_at(*simulation).crossings, 0u);
  for (int frame = 1; frame <= 100; ++frame) {   // in turns in all three ways
    if (frame % 3 == 0) must(simulation->advance(1.0 / 60));
    else if (frame % 3 == 1) must(simulation->submit(1.0 / 60));
    else must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) { must(simulation->record(commands, 1.0 / 60)); }));
    const Frame found = look_at(*simulation);
    ASSERT_EQ(found.crossings, 0u) << "after frame " << frame;
    EXPECT_LT(found.beyond, 1e-3) << "after frame " << frame;
  }
  EXPECT_EQ(simulation->counts().contacts_overflowed, 0u);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

// The blanket on the sleeper (assets/scenes/sleeper.json), over a breath and the beginning of a turn.
TEST_F(WalkCase, a_blanket_lies_on_a_body_that_breathes_and_nothing_crosses) {
  const auto simulation = must(Simulation::create(device(), must(load_scene(WEFT_ASSETS "/scenes/sleeper.json"))));
  const auto highest = [&] {
    float most = -1;
    for (const gpu::vec4& x : must(simulation->read_positions())) most = x.w == 0 ? std::max(most, x.y) : most;
    return most;
  };
  EXPECT_NEAR(highest(), 0.19f, 0.002f);
  float most = 0;
  for (int frame = 1; frame <= 120; ++frame) {
    must(simulation->advance(1.0 / 60));
    most = std::max(most, highest());
    if (frame % 10 == 0) { ASSERT_EQ(look_at(*simulation).crossings, 0u) << "after frame " << frame; }
  }
  EXPECT_GT(most, 0.21f) << "it has breathed in";
  EXPECT_EQ(simulation->counts().contacts_overflowed, 0u);
}

}  // namespace
}  // namespace weft
