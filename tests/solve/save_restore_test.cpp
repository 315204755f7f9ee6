// Saving and restoring a simulation: bitwise the same as never having stopped, for every method, and refusals that change nothing.
// In a fresh process: command_line_test.cpp kills a program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

#include "compute/commands.h"
#include "tests/support/every_method.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using SimulationSnapshot = GpuTest;

constexpr double kOddFrame = 0.0123;   // s, no whole number of substeps

void frame(Simulation& simulation, int k) {
  const Vec3 target{0.5f, 0.01f * static_cast<float>(k), -0.5f}, centre{0.3f, -0.5f + 0.01f * static_cast<float>(k), 0};
  must(simulation.move_anchors(1, std::span(&target, 1)));
  must(simulation.move_collider(1, {.centre = centre, .normal = {0, 1, 0}, .rotation = {}}));
  if (k == 3) must(simulation.set_gravity({0, -5, 1}));
  must(simulation.advance(kOddFrame));
}

void expect_same(const Simulation& a, const Simulation& b) {
  const auto bits = [](const std::vector<gpu::vec4>& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(gpu::vec4));
  };
  EXPECT_EQ(hash_of(a), hash_of(b));
  EXPECT_TRUE(bits(must(a.read_velocities())) == bits(must(b.read_velocities())));
  EXPECT_EQ(must(a.read_vertex_normals()), must(b.read_vertex_normals()));
  EXPECT_EQ(a.time(), b.time());
  const Counts x = a.counts(), y = b.counts();
  EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << "contacts " << x.contacts_most << " and " << y.contacts_most << ", detections "
                                              << x.detections << " and " << y.detections;
}

// Goes on until a frame ends with candidates that the next one uses again: a frame that begins with a detection needs none.
Snapshot with_candidates(Simulation& simulation, int& frames) {
  for (; frames < 60; ++frames) {
    frame(simulation, frames);
    const Snapshot snapshot = must(simulation.save());
    const auto candidates = std::ranges::find(snapshot.contents, "candidates", &Snapshot::Content::name);
    if (candidates != snapshot.contents.end() && candidates->bytes.size() > 16 * sizeof(gpu::uvec4))
      return ++frames, snapshot;
  }
  throw std::runtime_error("every frame ended with a detection needed");   // what follows looks into them
}

TEST_F(SimulationSnapshot, going_on_from_a_snapshot_is_bitwise_the_same_as_never_having_stopped) {
  for (const Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    const auto whole = must(Simulation::create(device(), subject.scene));
    for (int k = 0; k < 9; ++k) frame(*whole, k);
    const Vec3 later{0.45f, 0.1f, -0.5f};
    must(whole->move_anchors(1, std::span(&later, 1)));   // not taken yet
    Snapshot snapshot = must(whole->save());
    snapshot.note = {std::byte{1}};
    const auto bytes = snapshot_bytes(snapshot);
    const auto resumed = must(Simulation::create(device(), subject.scene));
    must(resumed->advance(1.0 / 60));   // it need not be a fresh one
    must(resumed->restore(must(parse_snapshot(bytes))));
    expect_same(*whole, *resumed);
    for (Simulation* simulation : {whole.get(), resumed.get()}) must(simulation->advance(kOddFrame));
    for (int k = 10; k < 17; ++k)
      for (Simulation* simulation : {whole.get(), resumed.get()}) frame(*simulation, k);
    expect_same(*whole, *resumed);
    EXPECT_EQ(whole->counts().non_finite, 0u);
    EXPECT_EQ(whole->counts().unaccelerated > 0, subject.scene.solver.method == Method::chebyshev);
    EXPECT_EQ(whole->counts().contacts_most > 16, subject.scene.contacts.enabled);
    must(whole->restore(snapshot));   // back in time, too
    must(whole->advance(kOddFrame));
    for (int k = 10; k < 17; ++k) frame(*whole, k);
    expect_same(*whole, *resumed);
    const Snapshot one = must(whole->save()), other = must(resumed->save());
    ASSERT_EQ(one.contents.size(), other.contents.size());
    for (std::size_t k = 0; k < one.contents.size(); ++k) {
      const auto& [name, bytes] = one.contents[k];
      EXPECT_TRUE(bytes == other.contents[k].bytes) << name;
      if (name == "displacement_bounds") {   // nothing beyond the last particle, which no pass ever wrote
        EXPECT_EQ(bytes.size(), 4 * whole->fabric().positions.size());
      }
    }
    EXPECT_TRUE(snapshot_bytes(one) == snapshot_bytes(other))
        << "capacity for " << one.capacity << " and " << other.capacity << " candidates";
  }
}

