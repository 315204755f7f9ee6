// Momentum of cloth and colliders together is what gravity makes of it, whatever cloth falls on; and the sums are the same bits on every
// way through a frame.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "compute/commands.h"
#include "tests/support/momentum.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using ReactionCase = GpuTest;

Collider box_of(Vec3 centre, Vec3 size) {
  Collider collider;
  collider.shape = ColliderShape::box;
  collider.centre = centre;
  collider.size = size;
  return collider;
}

Scene falling_sheet(std::vector<Collider> colliders, std::uint32_t cells = 16) {
  Scene scene = sheet(cells);
  scene.cloths[0].start.velocity = {0.5f, -2, 0.2f};
  scene.colliders = std::move(colliders);
  return scene;
}

TEST_F(ReactionCase, a_falling_sheet_gives_every_shape_what_it_loses) {
  Collider capsule = box_of({0, -0.35f, 0}, {1, 1, 1});
  capsule.shape = ColliderShape::capsule;
  capsule.radius = 0.2;
  capsule.axis = {0.96f, 0.28f, 0};
  expect_balance(device(), falling_sheet({plane(-0.1f)}));
  expect_balance(device(), falling_sheet({sphere({0, -0.4f, 0}, 0.3)}));
  expect_balance(device(), falling_sheet({capsule}));
  capsule.radius_end = 0.35;
  expect_balance(device(), falling_sheet({capsule}));
  expect_balance(device(), falling_sheet({box_of({0, -0.3f, 0}, {0.6f, 0.4f, 0.6f}), plane(-0.5f)}));   // by triangles too
  expect_balance(device(), falling_sheet({sphere({0, -0.4f, 0}, 0.1), plane(-0.5f)}, 6));            // a round one, cells coarse for it
}

TEST_F(ReactionCase, moving_and_spinning_colliders_rub_it_along_and_are_given_what_they_take) {
  Scene scene = falling_sheet({sphere({0, -0.4f, 0}, 0.3), plane(-0.5f, 1)});
  scene.colliders[0].friction = 1;
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {1, {0.5f, 0.3f, 0}, {0, 1, 0}, 720}};
  expect_balance(device(), scene);
  scene.colliders[0] = box_of({0, -0.4f, 0}, {0.5f, 0.3f, 0.5f});
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {1, {0.2f, 0.3f, 0}, {0, 1, 0}, 360}};
  expect_balance(device(), scene);
}

// What they hold back in the solve (shaders/support) they are given, too.
TEST_F(ReactionCase, bodies_that_hold_fine_cloth_are_given_what_they_held) {
  Collider thin = box_of({0.1f, -0.1f, 0.05f}, {1, 1, 1});
  thin.shape = ColliderShape::capsule;
  thin.radius = 0.04;
  thin.axis = {0.8f, 0.6f, 0};
  for (const Method method : {Method::jacobi, Method::strands, Method::gauss_seidel})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const Collider& body : {thin, box_of({0.1f, -0.3f, 0}, {0.3f, 0.4f, 0.3f})}) {
        SCOPED_TRACE(std::to_string(int(method)) + ", " + std::to_string(iterations) + " iterations");
        Scene scene = falling_sheet({plane(-0.5f), body}, 52);
        scene.solver.method = method;
        scene.solver.iterations = iterations;
        scene.solver.substeps = 10 / iterations;
        expect_balance(device(), scene, 24);
      }
}

TEST_F(ReactionCase, every_method_that_tells_them_balances) {
  for (const Method method : {Method::jacobi, Method::strands, Method::gauss_seidel}) {
    Scene scene = falling_sheet({sphere({0, -0.4f, 0}, 0.3), box_of({0.3f, -0.4f, 0}, {0.3f, 0.3f, 0.3f})});
    scene.solver.method = method;
    scene.solver.iterations = method == Method::gauss_seidel ? 3 : 1;
    expect_balance(device(), scene, 30);
  }
  for (const Method method : {Method::mass_spring, Method::verlet}) {
    Scene scene = falling_sheet({sphere({0, -0.4f, 0}, 0.3)});
    scene.solver.method = method;
    scene.cloths[0].springs.emplace().structural = scene.cloths[0].springs->shear = {5, 0};
    expect_balance(device(), scene, 30);
  }
  for (const Method method : {Method::implicit, Method::chebyshev}) {
    Scene scene = falling_sheet({plane(-0.1f)});
    scene.reactions = true;
    scene.solver.method = method;
    scene.solver.iterations = 4;
    const auto refused = Simulation::create(device(), scene);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().find("does not tell what colliders are given"), std::string::npos) << refused.error();
  }
}

