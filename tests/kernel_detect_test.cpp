// The detection's passes against their twin: on random soups every pair that may meet is found once and no other, whatever the
// cell, the workgroup and the way of gathering; nothing is lost silently; and what is degenerate loses nothing either.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>

#include "shaders/detect.ref.h"
#include "tests/single_pass.h"

namespace weft {
namespace {

using Detect = GpuTest;
using reference::Particles;

constexpr double kReach = 0.004;   // m

struct Soup {
  CookedFabric fabric;
  std::vector<gpu::vec4> predicted;
};

gpu::vec4 sum(const gpu::vec4& a, const gpu::vec4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w}; }
gpu::vec4 times(float s, const gpu::vec4& a) { return {s * a.x, s * a.y, s * a.z, a.w}; }

// What is left of a fabric with contacts when there is nothing but particles and triangles between them.
Soup soup_of(Random& random, std::uint32_t particles) {
  SolverSettings solver;
  solver.substeps = 1;
  Soup soup{loose_particles(random, particles, solver), {}};
  soup.fabric.materials.assign(3, soup.fabric.materials[0]);
  for (const gpu::vec4& x : soup.fabric.positions) soup.fabric.rest.push_back({x.x, x.y, x.z, 0.003f});
  soup.predicted = soup.fabric.positions;
  return soup;
}

void add_triangle(Soup& soup, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  soup.fabric.triangles.push_back({a, b, c});
  const std::uint32_t corners[] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
    const auto same = [low = low, high = high](gpu::uvec2 e) { return e.x == low && e.y == high; };
    if (low != high && std::none_of(soup.fabric.edges.begin(), soup.fabric.edges.end(), same)) soup.fabric.edges.push_back({low, high});
  }
}

// Triangles of three decades in size, three cloths, every third sharing an edge with the one before; one cloth is held, as a
// mesh collider is. They drift together, by cloth, and each particle goes its own way besides. Rest poses are near the poses
// at hand, so that the distance a pair keeps is limited for some.
Soup random_soup(Random& random, std::uint32_t triangles) {
  Soup soup = soup_of(random, 3 * triangles);
  const gpu::vec4 drift[] = {anywhere(random, 0.02, 0), {0, 0, 0, 0}, anywhere(random, 0.002, 0)};
  gpu::vec4 middle{};
  double size = 0;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const std::uint32_t triangle = i / 3, cloth = triangle / 3 % 3;
    if (i % 3 == 0) {
      middle = anywhere(random, 0.4, 0);
      size = std::pow(10, between(random, -3, -0.3));
    }
    const gpu::vec4 x = sum(middle, anywhere(random, size, 0));
    soup.fabric.positions[i] = {x.x, x.y, x.z, cloth == 1 ? 0 : soup.fabric.positions[i].w};
    soup.fabric.velocities[i].w = std::bit_cast<float>(cloth);
    const gpu::vec4 rest = sum(x, anywhere(random, 0.003, 0));
    soup.fabric.rest[i] = {rest.x, rest.y, rest.z, 0.002f + 0.002f * static_cast<float>(cloth)};
    soup.predicted[i] = sum(soup.fabric.positions[i], sum(drift[cloth], anywhere(random, std::pow(10, between(random, -5, -2)), 0)));
    if (i % 3 != 2) continue;
    if (triangle % 3 == 1) add_triangle(soup, i - 2, i - 4, i - 3);
    else add_triangle(soup, i - 2, i - 1, i);
  }
  return soup;
}

struct Setting {
  bool gather_storage = false;
  std::uint32_t workgroup = 64;
  double cell = 0.05, reach = kReach;
  std::uint32_t capacity = 1 << 18;
};

/// A solver in which one detection has run, but for the passes after `last`.
struct Detected {
  SinglePass passes;
  const Soup& soup;

