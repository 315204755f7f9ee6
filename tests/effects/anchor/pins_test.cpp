// Pins: vertices that the host holds and releases while a simulation runs are as anchors are from the start.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "tests/support/every_method.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using Pins = GpuTest;
using Vertices = std::vector<std::uint32_t>;

constexpr std::uint32_t kPins = 8;

std::unique_ptr<Simulation> created(const compute::Device& device, const Scene& scene) { return must(Simulation::create(device, scene)); }

Vec3 vertex(const Simulation& simulation, std::uint32_t v) { return must(simulation.read_vertex_positions())[v]; }
std::uint32_t particle_of(const Simulation& simulation, std::uint32_t v) { return simulation.fabric().surface_rows[v].x; }
Vec3 velocity(const Simulation& simulation, std::uint32_t v) {
  const gpu::vec4 at = must(simulation.read_velocities())[particle_of(simulation, v)];
  return {at.x, at.y, at.z};
}

// Without anchors, and without levels, which are chosen by anchors, not by pins: then all lists are those of anchors.
Scene pinnable(const Subject& subject) {
  Scene scene = subject.scene;
  scene.pins = kPins;
  for (Cloth& cloth : scene.cloths) {
    cloth.anchors.clear();
    cloth.start.imperfection = 0;   // an anchor starts at its place, and a vertex that is pinned where it starts
  }
  if (scene.solver.method == Method::by_default) scene.solver.method = Method::jacobi;
  scene.solver.levels = scene.solver.method == Method::strands ? std::optional(false) : std::nullopt;
  return scene;
}

TEST_F(Pins, pinned_before_the_first_frame_are_anchors_to_the_bit_with_every_method) {
  for (const Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    const Scene pinned = pinnable(subject);
    Scene anchored = pinned;
    Anchor& anchor = anchored.cloths[0].anchors.emplace_back();
    anchor.vertices = {0, 20, 40};
    const auto a = created(device(), anchored), b = created(device(), pinned);
    must(b->pin(anchor.vertices));
    for (int frame = 0; frame < 8; ++frame) {
      if (frame >= 2) {   // the first target is where it is: the way to another from a place that the host does not know rounds differently
        const Vec3 target = vertex(*a, 20) + (frame == 2 ? Vec3{} : Vec3{0, 0.02f, 0.01f});
        must(a->move_anchors(1, std::span(&target, 1)));
        must(b->move_pins(Vertices{20}, std::span(&target, 1)));
      }
      must(a->advance(kFrame));
      must(b->advance(kFrame));
    }
    EXPECT_EQ(hash_of(*a), hash_of(*b));
    EXPECT_EQ(a->counts().non_finite, 0u);
    // And released they fly on alike.
    must(a->release(Vertices{20}));
    must(b->release(Vertices{20}));
    run(*a, 0.1);
    run(*b, 0.1);
    EXPECT_EQ(hash_of(*a), hash_of(*b));
  }
}

// What a host does with its hands, with every method: hold, move, release also the scene's anchors, and hold again.
void handle(Simulation& simulation, int frame) {
  const Vertices few{40, 41, 3};
  if (frame == 2) must(simulation.pin(few));
  if (frame == 4) must(simulation.release(Vertices{0, 3}));
  if (frame >= 4 && frame < 7) {
    // Slowly: submit and record do not repeat frames with more candidate pairs than there is room for.
    const std::vector<Vec3> at = must(simulation.read_vertex_positions());
    const Vec3 targets[] = {at[40] + Vec3{0, 0.01f, 0}, at[41] + Vec3{0.002f, 0.01f, 0}};
    must(simulation.move_pins(std::span(few).first(2), targets));
  }
  if (frame == 7) must(simulation.release(few));
  if (frame == 8) must(simulation.pin(Vertices{0, 1, 2, 3, 4}));
}

TEST_F(Pins, the_same_bits_in_every_way_and_from_snapshots) {
  for (const Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    Scene scene = subject.scene;
    scene.pins = kPins;
    scene.contacts.capacity = 20000;   // frames that are repeated with more are not of submit and record
    std::vector<std::uint64_t> hashes;
    for (const Way way : kWays) {
      const auto simulation = created(device(), scene);
      for (int frame = 0; frame < 12; ++frame) {
        handle(*simulation, frame);
        run_frame(device(), *simulation, way);
      }
      hashes.push_back(hash_of(*simulation));
      EXPECT_EQ(simulation->counts().non_finite, 0u);
      EXPECT_EQ(simulation->counts().contacts_overflowed, 0u);
    }
    auto simulation = created(device(), scene);
    for (int frame = 0; frame < 12; ++frame) {
      handle(*simulation, frame);
      if (frame % 2 == 0 || frame == 7) simulation = resumed(device(), *simulation, scene);   // with what no frame has taken yet
      must(simulation->advance(kFrame));
    }
    hashes.push_back(hash_of(*simulation));
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
  }
}