TEST_F(ReactionCase, a_sheet_at_rest_weighs_on_a_plane_what_it_weighs_and_where_it_lies) {
  Scene scene = sheet(12);
  scene.reactions = true;
  scene.cloths[0].transform.translate = {0.3f, 0.002f, 0};
  scene.colliders = {plane(0)};
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 0.5);
  simulation->take_reactions();
  run(*simulation, 1);
  const Reaction given = simulation->take_reactions()[0];
  const double weight = 9.81 * mass_of(*simulation);
  EXPECT_NEAR(given.impulse.y, -weight, 1e-4 * weight);
  EXPECT_NEAR(std::hypot(given.impulse.x, given.impulse.z), 0, 1e-3 * weight);
  EXPECT_NEAR(given.angular_impulse.z, -0.3 * weight, 1e-3 * weight);
  EXPECT_NEAR(given.angular_impulse.x, 0, 1e-3 * weight);
}

// More than the 64 that there were once: each sheet lies on a block of its own, and each block is told the weight of it, by
// advance and by submit; a snapshot knows them all.
TEST_F(ReactionCase, a_hundred_blocks_are_given_the_weight_of_the_sheet_on_each) {
  constexpr int kMany = 100;
  Scene scene = without_contacts();
  scene.reactions = true;
  for (int k = 0; k < kMany; ++k) {
    const float x = 0.3f * static_cast<float>(k % 10), z = 0.3f * static_cast<float>(k / 10);
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.1f, 0.1f}, 2, 2, Topology::diagonal, false};
    cloth.fabric.area_density = 0.1 + 0.01 * (k % 7);
    cloth.transform.translate = {x, 0.003f, z};
    scene.colliders.push_back(box_of({x, -0.1f, z}, {0.2f, 0.2f, 0.2f}));
  }
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 1);
  const Snapshot rested = must(simulation->save());
  simulation->take_reactions();
  const auto expect_weights = [&] {
    const auto given = simulation->take_reactions();
    ASSERT_EQ(given.size(), std::size_t{kMany});
    for (int k = 0; k < kMany; ++k) {
      const double wanted = -9.81 * 0.5 * 0.01 * scene.cloths[k].fabric.area_density;   // N s: of half a second
      EXPECT_NEAR(given[k].impulse.y, wanted, 0.01 * -wanted) << "block " << k;
    }
  };
  run(*simulation, 0.5);
  expect_weights();
  const std::uint64_t hash = hash_of(*simulation);
  must(simulation->restore(rested));
  simulation->take_reactions();
  for (int k = 0; k < 30; ++k) must(simulation->submit(kFrame));
  EXPECT_EQ(hash_of(*simulation), hash);   // waits for the frames
  expect_weights();
}

TEST_F(ReactionCase, contacts_change_nothing_about_the_balance_while_no_step_is_cut_short) {
  Scene scene = falling_sheet({plane(-0.1f)});
  scene.contacts.enabled = true;
  scene.cloths.push_back(sheet(8).cloths[0]);
  scene.cloths[1].grid->size = {0.4f, 0.4f};
  scene.cloths[1].transform.translate = {0, 0.01f, 0};
  scene.cloths[1].start.velocity = {0.5f, -2.2f, 0.2f};
  expect_balance(device(), scene, 20);
}

// But fine cloth over thin bodies, where nodes are held only if nobody asks.
TEST_F(ReactionCase, who_does_not_ask_has_no_byte_and_the_same_bits) {
  Scene scene = falling_sheet({sphere({0, -0.4f, 0}, 0.3), box_of({0.3f, -0.4f, 0}, {0.3f, 0.3f, 0.3f})});
  const auto silent = must(Simulation::create(device(), scene));
  scene.reactions = true;
  const auto telling = must(Simulation::create(device(), scene));
  run(*silent, 0.4);
  run(*telling, 0.4);
  EXPECT_EQ(hash_of(*silent), hash_of(*telling));
  EXPECT_TRUE(silent->take_reactions().empty());
  const auto has_row = [](const Simulation& simulation) {
    for (const BufferUse& buffer : simulation.buffers())
      if (buffer.name == "reactions") return true;
    return false;
  };
  EXPECT_FALSE(has_row(*silent));
  EXPECT_TRUE(has_row(*telling));
  for (const PassUse& pass : silent->passes()) EXPECT_EQ(pass.name.find("reaction"), std::string::npos) << pass.name;
}