  static Scene scene(const Setting& setting) {
    Scene scene = loose_scene(1);
    scene.contacts.enabled = true;
    scene.contacts.capacity = setting.capacity;
    scene.contacts.cell = setting.cell;
    scene.contacts.reach = setting.reach;
    return scene;
  }
  Detected(const compute::Device& device, const Soup& of, const Setting& setting, std::string_view last = "pair_edges")
      : passes(device, scene(setting), of.fabric, setting.gather_storage, setting.workgroup), soup(of) {
    passes.begin(frame_of(1));
    passes.put(gpu::predicted, soup.predicted);
    for (const char* name : {"detect_arm", "detect_path", "grid_count", "grid_total", "grid_scan", "grid_fill", "pair_faces", "pair_edges"}) {
      passes.run(name);
      if (name == last) break;
    }
  }
  gpu::Detection detection() const { return passes.get<gpu::Detection>(gpu::detection, 1).front(); }
  std::vector<gpu::Candidate> candidates(std::uint32_t count) const {
    std::vector<gpu::Candidate> all;
    for (const gpu::uvec4& packed : passes.get<gpu::uvec4>(gpu::candidates, count)) all.push_back(gpu::unpack_candidate(packed));
    return all;
  }
  // The twin goes by the paths that the GPU has: those are tested by themselves.
  reference::Tracks tracks() const {
    reference::Tracks t;
    t.references = points(passes.particles(gpu::references));
    t.paths = points(passes.particles(gpu::paths));
    t.rest = points(soup.fabric.rest);
    for (const gpu::vec4& rest : soup.fabric.rest) t.thickness.push_back(rest.w);
    t.inverse_masses = inverse_masses(soup.fabric);
    for (const gpu::vec4& v : soup.fabric.velocities) t.cloth.push_back(std::bit_cast<std::uint32_t>(v.w));
    t.reach = detection().reach;
    return t;
  }
};

// A pair's name: which kind, and its particles in the order in which the buffers list them.
using Name = std::pair<bool, Particles>;

// Edges find each other from either side.
Name name_of(bool edges, Particles p) {
  if (edges && std::pair(p[2], p[3]) < std::pair(p[0], p[1])) p = {p[2], p[3], p[0], p[1]};
  return {edges, p};
}

struct Oracle {
  std::map<Name, double> kept;    // pairs that are candidates beyond doubt, and the distance they keep
  std::set<Name> doubtful;        // within what single precision can tell
};

Oracle all_pairs(const Soup& soup, const reference::Tracks& t, double doubt) {
  Oracle oracle;
  const auto judge = [&](const Particles& p, int a) {
    if (!reference::can_be_pair(t, p, a)) return;
    const double spare = reference::spare_distance(t, p, a);
    if (spare < -doubt) oracle.kept[name_of(a == 2, p)] = reference::keep_of(t, p, a);
    else if (spare <= doubt) oracle.doubtful.insert(name_of(a == 2, p));
  };
  for (std::uint32_t i = 0; i < soup.fabric.positions.size(); ++i)
    for (const auto& [a, b, c] : soup.fabric.triangles) judge({i, a, b, c}, 1);
  for (std::size_t i = 0; i < soup.fabric.edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) judge({soup.fabric.edges[j].x, soup.fabric.edges[j].y, soup.fabric.edges[i].x, soup.fabric.edges[i].y}, 2);
  return oracle;
}

// Each box may be larger by four units in the last place of the largest coordinate, on purpose (grid.glsl), and the chain of
// some twenty operations rounds as often; coordinates, paths included, are below `size`.
double doubt_of(double size) { return (2 * 8 + 40) * kRounding * size; }

void expect_agreement(const Detected& detected, const Oracle& oracle, double doubt) {
  const std::uint32_t count = detected.detection().candidates;
  std::map<Name, int> found;
  for (const gpu::Candidate& c : detected.candidates(count)) {
    const Name name = name_of(c.edges, {c.particle[0], c.particle[1], c.particle[2], c.particle[3]});
    ++found[name];
    const auto wanted = oracle.kept.find(name);
    if (wanted == oracle.kept.end()) EXPECT_TRUE(oracle.doubtful.contains(name)) << "not a pair that may meet";
    else EXPECT_NEAR(c.keep, wanted->second, doubt);
  }
  for (const auto& [name, times] : found) EXPECT_EQ(times, 1);
  std::size_t missed = 0;
  for (const auto& [name, keep] : oracle.kept) missed += !found.contains(name);
  EXPECT_EQ(missed, 0u) << "of " << oracle.kept.size();
}

TEST_F(Detect, finds_every_pair_that_may_meet_once_and_no_other) {
  for (const bool gather_storage : {false, true})
    for (const std::uint32_t workgroup : {64u, 512u})
      for (const std::uint64_t seed : {1u, 2u}) {
        Random random(10 * seed + 2 * gather_storage + (workgroup > 64));
        const Soup soup = random_soup(random, 70);
        const Setting setting{gather_storage, workgroup, std::pow(10, between(random, -3, 0.5))};
        const Detected detected(device(), soup, setting);
        const double doubt = doubt_of(2);
        const Oracle oracle = all_pairs(soup, detected.tracks(), doubt);
        SCOPED_TRACE(testing::Message() << "cell " << setting.cell << ", " << oracle.kept.size() << " pairs, " << oracle.doubtful.size() << " in doubt");
        ASSERT_GT(oracle.kept.size(), 500u);
        ASSERT_LT(oracle.doubtful.size(), 50u);
        expect_agreement(detected, oracle, doubt);
      }
}

