// What the detection's passes prepare and decide: when a detection is needed, displacement bounds, predicted trajectories, the grid's
// offsets, and the dispatch arguments of the passes after them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "tests/support/contact_passes.h"
#include "tests/support/detected.h"

namespace weft {
namespace {

using DetectArguments = GpuTest;

// As grid.glsl has it.
std::uint32_t bucket_of(const gpu::vec4& entry, const gpu::ContactSettings& settings) {
  const std::uint32_t level = std::bit_cast<std::uint32_t>(entry.w) >> 28;
  const float inverse = 1.0f / settings.cell * std::bit_cast<float>((127 - level) << 23);
  const auto cell = [&](float x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(x))); };
  std::uint32_t hash = cell(entry.y * inverse) * 19349663u + cell(entry.z * inverse) * 83492791u + level * 2654435761u;
  hash = (hash ^ (hash >> 15)) * 739982445u;
  return ((hash ^ (hash >> 13)) + cell(entry.x * (inverse * 4))) & (settings.buckets - 1);
}

// Buckets: the least, fewer and many more than threads. Sixteen particles without triangles are a cluster, too.
TEST_F(DetectArguments, grid_lists_every_cluster_in_its_bucket_and_leaves_the_counts_at_zero) {
  for (const std::uint32_t particles : {100u, 2000u, 40'000u}) {
    Random random(8);
    const Soup soup = particles > 100 ? soup_of(random, particles) : random_soup(random, 200);
    const gpu::ContactSettings settings = contact_settings(Detected::scene({}), with_clusters(soup.fabric));
    const std::size_t clusters = settings.clusters, buckets = settings.buckets;
    ASSERT_GT(clusters, 30u);
    const Detected filled(device(), soup, {}, "grid_fill");
    EXPECT_EQ(filled.passes.get<std::uint32_t>(buffers::grid_counts, buckets), std::vector<std::uint32_t>(buckets, 0));
    const auto starts = filled.passes.get<std::uint32_t>(buffers::grid_starts, buckets + 1);
    EXPECT_EQ(starts.front(), 0u);
    EXPECT_EQ(starts.back(), clusters);
    std::set<std::uint32_t> listed;
    const auto entries = filled.passes.get<gpu::vec4>(buffers::grid_entries, clusters);
    for (std::uint32_t bucket = 0; bucket < buckets; ++bucket) {
      ASSERT_LE(starts[bucket], starts[bucket + 1]);
      for (std::uint32_t k = starts[bucket]; k < starts[bucket + 1]; ++k) {
        EXPECT_EQ(bucket_of(entries[k], settings), bucket) << k;
        listed.insert(std::bit_cast<std::uint32_t>(entries[k].w) & 0x0fffffffu);
      }
    }
    EXPECT_EQ(listed.size(), clusters);
    EXPECT_EQ(*listed.rbegin(), clusters - 1);
  }
}

TEST_F(DetectArguments, trajectories_are_the_substep_ahead_ten_times_but_no_longer_than_32_cells_a_substep) {
  Random random(10);
  Soup soup = random_soup(random, 40);
  for (std::size_t i = 0; i < soup.predicted.size(); i += 4) soup.predicted[i].y += 0.5f;
  const double cell = 0.01;
  const Detected detected(device(), soup, {false, 64, cell}, "outline_edges");
  const auto x = points(soup.fabric.positions), p = points(soup.predicted);
  const auto trajectories = points(detected.passes.particles(buffers::trajectories));
  EXPECT_EQ(largest_gap(detected.passes.particles(buffers::detected_positions), x), 0);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT((trajectories[i] - reference::path_along(p[i] - x[i], cell)).norm(), 20 * kRounding * 4);
  for (const std::uint32_t bound : detected.passes.get<std::uint32_t>(buffers::displacement_bounds, x.size()))
    EXPECT_EQ(std::bit_cast<float>(bound), static_cast<float>(kMargin));
}

TEST_F(DetectArguments, detect_arguments_detects_when_needed_and_adapts_bounds_to_how_many_candidates_there_are) {
  Random random(11);
  Soup soup = random_soup(random, 20);
  Detected detected(device(), soup, {}, "detect_arguments");
  SinglePass& passes = detected.passes;
  const auto low = static_cast<float>(kMargin), high = contact_settings(Detected::scene({}), soup.fabric).margin_high;
  gpu::Detection d = detected.detection();
  EXPECT_EQ(d.margin, high);
  EXPECT_EQ(d.least, low);
  EXPECT_EQ(d.needs_detection, 0u);
  EXPECT_EQ(d.steps, 0u);
  EXPECT_EQ(d.particles.x, 1u);
  const auto primitives = static_cast<std::uint32_t>(soup.fabric.triangles.size() + soup.fabric.edges.size());
  EXPECT_EQ(d.outlined.x, (60 + primitives + contact_settings(Detected::scene({}), detected.fabric).clusters + 63) / 64);
  EXPECT_EQ(d.grid.x, 1u);
  for (const gpu::Groups& groups : {d.outlined, d.grid, d.clusters, d.particles, d.edges}) EXPECT_EQ(std::pair(groups.y, groups.z), std::pair(1u, 1u));
  EXPECT_EQ(passes.counters().detections, 1u);
  // None is needed: nothing to dispatch, and the steps since the last are counted.
  for (std::uint32_t steps = 1; steps < WEFT_LONGEST_LIFETIME + 3; ++steps) {
    passes.run("detect_arguments");
    d = detected.detection();
    EXPECT_EQ(d.steps, std::min(steps, WEFT_LONGEST_LIFETIME));
    for (const gpu::Groups& groups : {d.outlined, d.grid, d.clusters, d.particles, d.edges}) EXPECT_EQ(groups.x, 0u);
  }
  const auto least_after = [&](float least, std::uint32_t steps, std::uint32_t candidates) {
    gpu::Detection state = detected.detection();
    state.least = least;
    state.steps = steps;
    state.needs_detection = 1;
    state.candidates = candidates;
    state.extents[5] = state.near[1] = state.levels = 9;
    passes.put(buffers::detection, std::vector{state});
    passes.run("detect_arguments");
    state = detected.detection();
    EXPECT_EQ(state.needs_detection + state.steps + state.candidates + state.extents[5] + state.near[1] + state.levels, 0u);
    EXPECT_EQ(state.margin, high);
    EXPECT_EQ(state.horizon, candidates > 8000 ? state.lifetime : std::max(state.lifetime, 6u));
    return state.least;
  };
  EXPECT_EQ(d.lifetime, WEFT_LONGEST_LIFETIME) << "nothing is known yet";
  EXPECT_FLOAT_EQ(least_after(2 * low, 0, 1000), 3 * low) << "one substep old";
  EXPECT_EQ(detected.detection().lifetime, 2u);
  EXPECT_EQ(detected.detection().served, 1u);
  EXPECT_EQ(detected.detection().served_lifetime, WEFT_LONGEST_LIFETIME);
  EXPECT_FLOAT_EQ(least_after(2 * low, 2, 999), 3 * low) << "so few pairs cost nothing";
  EXPECT_EQ(detected.detection().lifetime, 6u);
  EXPECT_EQ(detected.detection().served_lifetime, 2u);
  EXPECT_FLOAT_EQ(least_after(2 * low, 8, 1000), 2 * low);
  EXPECT_FLOAT_EQ(least_after(2 * low, 0, 8001), 1.4f * low) << "but these do";
  least_after(low, 8, 1000);
  EXPECT_EQ(detected.detection().lifetime, WEFT_LONGEST_LIFETIME);
  EXPECT_FLOAT_EQ(least_after(1.05f * low, 10, 100'000), low);
  EXPECT_FLOAT_EQ(least_after(0.9f * high, 0, 1), high);
  EXPECT_EQ(passes.counters().detections, 8u);
  // Once at the end of trajectories that no particle left, if there are many pairs; and then not again.
  gpu::Detection state = detected.detection();
  state.steps = WEFT_LONGEST_LIFETIME;
  state.candidates = 100'000;
  passes.put(buffers::detection, std::vector{state});
  passes.run("detect_arguments");
  EXPECT_EQ(detected.detection().steps, 0u);
  EXPECT_EQ(detected.detection().settled, 1u);
  state.settled = 1;
  passes.put(buffers::detection, std::vector{state});
  passes.run("detect_arguments");
  EXPECT_EQ(detected.detection().steps, WEFT_LONGEST_LIFETIME);
  EXPECT_EQ(passes.counters().detections, 9u);
}

// Of particles that the last detection expected elsewhere: as far off as a constant acceleration would bring them in the lifetime to come,
// and three fifths more; but no less than most of the last bound, or half the largest in its cluster.
TEST_F(DetectArguments, displacement_bounds_follow_how_far_particles_have_come_off_their_trajectories) {
  Random random(13);
  Soup soup = random_soup(random, 20);
  Detected detected(device(), soup, {}, "detect_arguments");
  SinglePass& passes = detected.passes;
  const auto x = points(soup.fabric.positions), p = points(soup.predicted);
  gpu::Detection d = detected.detection();
  const double low = kMargin, margin = 3 * low, last = 1.5 * low;
  d.margin = static_cast<float>(margin);
  d.least = static_cast<float>(low);
  d.horizon = 8;
  d.served = 4;
  d.served_lifetime = 10;
  passes.put(buffers::detection, std::vector{d});
  std::vector<gpu::vec4> at, trajectory;
  std::vector<double> off;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Five of ten substeps have passed when this one ends.
    const reference::Vector way(0.01 * double(i), -0.02, 0.03), astray = std::pow(10, between(random, -6, -2)) * reference::Vector(0.6, 0, 0.8);
    at.push_back(with(p[i] - 0.5 * way + astray, last));
    trajectory.push_back(with(way, last));
    off.push_back(astray.norm());
  }
  std::vector<std::uint32_t> widest;
  for (std::size_t i = 0; i < x.size(); ++i) widest.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(low * double(1 + i % 5))));
  passes.put(buffers::near_bounds, widest);
  passes.put(buffers::detected_positions, at);
  passes.put(buffers::trajectories, trajectory);
  passes.run("detect_track");
  const auto found = passes.particles(buffers::detected_positions);
  std::set<int> kinds;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double own = 1.6 * off[i] * (8 * 9) / (5 * 6);
    const double near = 0.5 * double(std::bit_cast<float>(widest[i]));
    const double wanted = std::min(margin, std::max({own, 0.85 * last, near, low}));
    EXPECT_NEAR(found[i].w, wanted, 1e-6) << i << ", " << off[i] << " m off";
    kinds.insert(wanted == margin ? 3 : wanted == own ? 2 : wanted == near ? 1 : 0);
  }
  EXPECT_EQ(kinds.size(), 4u);
  EXPECT_EQ(largest_gap(found, x), 0);
}