// All that was told, in bits: of the last call, after `frames` frames.
std::vector<Reaction> told_by(Simulation& simulation, int frames, const std::function<void(Simulation&)>& frame) {
  for (int k = 0; k < frames; ++k) frame(simulation);
  must(simulation.read_positions());   // waits
  const auto told = simulation.take_reactions();
  return {told.begin(), told.end()};
}

bool same_bits(const std::vector<Reaction>& a, const std::vector<Reaction>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Reaction)) == 0;
}

TEST_F(ReactionCase, advance_submit_and_record_tell_the_same_bits_and_snapshots_go_on) {
  for (const bool contacts : {false, true}) {
    Scene scene = falling_sheet({box_of({0.3f, -0.3f, 0}, {0.3f, 0.3f, 0.3f}), plane(-0.4f), sphere({-0.2f, -0.3f, 0}, 0.2)});
    scene.reactions = true;
    scene.contacts.enabled = contacts;
    const auto simulation = [&] { return must(Simulation::create(device(), scene)); };
    const auto advance = [](Simulation& s) { must(s.advance(kFrame)); };
    const auto advanced = simulation();
    const auto told = told_by(*advanced, 24, advance);
    EXPECT_LT(told[0].impulse.y, -1e-3);
    EXPECT_LT(told[1].impulse.y, -1e-3);
    EXPECT_LT(told[2].impulse.y, -1e-3);
    EXPECT_TRUE(same_bits(told_by(*simulation(), 24, [](Simulation& s) { must(s.submit(kFrame)); }), told));
    EXPECT_TRUE(same_bits(told_by(*simulation(), 24,
                             [&](Simulation& s) {
                               must(compute::run_once(device(), "host", [&](VkCommandBuffer into) { must(s.record(into, kFrame)); }));
                             }),
                     told));

    const Snapshot snapshot = must(advanced->save());
    const auto next = told_by(*advanced, 6, advance);
    const auto restored = simulation();
    must(restored->restore(snapshot));
    EXPECT_TRUE(same_bits(told_by(*restored, 0, advance), std::vector<Reaction>(3))) << "what was told before";
    EXPECT_TRUE(same_bits(told_by(*restored, 6, advance), next));
  }
}

TEST_F(ReactionCase, frames_under_way_are_told_later_and_none_twice) {
  Scene scene = falling_sheet({plane(-0.05f)});
  scene.reactions = true;
  const auto submitted = must(Simulation::create(device(), scene)), advanced = must(Simulation::create(device(), scene));
  double now = 0, whole = 0;
  for (int k = 0; k < 30; ++k) {
    must(submitted->submit(kFrame));
    now += submitted->take_reactions()[0].impulse.y;   // of whichever are done
    must(advanced->advance(kFrame));
    whole += advanced->take_reactions()[0].impulse.y;
  }
  must(submitted->advance(0));
  now += submitted->take_reactions()[0].impulse.y;
  EXPECT_NEAR(now, whole, 1e-6 * -whole);
  must(submitted->advance(0));
  EXPECT_EQ(submitted->take_reactions()[0].impulse.y, 0) << "a frame of no substep";
}

// The unit of the sums is of the fabric as it was made: pins make less of it free, and what is told stays what it is.
TEST_F(ReactionCase, tells_the_same_weight_when_a_little_of_the_cloth_is_pinned) {
  Scene scene = sheet(8);
  scene.reactions = true;
  scene.pins = 1;
  scene.colliders = {plane(-0.01f)};
  scene.cloths[0].fabric.area_density = 0.1251;   // and without a corner less than the power of two below
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 1);
  const auto weight = [&] {
    (void)simulation->take_reactions();
    run(*simulation, 0.2);
    return double(simulation->take_reactions()[0].impulse.y) / 0.2;
  };
  const double whole = weight();
  EXPECT_NEAR(whole, -0.1251 * 9.81, 0.01);
  must(simulation->pin(std::vector<std::uint32_t>{0}));
  run(*simulation, 0.2);
  EXPECT_NEAR(weight(), whole, 0.02 * std::abs(whole));
}

}  // namespace
}  // namespace weft
