// What the viewer shows, without a window: played, changed while it runs, gone back with.
#include "samples/view/stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/support/on_device.h"

namespace weft::view {
namespace {

constexpr const char* kScene =
    R"({"contacts":false,"cloths":[{"grid":{"size":[1,1],"cells":[12,12]},"anchors":[{"vertices":[0,12]}]}],
        "colliders":[{"shape":"sphere","radius":0.1,"centre":[0,-0.5,0],"keys":[{"time":0},{"time":2,"translate":[1,0,0]}]}]})";

class ViewStage : public compute::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    file = std::filesystem::path(testing::TempDir()) / ("weft_" + name + ".json");
    std::ofstream(file) << kScene;
    auto opened = Stage::open(device(), file, {});
    ASSERT_TRUE(opened) << opened.error();
    stage = std::move(*opened);
  }
  void TearDown() override {
    stage.reset();
    std::filesystem::remove(file);
    OnDevice::TearDown();
  }

  void play(int frames) {
    for (int k = 0; k < frames; ++k) {
      auto done = stage->step();
      ASSERT_TRUE(done) << done.error();
    }
  }
  std::vector<Vec3> places() const {
    auto read = stage->simulation().read_vertex_positions();
    EXPECT_TRUE(read);
    return read ? *read : std::vector<Vec3>();
  }
  // A ray from the side onto the middle of the cloth as it is.
  Ray at_the_middle() const {
    const auto bounds = stage->bounds();
    EXPECT_TRUE(bounds);
    const Vec3 middle = 0.5f * (bounds->first + bounds->second);
    const std::vector<Vec3> all = places();
    Vec3 nearest = all.front();
    for (const Vec3 p : all)
      if (length(p - middle) < length(nearest - middle)) nearest = p;
    return {nearest + Vec3{0, 3, 0.001f}, {0, -1, 0}};
  }

  std::filesystem::path file;
  std::unique_ptr<Stage> stage;
};

TEST_F(ViewStage, goes_on_from_where_it_was_when_the_scene_changes) {
  play(20);
  const std::vector<Vec3> before = places();
  const double time = stage->simulation().time();
  const Vec3 ball = stage->simulation().colliders()[0].centre;
  Scene scene = stage->scene();
  scene.solver.substeps = 20;
  scene.cloths[0].fabric = *fabric_preset("denim");
  auto changed = stage->change(scene);
  ASSERT_TRUE(changed) << changed.error();
  EXPECT_EQ(places(), before);
  EXPECT_NEAR(stage->simulation().time(), time, 1e-9);
  EXPECT_EQ(stage->simulation().colliders()[0].centre, ball);
  EXPECT_EQ(substeps_of(stage->simulation().scene().solver), 20u);
  play(1);
  // The keys go on, too: at time / 2 of a metre's way in two seconds.
  EXPECT_NEAR(stage->simulation().colliders()[0].centre.x, 0.5 * stage->simulation().time(), 1e-4);
  double most = 0;
  for (std::size_t k = 0; k < before.size(); ++k) most = std::max<double>(most, length(places()[k] - before[k]));
  EXPECT_LT(most, 0.2);   // a frame at 6 m/s at most; from the start it would be half a metre
  EXPECT_GT(most, 1e-4);
}

TEST_F(ViewStage, gravity_changes_without_a_new_simulation) {
  play(5);
  const std::uint64_t generation = stage->generation();
  Scene scene = stage->scene();
  scene.gravity = {0, 9.81f, 0};
  ASSERT_TRUE(stage->change(scene));
  EXPECT_EQ(stage->generation(), generation);
  float highest = 0;
  for (int k = 0; k < 12; ++k) {
    play(5);
    highest = std::max(highest, stage->bounds()->second.y);
  }
  EXPECT_GT(highest, 0.5f);   // it falls upwards
}

TEST_F(ViewStage, another_mesh_begins_anew_and_a_scene_that_cannot_be_changes_nothing) {
  play(10);
  Scene scene = stage->scene();
  scene.cloths[0].grid->cells_x = 20;
  ASSERT_TRUE(stage->change(scene));
  EXPECT_EQ(stage->frame(), 0u);
  EXPECT_EQ(stage->simulation().time(), 0);
  const std::vector<Vec3> before = places();
  scene.solver.iterations = 0;
  const auto refused = stage->change(scene);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("solver.iterations"), std::string::npos) << refused.error();
  EXPECT_EQ(places(), before);
  EXPECT_NE(stage->scene().solver.iterations, 0u);
}