TEST_F(Pins, a_pinned_vertex_stays_where_it_is_and_a_moved_one_is_at_its_target) {
  for (const bool contacts : {false, true}) {
    Scene scene = sheet(12);
    scene.pins = 2;
    scene.contacts.enabled = contacts;
    const auto simulation = created(device(), scene);
    run(*simulation, 0.2);
    const Vec3 there = vertex(*simulation, 84);
    must(simulation->pin(Vertices{84}));
    run(*simulation, 0.3);
    EXPECT_EQ(vertex(*simulation, 84), there);
    EXPECT_LT(vertex(*simulation, 0).y, there.y - 0.1f);
    Scene anchored = scene;
    anchored.cloths[0].anchors.emplace_back().vertices = {84};
    const auto other = created(device(), anchored);
    run(*other, 0.5);
    EXPECT_LT(strain_of(*simulation).mean, 2 * strain_of(*other).mean) << contacts;   // it was stopped in its fall
    for (int frame = 1; frame <= 10; ++frame) {
      const Vec3 target = there + Vec3{0.01f * static_cast<float>(frame), 0.005f, 0};
      must(simulation->move_pins(Vertices{84}, std::span(&target, 1)));
      must(simulation->advance(kFrame));
      EXPECT_EQ(vertex(*simulation, 84), target) << contacts;
    }
  }
}

// Without anything else that acts on it a particle that is thrown keeps the velocity of its target's last frame.
TEST_F(Pins, a_released_one_flies_on_as_it_was_moved_and_an_unmoved_one_from_rest) {
  for (const double rate : {30.0, 60.0, 240.0}) {
    Scene scene = sheet(4);
    scene.gravity = {};
    scene.pins = 25;
    scene.solver.rate = rate;
    const auto simulation = created(device(), scene);
    Vertices all(25);
    for (std::uint32_t v = 0; v < 25; ++v) all[v] = v;
    must(simulation->pin(all));
    must(simulation->advance(1 / rate));
    const Vec3 wanted{1, -2, 0.5f};
    for (int frame = 0; frame < 3; ++frame) {
      std::vector<Vec3> targets = must(simulation->read_vertex_positions());
      for (Vec3& target : targets) target = target + static_cast<float>(1 / rate) * wanted;
      must(simulation->move_pins(all, targets));
      must(simulation->advance(1 / rate));
    }
    const Vec3 before = vertex(*simulation, 12);
    must(simulation->release(all));
    must(simulation->advance(1 / rate));
    for (const std::uint32_t v : all) EXPECT_LT(length(velocity(*simulation, v) - wanted), 0.002f) << v << " at " << rate;
    EXPECT_LT(length(vertex(*simulation, 12) - before - static_cast<float>(1 / rate) * wanted), 1e-5f);
    must(simulation->pin(all));
    run(*simulation, 2 / rate, 1 / rate);
    must(simulation->release(all));
    must(simulation->advance(1 / rate));
    for (const std::uint32_t v : all) EXPECT_LT(length(velocity(*simulation, v)), 2e-4f) << v;   // places round by 2^-24 m, and a substep is 1/2400 s
  }
}

TEST_F(Pins, a_released_anchor_has_its_mass_again_and_its_tethers_are_gone) {
  Scene scene = sheet(8);
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
  scene.pins = 1;
  const auto simulation = created(device(), scene);
  run(*simulation, 0.5);
  EXPECT_GT(simulation->fabric().tether_count, 0u);
  must(simulation->release(Vertices{0, 8}));
  const double before = centre_of_mass(must(simulation->read_positions())).y;
  must(simulation->advance(kFrame));
  EXPECT_EQ(simulation->fabric().tether_count, 0u);
  for (const gpu::vec4& x : must(simulation->read_positions())) EXPECT_GT(x.w, 0);
  run(*simulation, 0.5);
  EXPECT_LT(centre_of_mass(must(simulation->read_positions())).y, before - 1.0) << "it falls";
  const Vec3 target{};
  const auto refused = simulation->move_anchors(0, std::span(&target, 1));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("anchor 0 was released"), std::string::npos) << refused.error();
  must(simulation->pin(Vertices{0, 8, 40}));   // anchors take no pins of the scene's
  must(simulation->advance(kFrame));
  EXPECT_GT(simulation->fabric().tether_count, 0u);
}