TEST_F(DetectArguments, the_search_dispatches_a_thread_a_near_pair_and_none_without_a_search) {
  Random random(12);
  const Soup soup = random_soup(random, 100);
  for (const std::uint32_t capacity : {100u, 1u << 16}) {
    Detected detected(device(), soup, {false, 64, 0.05, kMargin, capacity}, "search_edges");
    const gpu::Detection found = detected.detection();
    ASSERT_GT(std::min(found.near[0], found.near[1]), 256u);
    const auto groups = [&](std::uint32_t near) { return (std::min(near, WEFT_NEAR * capacity) + 63) / 64; };
    EXPECT_EQ(found.near_faces.x, groups(found.near[0]));
    EXPECT_EQ(found.near_edges.x, groups(found.near[1]));
    const gpu::Counters counted = detected.passes.counters();
    EXPECT_EQ(counted.contacts_overflowed, capacity > 100 ? 0u : found.near[0] + found.near[1] - 400);
    EXPECT_EQ(counted.contacts_room, (std::max(found.near[0], found.near[1]) + 1) / 2);
    detected.passes.run("detect_arguments");   // none is needed
    EXPECT_EQ(detected.detection().near_faces.x + detected.detection().near_edges.x, 0u);
  }
}

// Pairs that the broad phase found and put into the lists, by their particles.
std::set<std::array<std::uint32_t, 4>> near_pairs(const Detected& detected, std::uint32_t room) {
  const ClusterLists& lists = detected.fabric.own.of<ClusterLists>();
  const gpu::Detection found = detected.detection();
  std::set<std::array<std::uint32_t, 4>> pairs;
  for (const gpu::uvec2& near : detected.passes.get<gpu::uvec2>(*buffers::near_faces.lies_in, std::min(found.near[0], room)))
    pairs.insert({near.x, lists.faces[near.y].x, lists.faces[near.y].y, lists.faces[near.y].z});
  for (const gpu::uvec2& near : detected.passes.get<gpu::uvec2>(*buffers::near_edges.lies_in, std::min(found.near[1], room)))
    pairs.insert({lists.edges[near.x].x, lists.edges[near.x].y, lists.edges[near.y].x, lists.edges[near.y].y});
  return pairs;
}