TEST_F(ViewStage, reset_and_kept_moments_bring_back_the_same_bits) {
  const std::vector<Vec3> start = places();
  play(8);
  const std::vector<Vec3> at_eight = places();
  ASSERT_TRUE(stage->keep());
  play(7);
  const std::vector<Vec3> at_fifteen = places();
  ASSERT_TRUE(stage->go_back_to(0));
  EXPECT_EQ(stage->frame(), 8u);
  EXPECT_EQ(places(), at_eight);
  play(7);
  EXPECT_EQ(places(), at_fifteen);
  ASSERT_TRUE(stage->reset());
  EXPECT_EQ(stage->frame(), 0u);
  EXPECT_EQ(places(), start);
  play(8);
  EXPECT_EQ(places(), at_eight);
}

TEST_F(ViewStage, what_it_adds_for_hands_changes_nothing) {
  play(10);
  auto scene = load_scene(file);
  ASSERT_TRUE(scene);
  auto alone = Simulation::create(device(), *scene);
  ASSERT_TRUE(alone) << alone.error();
  for (int k = 0; k < 10; ++k) ASSERT_TRUE((*alone)->advance(1.0 / 60));
  EXPECT_EQ(places(), *(*alone)->read_vertex_positions());
}

TEST_F(ViewStage, cloth_is_grabbed_dragged_and_let_go_of) {
  play(2);
  const Ray ray = at_the_middle();
  auto missed = stage->grab({{0, 3, 0}, {0, 1, 0}});
  ASSERT_TRUE(missed);
  EXPECT_FALSE(*missed);
  auto held = stage->grab(ray);
  ASSERT_TRUE(held) << held.error();
  ASSERT_TRUE(*held);
  const float before = places()[6 * 13 + 6].x;
  const Ray beside{ray.origin + Vec3{0.3f, 0, 0}, ray.direction};
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(stage->drag(beside, {0, -1, 0}));
    play(1);
  }
  EXPECT_GT(places()[6 * 13 + 6].x, before + 0.05f);
  ASSERT_TRUE(stage->let_go());
  EXPECT_FALSE(stage->is_grabbing());
}

TEST_F(ViewStage, a_vertex_is_pinned_and_let_go_of_by_the_same_click_and_stays_pinned_through_a_change) {
  play(2);
  const Ray ray = at_the_middle();
  auto pinned = stage->pin_or_release(ray);
  ASSERT_TRUE(pinned) << pinned.error();
  ASSERT_TRUE(*pinned);
  ASSERT_TRUE((*pinned)->starts_with("pinned vertex ")) << **pinned;
  const std::size_t vertex = std::stoul((*pinned)->substr(14));
  const Vec3 held = places()[vertex];
  play(10);
  EXPECT_LT(length(places()[vertex] - held), 1e-5f);
  Scene scene = stage->scene();
  scene.cloths[0].fabric.friction = 0.9;
  ASSERT_TRUE(stage->change(scene));
  play(10);
  EXPECT_LT(length(places()[vertex] - held), 1e-5f);
  auto released = stage->pin_or_release({held + Vec3{0, 1, 0}, {0, -1, 0}});
  ASSERT_TRUE(released) << released.error();
  ASSERT_TRUE(*released);
  EXPECT_EQ(**released, "released vertex " + std::to_string(vertex));
  play(20);
  EXPECT_GT(length(places()[vertex] - held), 0.05f);
}

TEST_F(ViewStage, a_vertex_that_was_let_go_of_is_pinned_again_where_it_was_when_a_moment_was_kept) {
  play(2);
  const Ray ray = at_the_middle();
  ASSERT_TRUE(stage->pin_or_release(ray));
  ASSERT_TRUE(stage->keep());
  auto released = stage->pin_or_release(ray);
  ASSERT_TRUE(released && *released);
  ASSERT_TRUE((*released)->starts_with("released")) << **released;
  play(5);
  ASSERT_TRUE(stage->go_back_to(0));
  auto again = stage->pin_or_release(ray);   // pinned, as it was then: the click lets go of it
  ASSERT_TRUE(again && *again);
  EXPECT_EQ(**again, **released);
}