TEST_F(Detect, loses_no_pair_of_what_is_degenerate_or_far_away) {
  // Coincident particles, triangles and edges without extent, and a triangle as large as the world.
  for (const float far : {0.f, 1e3f, 1e5f}) {
    Random random(5);
    Soup soup = random_soup(random, 30);
    const auto at = [&](std::uint32_t i) -> gpu::vec4& { return soup.fabric.positions[i]; };
    at(1) = at(0);                                     // an edge without length
    at(3) = at(4) = at(5) = at(0);                     // a triangle without edges, at a corner of another
    at(8) = times(0.5f, sum(at(6), at(7)));            // one without area
    at(20) = {2e5f, -2e5f, 1e5f, 1};
    for (std::uint32_t i = 0; i < soup.predicted.size(); ++i) {
      if (i != 20 && i % 2 == 0) at(i).x += far;
      soup.fabric.rest[i] = {at(i).x, at(i).y, at(i).z, soup.fabric.rest[i].w};
      soup.predicted[i] = sum(at(i), times(i % 5 == 0 ? 1e4f : 1, anywhere(random, 0.01, 0)));
    }
    const Detected detected(device(), soup, {false, 64, 0.01});
    const double doubt = doubt_of(4e5);
    expect_agreement(detected, all_pairs(soup, detected.tracks(), doubt), doubt);
  }
}

TEST_F(Detect, holds_all_particles_of_pairs_that_find_no_place) {
  Random random(6);
  const Soup soup = random_soup(random, 60);
  const Detected detected(device(), soup, {false, 64, 0.05, kReach, 16});
  const Oracle oracle = all_pairs(soup, detected.tracks(), doubt_of(2));
  const std::uint32_t counted = detected.detection().candidates;
  EXPECT_GE(counted, oracle.kept.size());
  EXPECT_LE(counted, oracle.kept.size() + oracle.doubtful.size());
  std::set<Name> placed;
  for (const gpu::Candidate& c : detected.candidates(16)) placed.insert(name_of(c.edges, {c.particle[0], c.particle[1], c.particle[2], c.particle[3]}));
  EXPECT_EQ(placed.size(), 16u);
  const auto leashes = detected.passes.get<std::uint32_t>(gpu::leashes, soup.predicted.size());
  std::set<std::uint32_t> lost;
  for (const auto& [name, keep] : oracle.kept)
    if (!placed.contains(name)) lost.insert(name.second.begin(), name.second.end());
  for (const std::uint32_t i : lost) EXPECT_EQ(leashes[i], 0u);
  for (const Name& name : oracle.doubtful) lost.insert(name.second.begin(), name.second.end());
  const float reach = detected.detection().reach;
  for (std::uint32_t i = 0; i < leashes.size(); ++i) EXPECT_TRUE(lost.contains(i) || std::bit_cast<float>(leashes[i]) == reach);
}

TEST_F(Detect, holds_the_four_particles_of_a_lost_pair_and_no_other) {
  Random random(13);
  Soup soup = soup_of(random, 8);   // twice a vertex above a triangle
  for (std::uint32_t i = 0; i < 8; ++i) {
    const gpu::vec4 corners[] = {{0, 0.001f, 0, 1}, {-0.1f, 0, -0.1f, 1}, {0.1f, 0, -0.1f, 1}, {0, 0, 0.1f, 1}};
    soup.fabric.positions[i] = soup.fabric.rest[i] = sum(corners[i % 4], {i < 4 ? 0.f : 1, 0, 0, 0});
    soup.fabric.rest[i].w = 0.001f;
    if (i % 4 == 3) add_triangle(soup, i - 2, i - 1, i);
  }
  soup.predicted = soup.fabric.positions;
  const Detected detected(device(), soup, {false, 64, 0.05, kReach, 1});
  EXPECT_EQ(detected.detection().candidates, 2u);
  const std::uint32_t kept = detected.candidates(1)[0].particle[0];
  const auto leashes = detected.passes.get<std::uint32_t>(gpu::leashes, 8);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(leashes[i] > 0, i / 4 == kept / 4);
}