// Threads find candidates in any order: reversed, they lead to the same bits, and a snapshot of the same state is the same file.
TEST_F(SimulationSnapshot, the_order_of_candidates_reaches_neither_frames_nor_files) {
  const Scene scene = subjects().back().scene;
  const auto whole = must(Simulation::create(device(), scene));
  int done = 0;
  const Snapshot snapshot = with_candidates(*whole, done);
  Snapshot turned = snapshot;
  const auto found = std::ranges::find(turned.contents, "candidates", &Snapshot::Content::name);
  constexpr std::size_t kBytes = sizeof(gpu::uvec4);
  const std::size_t candidates = found->bytes.size() / kBytes;
  for (std::size_t k = 0; k < candidates / 2; ++k) {
    const auto at = found->bytes.begin() + static_cast<std::ptrdiff_t>(k * kBytes);
    std::swap_ranges(at, at + kBytes, found->bytes.end() - static_cast<std::ptrdiff_t>((k + 1) * kBytes));
  }
  ASSERT_FALSE(snapshot_bytes(turned) == snapshot_bytes(snapshot));
  const auto other = must(Simulation::create(device(), scene));
  must(other->restore(turned));
  EXPECT_TRUE(snapshot_bytes(must(other->save())) == snapshot_bytes(snapshot));
  for (int k = done; k < done + 8; ++k)
    for (Simulation* simulation : {whole.get(), other.get()}) frame(*simulation, k);
  expect_same(*whole, *other);
}

// Particles, those of mesh colliders too, have an origin of their own there; frames that the host does not wait for end the same.
TEST_F(SimulationSnapshot, cloth_on_a_mesh_collider_10_km_away_goes_on_the_same_after_frames_of_submit_and_record) {
  const test::Folder folder;
  folder.write("floor.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n");
  Scene scene = sheet(8);
  scene.folder = folder / "";
  scene.cloths[0].transform.translate = {10e3f, 0.02f, -10e3f};
  scene.contacts.enabled = true;
  Collider& floor = scene.colliders.emplace_back();
  floor.shape = ColliderShape::mesh;
  floor.mesh = "floor.obj";
  floor.centre = {10e3f, 0, -10e3f};
  floor.keys = {{0, {}, {0, 1, 0}, 0}, {1, {0, 0.25f, 0}, {0, 1, 0}, 30}};
  const auto on = [&](Simulation& simulation, int frames) {
    for (int k = 0; k < frames; ++k) {
      must(simulation.submit(kOddFrame));
      must(simulation.read_positions());   // waits: the host's own commands must come after it
      must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) { must(simulation.record(commands, kOddFrame)); }));
    }
  };
  const auto whole = must(Simulation::create(device(), scene));
  on(*whole, 6);
  EXPECT_GT(length(whole->origin()), 10e3f);
  const Snapshot snapshot = must(parse_snapshot(snapshot_bytes(must(whole->save()))));
  const auto resumed = must(Simulation::create(device(), scene));
  must(resumed->restore(snapshot));
  expect_same(*whole, *resumed);
  for (Simulation* simulation : {whole.get(), resumed.get()}) on(*simulation, 6);
  expect_same(*whole, *resumed);
  EXPECT_EQ(whole->colliders()[0].centre, resumed->colliders()[0].centre);
  EXPECT_GT(whole->counts().contacts_most, 16u);
}

Anchor held_everywhere() {
  Anchor anchor;
  anchor.box = {{-9, -9, -9}, {9, 9, 9}};   // m
  return anchor;
}