TEST_F(ViewStage, a_ball_comes_pushes_cloth_and_goes) {
  play(3);
  const Ray ray = at_the_middle();
  ASSERT_TRUE(stage->put_ball(0.1));
  ASSERT_TRUE(stage->ball());
  const std::vector<Vec3> before = places();
  ASSERT_TRUE(stage->move_ball(ray.origin));   // from far away, and not through the cloth
  play(1);
  for (const Vec3 p : places()) ASSERT_LT(length(p), 2);
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(stage->move_ball(ray.origin - Vec3{0, 0.12f * static_cast<float>(k), 0}));
    play(1);
  }
  const float lowest = stage->bounds()->first.y;
  ASSERT_TRUE(stage->put_ball(std::nullopt));
  EXPECT_FALSE(stage->ball());
  EXPECT_EQ(stage->simulation().scene().colliders.size(), 1u);
  EXPECT_LT(lowest, -0.3f);
  EXPECT_EQ(places().size(), before.size());
}

TEST_F(ViewStage, a_knife_cuts_and_changes_of_the_scene_keep_the_cut) {
  play(5);
  const std::vector<Vec3> before = places();
  EXPECT_FALSE(stage->cut({{0, 3, 0}, {-1, -3, 0}}, {{0, 3, 0}, {1, -3, 0}})) << "there is no knife yet";
  ASSERT_TRUE(stage->take_knife(true));
  const std::vector<Vec3> taken = places();
  ASSERT_GT(taken.size(), before.size());   // room for what it cuts
  for (std::size_t k = 0; k < before.size(); ++k) ASSERT_LT(length(taken[k] - before[k]), 1e-5f) << "the cloth goes on from where it was";
  EXPECT_EQ(stage->frame(), 5u);
  const auto count = stage->cut({{0.02f, 3, 0}, {0, -3, -1}}, {{0.02f, 3, 0}, {0, -3, 1}});
  ASSERT_TRUE(count) << count.error();
  EXPECT_GE(*count, 13u);
  play(3);
  Scene scene = stage->scene();
  scene.cloths[0].fabric.friction = 0.7;
  const std::vector<Vec3> cut = places();
  ASSERT_TRUE(stage->change(scene));
  EXPECT_EQ(stage->simulation().splits(), *count);
  EXPECT_EQ(stage->frame(), 8u);
  const std::vector<Vec3> changed = places();
  ASSERT_EQ(changed.size(), cut.size());
  for (std::size_t k = 0; k < cut.size(); ++k) ASSERT_LT(length(changed[k] - cut[k]), 1e-5f);
  // Another mesh has other triangles: it is whole.
  scene.cloths[0].grid->cells_x = 16;
  scene.cloths[0].anchors[0].vertices = {0, 16};
  ASSERT_TRUE(stage->change(scene));
  EXPECT_EQ(stage->simulation().splits(), 0u);
  ASSERT_TRUE(stage->cut({{0.02f, 3, 0}, {0, -3, -1}}, {{0.02f, 3, 0}, {0, -3, 1}}));
  ASSERT_TRUE(stage->take_knife(false));
  EXPECT_TRUE(stage->has_knife()) << "what is cut stays so";
  ASSERT_TRUE(stage->reset());
  EXPECT_EQ(stage->simulation().splits(), 0u);
}

TEST_F(ViewStage, contacts_are_shown_where_there_are_some) {
  EXPECT_TRUE(stage->contacts()->empty());
  Scene scene = stage->scene();
  scene.contacts.enabled = true;
  scene.cloths[0].fabric.thickness = 0.02;
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0, -0.015f, 0};
  ASSERT_TRUE(stage->change(scene));
  play(3);
  auto pairs = stage->contacts();
  ASSERT_TRUE(pairs) << pairs.error();
  EXPECT_GT(pairs->size(), 0u);
  EXPECT_EQ(pairs->size() % 2, 0u);
}

TEST_F(ViewStage, passes_are_timed_without_a_change) {
  play(6);
  const std::vector<Vec3> before = places();
  EXPECT_TRUE(stage->simulation().timings().empty());
  ASSERT_TRUE(stage->time_passes(true));
  EXPECT_EQ(stage->frame(), 6u);
  EXPECT_EQ(places(), before);
  play(1);
  EXPECT_FALSE(stage->simulation().timings().empty());
}

}  // namespace
}  // namespace weft::view