TEST_F(Detect, a_flat_sheet_at_rest_has_no_candidates_when_the_reach_is_small_against_its_edges) {
  constexpr std::uint32_t kSide = 17;
  Random random(7);
  Soup soup = soup_of(random, kSide * kSide);
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const gpu::vec4 x{0.05f * static_cast<float>(i % kSide), 0, 0.05f * static_cast<float>(i / kSide), 10};
    soup.fabric.positions[i] = x;
    soup.fabric.velocities[i].w = 0;
    soup.fabric.rest[i] = {x.x, x.y, x.z, 0.5f};   // far thicker than an edge
    soup.predicted[i] = x;
    if (i % kSide == kSide - 1 || i / kSide == kSide - 1) continue;
    add_triangle(soup, i, i + 1, i + kSide);
    add_triangle(soup, i + 1, i + kSide + 1, i + kSide);
  }
  for (const double speed : {0.0, 0.002}) {
    for (gpu::vec4& p : soup.predicted) p.y = static_cast<float>(speed);
    EXPECT_EQ(Detected(device(), soup, {false, 64, 0.08, 5e-4}).detection().candidates, 0u) << "falling " << speed << " m a substep";
  }
}

TEST_F(Detect, grid_lists_every_primitive_in_its_slot_and_leaves_the_counts_at_zero) {
  Random random(8);
  const Soup soup = random_soup(random, 200);
  const std::size_t primitives = soup.fabric.triangles.size() + soup.fabric.edges.size();
  const std::size_t slots = contact_sizes(Detected::scene({}), soup.fabric).slots;
  const Detected counted(device(), soup, {}, "grid_scan");
  const auto counts = counted.passes.get<std::uint32_t>(gpu::grid_counts, slots);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), primitives);
  const Detected filled(device(), soup, {}, "grid_fill");
  EXPECT_EQ(filled.passes.get<std::uint32_t>(gpu::grid_counts, slots), std::vector<std::uint32_t>(slots, 0));
  std::set<std::uint32_t> listed;
  const auto entries = filled.passes.get<gpu::vec4>(gpu::grid_entries, 3 * primitives);   // the other places hold the box's sides and the edge
  for (std::size_t k = 0; k < entries.size(); k += 3) listed.insert(std::bit_cast<std::uint32_t>(entries[k].w) & 0x0fffffffu);
  EXPECT_EQ(listed.size(), primitives);
  EXPECT_EQ(*listed.rbegin(), primitives - 1);
}

TEST_F(Detect, starts_are_the_sums_of_the_counts_before_them) {
  // Slots: the least, a block or less than one, and several blocks.
  for (const std::uint32_t workgroup : {64u, 512u})
    for (const std::size_t slots : {64u, 512u, 4096u, 32768u}) {
      Random random(9);
      Soup soup = soup_of(random, 64);
      soup.fabric.triangles.assign(2 * slots - 3, {0, 1, 2});
      soup.fabric.edges.assign(3, {0, 1});
      Detected detected(device(), soup, {false, workgroup}, "detect_arm");
      ASSERT_EQ(contact_sizes(Detected::scene({}), soup.fabric).slots, slots);
      std::vector<std::uint32_t> counts(slots), wanted(slots + 1);
      for (std::uint32_t& count : counts) count = static_cast<std::uint32_t>(random() % 5 == 0 ? random() % 1000 : 0);
      std::partial_sum(counts.begin(), counts.end(), wanted.begin() + 1);
      detected.passes.put(gpu::grid_counts, counts);
      detected.passes.run("grid_total");
      detected.passes.run("grid_scan");
      EXPECT_EQ(detected.passes.get<std::uint32_t>(gpu::grid_starts, slots + 1), wanted) << slots << " slots, " << workgroup << " threads";
    }
}

TEST_F(Detect, paths_are_the_substep_ahead_ten_times_but_no_longer_than_32_cells_a_substep) {
  Random random(10);
  Soup soup = random_soup(random, 40);
  for (std::size_t i = 0; i < soup.predicted.size(); i += 4) soup.predicted[i].y += 0.5f;
  const double cell = 0.01;
  const Detected detected(device(), soup, {false, 64, cell}, "detect_path");
  const auto x = points(soup.fabric.positions), p = points(soup.predicted), paths = points(detected.passes.particles(gpu::paths));
  EXPECT_EQ(largest_gap(detected.passes.particles(gpu::references), x), 0);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((paths[i] - reference::path_along(p[i] - x[i], cell)).norm(), 20 * kRounding * 4);
  for (const std::uint32_t leash : detected.passes.get<std::uint32_t>(gpu::leashes, x.size())) EXPECT_EQ(std::bit_cast<float>(leash), static_cast<float>(kReach));
}