// What the CPU does where a frame begins, against making the simulation. `--gtest_filter=Pins.a_pin_costs*` prints it.
TEST_F(Pins, a_pin_costs_a_fraction_of_a_new_simulation) {
  const auto milliseconds = [](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  for (const bool levels : {false, true}) {
    Scene scene = sheet(99);
    scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
    scene.solver.levels = levels;
    scene.pins = 4;
    std::unique_ptr<Simulation> simulation;
    const double whole = milliseconds([&] { simulation = created(device(), scene); });
    double plain = 1e9, pinned = 1e9;
    const auto record = [&] {
      double taken = 0;
      must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) {
        taken = milliseconds([&] { must(simulation->record(commands, kFrame)); });
      }));
      return taken;
    };
    for (int k = 0; k < 4; ++k) {
      plain = std::min(plain, record());
      must(k % 2 == 0 ? simulation->pin(Vertices{5050}) : simulation->release(Vertices{5050}));
      pinned = std::min(pinned, record());
    }
    std::printf("100 x 100, levels %d: create %.0f ms, a frame's recording %.2f ms, with a pin %.1f ms\n", levels, whole, plain, pinned);
    EXPECT_LT(pinned, 0.5 * whole);
  }
}

// Contacts: a pinned vertex is kinematic, and cloth that falls on pinned cloth stays on it.
TEST_F(Pins, cloth_lies_on_pinned_cloth) {
  Scene scene = sheet(10);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0, 0.05f, 0};
  scene.cloths[1].grid->size = {0.4f, 0.4f};
  scene.contacts.enabled = true;
  scene.pins = 121;
  const auto simulation = created(device(), scene);
  Vertices lower;
  for (std::uint32_t v = 0; v < 121; ++v) lower.push_back(v);
  must(simulation->pin(lower));
  run(*simulation, 0.6);
  const auto vertices = must(simulation->read_vertex_positions());
  for (std::size_t v = 121; v < vertices.size(); ++v) {
    EXPECT_GT(vertices[v].y, -0.001f) << v;
    EXPECT_LT(vertices[v].y, 0.02f) << v;
  }
  must(simulation->release(lower));
  run(*simulation, 0.5);
  EXPECT_LT(must(simulation->read_vertex_positions())[60].y, -0.8f);
}

TEST_F(Pins, what_cannot_be_held_is_refused_and_changes_nothing) {
  Scene scene = sheet(4);
  scene.pins = 2;
  const auto simulation = created(device(), scene);
  const auto refused = [](const Result<void>& result, const char* words) {
    ASSERT_FALSE(result) << words;
    EXPECT_NE(result.error().find(words), std::string::npos) << result.error();
  };
  const Vec3 target{};
  refused(simulation->pin(Vertices{0, 25}), "vertex 25 is not below the simulation's 25");
  refused(simulation->pin(Vertices{0, 1, 2}), "more vertices would be pinned than the scene has pins for, 2");
  refused(simulation->move_pins(Vertices{0}, std::span(&target, 1)), "vertex 0 is not held");
  must(simulation->pin(Vertices{0, 0, 1, 0}));
  must(simulation->pin(Vertices{1}));
  refused(simulation->pin(Vertices{2}), "more vertices would be pinned");
  refused(simulation->move_pins(Vertices{0, 1}, std::span(&target, 1)), "1 targets were given for 2 vertices");
  const Vec3 nowhere{0, NAN, 0};
  refused(simulation->move_pins(Vertices{0}, std::span(&nowhere, 1)), "the target of vertex 0 is not finite");
  must(simulation->release(Vertices{0, 7}));
  must(simulation->pin(Vertices{2}));
  must(simulation->advance(kFrame));
  std::size_t held = 0;
  for (const gpu::vec4& x : must(simulation->read_positions())) held += x.w == 0;
  EXPECT_EQ(held, 2u);
  scene.pins = 0;
  const auto without = created(device(), scene);
  refused(without->pin(Vertices{0}), "the scene has no pins (its key \"pins\")");
  refused(without->release(Vertices{0}), "the scene has no pins");
}

}  // namespace
}  // namespace weft