// Its position does not tell its target.
TEST_F(SimulationSnapshot, an_anchor_that_waits_for_cloth_goes_on_waiting_and_on_its_way) {
  Scene scene = sheet(8);
  scene.contacts.enabled = true;
  scene.cloths[0].anchors.push_back(held_everywhere());
  scene.cloths.push_back(scene.cloths[0]);   // lies on it, and cannot go away
  scene.cloths[1].anchors.clear();
  scene.cloths[1].grid->size = {0.6f, 0.6f};
  scene.cloths[1].transform.translate = {0.01f, 0.006f, 0.02f};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[2].grid->size = {0.2f, 0.2f};
  scene.cloths[2].transform.translate = {0.03f, 0.02f, 0.04f};
  scene.cloths[2].anchors[0] = held_at({Corner::low_low});
  const auto whole = must(Simulation::create(device(), scene));
  const std::uint32_t pin = whole->fabric().cloths[2].first_anchor;
  const auto lead = [&](Simulation& simulation, float y) {
    const Vec3 target = whole->fabric().anchors[pin].rest + Vec3{0, y, 0};
    must(simulation.move_anchors(pin, {&target, 1}));
    for (int k = 0; k < 5; ++k) must(simulation.advance(1.0 / 60));
    return must(simulation.read_positions())[whole->fabric().anchors[pin].particle].y - target.y;
  };
  EXPECT_EQ(whole->counts().tracking_error, 0);
  const float off = lead(*whole, -0.022f);
  EXPECT_GT(off, 0.002f) << "the sheet between is in the way";
  EXPECT_GT(whole->counts().tracking_error, 0.99f * off);
  const auto resumed = must(Simulation::create(device(), scene));
  must(resumed->restore(must(whole->save())));
  for (Simulation* simulation : {whole.get(), resumed.get()})
    for (int k = 0; k < 5; ++k) must(simulation->advance(1.0 / 60));
  expect_same(*whole, *resumed);
  EXPECT_EQ(lead(*resumed, 0.01f), 0) << "the way is free";
  EXPECT_LT(resumed->counts().tracking_error, 0.022f) << "less than its target was moved by";
}

