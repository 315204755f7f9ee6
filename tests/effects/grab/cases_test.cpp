// What grabbing promises: it finds the cloth, carries it, gives no more than its force, throws it, and is never unstable.
#include <gtest/gtest.h>

#include "tests/support/every_method.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using GrabCase = GpuTest;

Scene grabbable(std::uint32_t cells, std::uint32_t grabs = 2) {
  Scene scene = sheet(cells);
  scene.grabs = grabs;
  return scene;
}

Point middle(const Simulation& simulation) { return centre_of_mass(must(simulation.read_positions())); }

TEST_F(GrabCase, a_ray_takes_the_cloth_that_it_meets_first_wherever_the_origin_is) {
  for (const float place : {0.f, 1000.f}) {
    Scene scene = grabbable(8);
    scene.gravity = {};
    scene.cloths.push_back(scene.cloths[0]);
    for (Cloth& cloth : scene.cloths) cloth.transform.translate.x = place;
    scene.cloths[1].transform.translate.y = 0.5f;
    const auto simulation = must(Simulation::create(device(), scene));
    const auto upper = must(simulation->grab({place + 0.1f, 3, 0.2f}, {0, -5, 0}));
    ASSERT_TRUE(upper);
    EXPECT_EQ(upper->cloth, 1u);
    EXPECT_NEAR(upper->distance, 2.5, 1e-3);
    EXPECT_LT(length(upper->point - Vec3{place + 0.1f, 0.5f, 0.2f}), 1e-3f);
    EXPECT_FALSE(must(simulation->grab({place, 3, 0}, {0, 1, 0}))) << "it looks away";
    const Grabbed lower = must(simulation->grab_near({place, -1, 0}));
    EXPECT_EQ(lower.cloth, 0u);
    EXPECT_NEAR(lower.distance, 1, 1e-3);
    const auto refused = simulation->grab({place, 3, 0}, {0, -1, 0});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().find("all of the scene's 2 grabs hold something"), std::string::npos) << refused.error();
  }
}

// Held by the middle the whole sheet hangs from the hand; with every method.
TEST_F(GrabCase, a_hand_carries_a_sheet_with_every_method) {
  for (const Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    Scene scene = subject.scene;
    scene.grabs = 1;
    scene.colliders.clear();
    scene.cloths.resize(1);
    scene.cloths[0].anchors.clear();
    const auto simulation = must(Simulation::create(device(), scene));
    const Grabbed grabbed = must(simulation->grab_near({0, 0, 0}, {.stiffness = 1000, .damping = 5, .force = 100}));
    for (int frame = 0; frame < 90; ++frame) {
      must(simulation->move_grab(grabbed.grab, grabbed.point + Vec3{0, 0.005f * static_cast<float>(frame), 0}));
      must(simulation->advance(kFrame));
    }
    const auto vertices = must(simulation->read_vertex_positions());
    float nearest = 1e9f;
    for (const Vec3& v : vertices) nearest = std::min(nearest, length(v - (grabbed.point + Vec3{0, 0.445f, 0})));
    EXPECT_LT(nearest, 0.1f) << "it follows the hand";
    EXPECT_GT(middle(*simulation).y, -0.6) << "and has not fallen by ten metres";
    EXPECT_EQ(simulation->counts().non_finite, 0u);
  }
}

// A hand that is weaker than the cloth is heavy, 0.12 kg, cannot hold it: it falls at least by what the force leaves of gravity.
TEST_F(GrabCase, the_force_is_limited) {
  for (const double force : {0.3, 0.6}) {
    const auto simulation = must(Simulation::create(device(), grabbable(8)));
    const Grabbed grabbed = must(simulation->grab_near({0, 0, 0}, {.stiffness = 1e6, .damping = 0, .force = force}));
    (void)grabbed;
    const double before = middle(*simulation).y;
    run(*simulation, 0.5);
    const double fall = 0.5 * (9.81 - force / 0.12) * 0.25;
    EXPECT_GT(before - middle(*simulation).y, 0.98 * fall) << force;
    EXPECT_LT(before - middle(*simulation).y, 0.95 * 0.5 * 9.81 * 0.25) << force;
  }
}

TEST_F(GrabCase, what_is_let_go_flies_on_with_its_velocity) {
  Scene scene = grabbable(6);
  scene.cloths[0].grid->topology = Topology::centre;   // diagonals lead it aside
  scene.gravity = {};
  const auto simulation = must(Simulation::create(device(), scene));
  const Grabbed grabbed = must(simulation->grab_near({0, 0, 0}));
  for (int frame = 1; frame <= 30; ++frame) {
    must(simulation->move_grab(grabbed.grab, grabbed.point + Vec3{0, 0, static_cast<float>(2 * kFrame * frame)}));
    must(simulation->advance(kFrame));
  }
  must(simulation->let_go(grabbed.grab));
  must(simulation->advance(kFrame));
  const Point before = middle(*simulation);
  run(*simulation, 0.5);
  const Point after = middle(*simulation);
  EXPECT_NEAR((after.z - before.z) / 0.5, 2, 0.3);
  EXPECT_NEAR(after.x, before.x, 0.02);
  run(*simulation, 0.5);
  EXPECT_NEAR(middle(*simulation).z - after.z, after.z - before.z, 1e-3) << "nothing pulls any more";
  EXPECT_FALSE(simulation->let_go(grabbed.grab));
}