TEST_F(DetectArguments, pairs_of_the_search_that_find_no_room_are_held) {
  const auto check = [&](std::uint32_t triangles, bool united) {
    Random random(12);
    const Soup soup = random_soup(random, triangles);
    Setting setting{.united = united};
    const auto pairs_to = [&](const Detected& detected, std::uint32_t capacity) { return near_pairs(detected, WEFT_NEAR * capacity); };
    const char* last = united ? "detect_search" : "search_rare";
    const auto all = pairs_to(Detected(device(), soup, setting, last), setting.capacity);
    setting.capacity = 100;
    const Detected detected(device(), soup, setting, last);
    const auto listed = pairs_to(detected, setting.capacity);
    const auto bounds = detected.passes.get<std::uint32_t>(buffers::displacement_bounds, soup.predicted.size());
    ASSERT_GT(all.size(), listed.size() + 500);
    for (const auto& pair : all)
      for (const std::uint32_t i : pair) ASSERT_TRUE(listed.contains(pair) || bounds[i] == 0) << i;
    EXPECT_TRUE(triangles > 100 || std::ranges::count(bounds, 0u) < std::ssize(bounds)) << "all of them";
  };
  for (const bool united : {false, true})
    for (const std::uint32_t triangles : {100u, 600u}) check(triangles, united);   // of 600 many are near more clusters than lists hold
}