TEST_F(SimulationSnapshot, a_snapshot_that_does_not_fit_is_refused_and_changes_nothing) {
  const auto simulation = must(Simulation::create(device(), moving(6)));
  frame(*simulation, 0);
  const Snapshot good = must(simulation->save());
  const std::vector<std::byte> before = snapshot_bytes(good);
  const auto refuse = [&](const char* word, auto&& change) {
    Snapshot bad = good;
    change(bad);
    const auto restored = simulation->restore(bad);
    ASSERT_FALSE(restored) << word;
    EXPECT_NE(restored.error().find(word), std::string::npos) << restored.error();
    EXPECT_TRUE(snapshot_bytes(must(simulation->save())) == before) << word;
  };
  const auto other = must(Simulation::create(device(), moving(7)));
  refuse("another scene", [&](Snapshot& s) { s = must(other->save()); });
  // What no simulation writes, but a program that makes up a digest could.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto named = [](Snapshot& s, const char* name) {
    const auto at = std::ranges::find(s.contents, name, &Snapshot::Content::name);
    if (at == s.contents.end()) throw std::runtime_error(std::string("no buffer ") + name);
    return at;
  };
  const auto poke = [](Snapshot::Content& content, std::size_t at, float value) {
    std::memcpy(content.bytes.data() + at, &value, sizeof value);
  };
  refuse("particle 2", [&](Snapshot& s) { poke(*named(s, "positions"), 36, nan); });
  refuse("velocities of particle 0", [&](Snapshot& s) { poke(*named(s, "velocities"), 12, 1e9f); });
  refuse("buffer positions has 16", [&](Snapshot& s) { named(s, "positions")->bytes.resize(16); });
  refuse("buffer positions has 0", [&](Snapshot& s) { named(s, "positions")->name = "place"; });
  refuse("anchors", [&](Snapshot& s) { poke(s.contents.back(), 16, nan); });   // the first one's target
  refuse("anchors", [](Snapshot& s) { s.contents.back().bytes.resize(sizeof(gpu::Anchor)); });
  refuse("buffers instead of", [](Snapshot& s) { s.contents.pop_back(); });
  refuse("left over", [](Snapshot& s) { s.left_over = std::numeric_limits<double>::quiet_NaN(); });
  refuse("haste", [](Snapshot& s) { s.haste = 2; });
  refuse("haste", [](Snapshot& s) { s.haste = std::numeric_limits<float>::quiet_NaN(); });
  refuse("gravity", [&](Snapshot& s) { s.gravity.z = nan; });
  refuse("phase", [](Snapshot& s) { s.phase = 3; });
  refuse("drives anchor 2", [](Snapshot& s) { s.anchors[0].anchor = 2; });
  refuse("colliders instead of 3", [](Snapshot& s) { s.colliders.clear(); });
  refuse("collider 1", [&](Snapshot& s) { s.colliders[1].pending.rotation.x = nan; });

  const auto fine = must(Simulation::create(device(), fine_and_held()));
  const auto refused_fine = [&](const char* word, auto&& change) {
    Snapshot bad = must(fine->save());
    change(bad);
    const auto restored = fine->restore(bad);
    ASSERT_FALSE(restored) << word;
    EXPECT_NE(restored.error().find(word), std::string::npos) << restored.error();
  };
  refused_fine("supports has a vector that is not finite", [&](Snapshot& s) { poke(*named(s, "supports"), 36, nan); });
  refused_fine("support_bodies has collider", [&](Snapshot& s) { poke(*named(s, "support_bodies"), 36, 1); });

  Scene contact_scene = moving(6);
  contact_scene.contacts.enabled = true;
  const auto contacts = must(Simulation::create(device(), contact_scene));
  for (int k = 0; k < 30; ++k) must(contacts->advance(1.0 / 60));
  int frames = 0;
  const Snapshot found = with_candidates(*contacts, frames);
  const auto refused = [&](const char* word, auto&& change) {
    Snapshot bad = found;
    change(bad);
    const auto restored = contacts->restore(bad);
    ASSERT_FALSE(restored) << word;
    EXPECT_NE(restored.error().find(word), std::string::npos) << restored.error();
    EXPECT_FALSE(contacts->fits(bad));
  };
  const auto content = [](Snapshot& s, const char* name) {
    return std::find_if(s.contents.begin(), s.contents.end(), [&](const auto& c) { return c.name == name; })->bytes.data();
  };
  refused("a candidate has particle", [&](Snapshot& s) { std::memset(content(s, "candidates"), 0xff, 3); });
  refused("detected_positions has a vector that is not finite",
          [&](Snapshot& s) { std::memcpy(content(s, "detected_positions") + 16, &nan, 4); });
  refused("trajectories has a vector that is not finite", [&](Snapshot& s) { std::memcpy(content(s, "trajectories") + 4, &nan, 4); });
  refused("displacement_bounds has one of nan m", [&](Snapshot& s) { std::memcpy(content(s, "displacement_bounds") + 8, &nan, 4); });
  refused("near_bounds has one of nan m", [&](Snapshot& s) { std::memcpy(content(s, "near_bounds") + 8, &nan, 4); });
  refused("its least displacement bound is nan m",
          [&](Snapshot& s) { std::memcpy(content(s, "detection") + offsetof(gpu::Detection, least), &nan, 4); });
  const std::uint32_t long_ago = 11;
  refused("its last detection is 11 substeps ago",
          [&](Snapshot& s) { std::memcpy(content(s, "detection") + offsetof(gpu::Detection, steps), &long_ago, 4); });
  // 49 particles of 72 triangles, 120 edges: no file may ask for a capacity of gigabytes for the pairs of these.
  refused("more than this scene can take", [](Snapshot& s) { s.capacity = 1u << 26; });
  EXPECT_TRUE(contacts->fits(found));
}

}  // namespace
}  // namespace weft