TEST_F(Detect, detect_arm_detects_when_due_and_adapts_the_reach_to_how_often_that_is) {
  Random random(11);
  Soup soup = random_soup(random, 20);
  Detected detected(device(), soup, {}, "detect_arm");
  SinglePass& passes = detected.passes;
  const auto low = static_cast<float>(kReach), high = contact_sizes(Detected::scene({}), soup.fabric).reach_high;
  gpu::Detection d = detected.detection();
  EXPECT_EQ(d.reach, low);
  EXPECT_EQ(d.due, 0u);
  EXPECT_EQ(d.age, 0u);
  EXPECT_EQ(d.particles.x, 1u);
  const auto primitives = static_cast<std::uint32_t>(soup.fabric.triangles.size() + soup.fabric.edges.size());
  EXPECT_EQ(d.primitives.x, (primitives + 63) / 64);
  EXPECT_EQ(d.blocks.x, 1u);
  for (const gpu::Groups& groups : {d.particles, d.primitives, d.blocks}) EXPECT_EQ(std::pair(groups.y, groups.z), std::pair(1u, 1u));
  EXPECT_EQ(passes.counters().detections, 1u);
  // Not due: nothing to dispatch, and the detection grows old.
  for (std::uint32_t age = 1; age < WEFT_HORIZON + 3; ++age) {
    passes.run("detect_arm");
    d = detected.detection();
    EXPECT_EQ(d.age, std::min(age, WEFT_HORIZON));
    for (const gpu::Groups& groups : {d.particles, d.primitives, d.blocks}) EXPECT_EQ(groups.x, 0u);
  }
  const auto due_at_age = [&](float reach, std::uint32_t age, std::uint32_t candidates = 100'000) {
    gpu::Detection state = detected.detection();
    state.reach = reach;
    state.age = age;
    state.due = 1;
    state.candidates = candidates;
    state.extents[5] = 9;
    passes.put(gpu::detection, std::vector{state});
    passes.run("detect_arm");
    state = detected.detection();
    EXPECT_EQ(state.due + state.age + state.candidates + state.extents[5], 0u);
    return state.reach;
  };
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 0), 3 * low) << "one substep old";
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 1), 3 * low);
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 2), 2 * low);
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 8), 2 * low);
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 9), 1.8f * low) << "its paths held to the end";
  EXPECT_FLOAT_EQ(due_at_age(0.9f * high, 0), high);
  EXPECT_FLOAT_EQ(due_at_age(1.05f * low, 10), low);
  EXPECT_FLOAT_EQ(due_at_age(2 * low, 8, 1), 3 * low) << "so few pairs cost nothing";
  EXPECT_EQ(passes.counters().detections, 9u);
  // Once at the end of paths that nobody left, if there are many pairs; and then not again.
  gpu::Detection state = detected.detection();
  state.age = WEFT_HORIZON;
  state.candidates = 100'000;
  passes.put(gpu::detection, std::vector{state});
  passes.run("detect_arm");
  EXPECT_EQ(detected.detection().age, 0u);
  EXPECT_EQ(detected.detection().calm, 1u);
  state.calm = 1;
  passes.put(gpu::detection, std::vector{state});
  passes.run("detect_arm");
  EXPECT_EQ(detected.detection().age, WEFT_HORIZON);
  EXPECT_EQ(passes.counters().detections, 10u);
}

TEST_F(Detect, contact_arm_dispatches_what_there_is_room_for_and_counts_the_rest) {
  Random random(12);
  Soup soup = random_soup(random, 40);
  Detected detected(device(), soup, {false, 64, 0.05, kReach, 100}, "detect_arm");
  const auto armed = [&](std::uint32_t candidates, std::uint32_t age) {
    gpu::Detection state = detected.detection();
    state.candidates = candidates;
    state.age = age;
    state.lowered[0] = state.lowered[1] = state.lowered[2] = state.unsafe = 1;
    detected.passes.put(gpu::detection, std::vector{state});
    detected.passes.run("contact_arm");
    state = detected.detection();
    EXPECT_EQ(state.lowered[0] + state.lowered[1] + state.lowered[2] + state.unsafe, 0u);
    return std::pair(state.contacts.x, state.touched.x);
  };
  using Groups = std::pair<std::uint32_t, std::uint32_t>;
  EXPECT_EQ(armed(0, 0), Groups(0, 0));
  EXPECT_EQ(armed(65, 0), Groups(2, 2));
  EXPECT_EQ(armed(130, 0), Groups(2, 2));
  EXPECT_EQ(armed(140, 1), Groups(2, 2)) << "an old detection is not counted again";
  EXPECT_EQ(armed(3, 0), Groups(1, 2));
  EXPECT_EQ(detected.passes.counters().contacts_most, 130u);
  EXPECT_EQ(detected.passes.counters().contacts_lost, 30u);
}

}  // namespace
}  // namespace weft