TEST_F(GrabCase, no_grip_mass_or_rate_is_unstable) {
  std::uint32_t scenes = 0;   // one iteration and three, in turns
  for (const double density : {0.01, 1.0})
    for (const Grip& grip : {Grip{1e9, 0, 1e9}, Grip{1, 1e9, 1e9}, Grip{1e9, 1e9, 1e9}, Grip{1e5, 0, 1e3}})
      for (const double rate : {30.0, 60.0, 240.0}) {
        SCOPED_TRACE(std::to_string(rate) + " Hz, " + std::to_string(density) + " kg/m^2, " + std::to_string(grip.stiffness) + " N/m");
        Scene scene = grabbable(4);
        scene.cloths[0].fabric.damping = 4;   // so that it comes to rest
        scene.solver.rate = rate;
        scene.solver.iterations = scenes++ % 2 == 0 ? 1 : 3;
        scene.cloths[0].fabric.area_density = density;
        const auto simulation = must(Simulation::create(device(), scene));
        const Grabbed grabbed = must(simulation->grab_near({0.2f, 0, 0.1f}, grip));
        for (int frame = 0; frame < 40; ++frame) {
          const float way = frame % 20 < 10 ? 0.3f : -0.3f;   // to and fro at once
          must(simulation->move_grab(grabbed.grab, grabbed.point + Vec3{way, 0.5f * way, 0}));
          must(simulation->advance(1 / rate));
        }
        must(simulation->move_grab(grabbed.grab, grabbed.point));
        run(*simulation, 1.5, 1 / rate);
        EXPECT_LT(top_speed(*simulation), 3);
        EXPECT_EQ(simulation->counts().non_finite, 0u);
      }
}

TEST_F(GrabCase, the_same_bits_in_every_way_and_from_snapshots) {
  for (const bool contacts : {false, true}) {
    Scene scene = grabbable(10);
    scene.pins = 2;
    scene.cloths[0].anchors.push_back(held_at({Corner::low_low}));
    scene.contacts.enabled = contacts;
    scene.contacts.capacity = 20000;
    const auto hand = [](Simulation& simulation, int frame) {
      if (frame == 2) { EXPECT_TRUE(must(simulation.grab({0.2f, 2, 0.1f}, {0, -1, 0}))); }
      if (frame == 4) must(simulation.grab_near({0.25f, 0, 0.1f}));   // perhaps of the same particles
      if (frame > 4 && frame < 12) must(simulation.move_grab(0, {0.2f, 0.04f * static_cast<float>(frame), 0.1f}));
      if (frame == 8) must(simulation.pin(std::vector<std::uint32_t>{84}));
      if (frame == 9) must(simulation.let_go(1));
      if (frame == 12) must(simulation.let_go(0));
    };
    std::vector<std::uint64_t> hashes;
    for (const Way way : kWays) {
      const auto simulation = must(Simulation::create(device(), scene));
      for (int frame = 0; frame < 16; ++frame) {
        hand(*simulation, frame);
        run_frame(device(), *simulation, way);
      }
      hashes.push_back(hash_of(*simulation));
    }
    auto simulation = must(Simulation::create(device(), scene));
    for (int frame = 0; frame < 16; ++frame) {
      hand(*simulation, frame);
      if (frame % 3 != 1) simulation = resumed(device(), *simulation, scene);
      must(simulation->advance(kFrame));
    }
    hashes.push_back(hash_of(*simulation));
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]) << contacts;
  }
}

TEST_F(GrabCase, what_cannot_be_is_refused) {
  const auto simulation = must(Simulation::create(device(), grabbable(4)));
  const auto refused = [](const auto& result, const char* words) {
    ASSERT_FALSE(result) << words;
    EXPECT_NE(result.error().find(words), std::string::npos) << result.error();
  };
  refused(simulation->grab({0, NAN, 0}, {0, 1, 0}), "the ray is not finite");
  refused(simulation->grab({0, 1, 0}, {0, 0, 0}), "the ray's direction has a length of 0");
  refused(simulation->grab_near({INFINITY, 0, 0}), "the point is not finite");
  refused(simulation->grab_near({}, {.stiffness = 0, .damping = 1, .force = 1}), "the grip's stiffness of 0 N/m is not above 0");
  refused(simulation->grab_near({}, {.stiffness = 1, .damping = -1, .force = 1}), "the grip's damping of -1 N s/m is not at least 0");
  refused(simulation->grab_near({}, {.stiffness = 1, .damping = 1, .force = NAN}), "the grip's force of");
  refused(simulation->move_grab(0, {}), "nothing is held by grab 0");
  refused(simulation->let_go(7), "nothing is held by grab 7");
  must(simulation->grab_near({}));
  refused(simulation->move_grab(0, {0, 0, NAN}), "the target of grab 0 is not finite");
  const auto without = must(Simulation::create(device(), sheet(4)));
  refused(without->grab_near({}), "the scene has no grabs (its key \"grabs\")");
}

}  // namespace
}  // namespace weft