TEST_F(DetectArguments, the_narrow_phase_dispatches_what_there_is_capacity_for_and_counts_the_rest) {
  Random random(12);
  const Soup soup = random_soup(random, 100);
  for (const std::uint32_t capacity : {300u, 1u << 16}) {
    Detected detected(device(), soup, {false, 64, 0.05, kMargin, capacity});
    const gpu::Detection found = detected.detection();
    const std::uint32_t stored = std::min(found.candidates, capacity);
    EXPECT_EQ(found.contacts.x, (stored + 63) / 64);
    EXPECT_EQ(found.paired.x, (soup.predicted.size() + 63) / 64);
    EXPECT_EQ(found.alone.x, 1u);
    const gpu::Counters counted = detected.passes.counters();
    EXPECT_EQ(counted.contacts_most, found.candidates);
    EXPECT_GE(counted.contacts_room, found.candidates);
    std::uint32_t lost = found.candidates - stored;
    for (const std::uint32_t near : found.near) lost += near - std::min(near, WEFT_NEAR * capacity);
    EXPECT_EQ(counted.contacts_overflowed, lost);
    EXPECT_EQ(lost > 0, capacity == 300);
    std::set<std::uint32_t> paired;
    for (const gpu::Candidate& c : detected.candidates(stored)) paired.insert(std::begin(c.particle), std::end(c.particle));
    const auto bounds = detected.passes.get<std::uint32_t>(buffers::displacement_bounds, soup.predicted.size());
    for (std::uint32_t i = 0; i < bounds.size(); ++i) EXPECT_EQ((bounds[i] & WEFT_PAIRED) != 0, paired.contains(i)) << i;
  }
}

TEST_F(DetectArguments, lists_are_empty_when_a_substep_begins_and_candidates_last_until_the_next_detection) {
  Random random(12);
  const Soup soup = random_soup(random, 40);
  Detected detected(device(), soup, {}, "detect_arguments");
  gpu::Detection state = detected.detection();
  for (std::uint32_t& changed : state.changed) changed = 1;
  state.falls_back = state.touchings = state.touched.x = 1;
  for (const std::uint32_t kind : {WEFT_ACTIVE, WEFT_UNSAFE, WEFT_PENETRATING}) state.listings[kind] = state.listed[kind].x = 7;
  state.candidates = 300;
  state.contacts.x = state.paired.x = 5;
  for (const std::uint32_t needed : {0u, 1u}) {
    state.needs_detection = needed;
    detected.passes.put(buffers::detection, std::vector{state});
    detected.passes.run("detect_arguments");
    const gpu::Detection begun = detected.detection();
    for (const std::uint32_t changed : begun.changed) EXPECT_EQ(changed, 0u);
    EXPECT_EQ(begun.falls_back + begun.touchings + begun.touched.x, 0u);
    for (const std::uint32_t kind : {WEFT_ACTIVE, WEFT_UNSAFE, WEFT_PENETRATING})
      EXPECT_EQ(begun.listings[kind] + begun.listed[kind].x, 0u) << kind;
    EXPECT_EQ(std::pair(begun.contacts.x, begun.paired.x), needed ? std::pair(0u, 0u) : std::pair(5u, 5u));
    EXPECT_EQ(detected.passes.counters().contacts_load, 370u) << "of the substep before";
  }
}

}  // namespace
}  // namespace weft
