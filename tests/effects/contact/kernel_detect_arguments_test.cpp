// What the detection's passes prepare and decide: when a detection is needed, displacement bounds, predicted trajectories, the grid's
// offsets, and the dispatch arguments of the passes after them.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "tests/support/detected.h"

namespace weft {
namespace {

using DetectArguments = GpuTest;

TEST_F(DetectArguments, grid_lists_every_cluster_in_its_bucket_and_leaves_the_counts_at_zero) {
  Random random(8);
  const Soup soup = random_soup(random, 200);
  const gpu::ContactSettings settings = contact_settings(Detected::scene({}), with_clusters(soup.fabric));
  const std::size_t clusters = settings.clusters, buckets = settings.buckets;
  ASSERT_GT(clusters, 30u);
  const Detected counted(device(), soup, {}, "grid_scan");
  const auto counts = counted.passes.get<std::uint32_t>(buffers::grid_counts, buckets);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), clusters);
  const Detected filled(device(), soup, {}, "grid_fill");
  EXPECT_EQ(filled.passes.get<std::uint32_t>(buffers::grid_counts, buckets), std::vector<std::uint32_t>(buckets, 0));
  std::set<std::uint32_t> listed;
  const auto entries = filled.passes.get<gpu::vec4>(buffers::grid_entries, clusters);
  for (const gpu::vec4& entry : entries) listed.insert(std::bit_cast<std::uint32_t>(entry.w) & 0x0fffffffu);
  EXPECT_EQ(listed.size(), clusters);
  EXPECT_EQ(*listed.rbegin(), clusters - 1);
}

TEST_F(DetectArguments, starts_are_the_sums_of_the_counts_before_them) {
  // Buckets: the least, a block or less than one, and several blocks.
  for (const std::uint32_t workgroup : {64u, 512u})
    for (const std::size_t buckets : {64u, 512u, 4096u, 32768u}) {
      Random random(9);
      // Particles without triangles, sixteen a cluster; two buckets a cluster.
      const Soup soup = soup_of(random, static_cast<std::uint32_t>(8 * buckets - 40));
      Detected detected(device(), soup, {false, workgroup}, "detect_arguments");
      ASSERT_EQ(contact_settings(Detected::scene({}), with_clusters(soup.fabric)).buckets, buckets);
      std::vector<std::uint32_t> counts(buckets), wanted(buckets + 1);
      for (std::uint32_t& count : counts) count = static_cast<std::uint32_t>(random() % 5 == 0 ? random() % 1000 : 0);
      std::partial_sum(counts.begin(), counts.end(), wanted.begin() + 1);
      detected.passes.put(buffers::grid_counts, counts);
      detected.passes.run("grid_total");
      detected.passes.run("grid_scan");
      EXPECT_EQ(detected.passes.get<std::uint32_t>(buffers::grid_starts, buckets + 1), wanted)
          << buckets << " buckets, " << workgroup << " threads";
    }
}

TEST_F(DetectArguments, trajectories_are_the_substep_ahead_ten_times_but_no_longer_than_32_cells_a_substep) {
  Random random(10);
  Soup soup = random_soup(random, 40);
  for (std::size_t i = 0; i < soup.predicted.size(); i += 4) soup.predicted[i].y += 0.5f;
  const double cell = 0.01;
  const Detected detected(device(), soup, {false, 64, cell}, "detect_trajectory");
  const auto x = points(soup.fabric.positions), p = points(soup.predicted);
  const auto trajectories = points(detected.passes.particles(buffers::trajectories));
  EXPECT_EQ(largest_gap(detected.passes.particles(buffers::detected_positions), x), 0);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT((trajectories[i] - reference::path_along(p[i] - x[i], cell)).norm(), 20 * kRounding * 4);
  for (const std::uint32_t bound : detected.passes.get<std::uint32_t>(buffers::displacement_bounds, x.size()))
    EXPECT_EQ(std::bit_cast<float>(bound), static_cast<float>(kMargin));
}

TEST_F(DetectArguments, detect_arguments_detects_when_needed_and_adapts_the_margin_to_how_often_that_is) {
  Random random(11);
  Soup soup = random_soup(random, 20);
  Detected detected(device(), soup, {}, "detect_arguments");
  SinglePass& passes = detected.passes;
  const auto low = static_cast<float>(kMargin), high = contact_settings(Detected::scene({}), soup.fabric).margin_high;
  gpu::Detection d = detected.detection();
  EXPECT_EQ(d.margin, low);
  EXPECT_EQ(d.needs_detection, 0u);
  EXPECT_EQ(d.steps, 0u);
  EXPECT_EQ(d.particles.x, 1u);
  const auto primitives = static_cast<std::uint32_t>(soup.fabric.triangles.size() + soup.fabric.edges.size());
  EXPECT_EQ(d.primitives.x, (primitives + 63) / 64);
  EXPECT_EQ(d.blocks.x, 1u);
  for (const gpu::Groups& groups : {d.particles, d.primitives, d.blocks}) EXPECT_EQ(std::pair(groups.y, groups.z), std::pair(1u, 1u));
  EXPECT_EQ(passes.counters().detections, 1u);
  // None is needed: nothing to dispatch, and the steps since the last are counted.
  for (std::uint32_t steps = 1; steps < WEFT_LONGEST_LIFETIME + 3; ++steps) {
    passes.run("detect_arguments");
    d = detected.detection();
    EXPECT_EQ(d.steps, std::min(steps, WEFT_LONGEST_LIFETIME));
    for (const gpu::Groups& groups : {d.particles, d.primitives, d.blocks}) EXPECT_EQ(groups.x, 0u);
  }
  const auto margin_after = [&](float margin, std::uint32_t steps, std::uint32_t candidates = 100'000) {
    gpu::Detection state = detected.detection();
    state.margin = margin;
    state.steps = steps;
    state.needs_detection = 1;
    state.candidates = candidates;
    state.extents[5] = state.near[1] = state.levels = 9;
    passes.put(buffers::detection, std::vector{state});
    passes.run("detect_arguments");
    state = detected.detection();
    EXPECT_EQ(state.needs_detection + state.steps + state.candidates + state.extents[5] + state.near[1] + state.levels, 0u);
    return state.margin;
  };
  EXPECT_EQ(d.lifetime, WEFT_LONGEST_LIFETIME) << "nothing is known yet";
  EXPECT_FLOAT_EQ(margin_after(2 * low, 0), 3 * low) << "one substep old";
  EXPECT_EQ(detected.detection().lifetime, 2u);
  EXPECT_FLOAT_EQ(margin_after(2 * low, 1), 3 * low);
  EXPECT_FLOAT_EQ(margin_after(2 * low, 2), 2 * low);
  EXPECT_EQ(detected.detection().lifetime, 6u);
  EXPECT_FLOAT_EQ(margin_after(2 * low, 8), 2 * low);
  EXPECT_EQ(detected.detection().lifetime, WEFT_LONGEST_LIFETIME);
  EXPECT_FLOAT_EQ(margin_after(2 * low, 9), 1.8f * low) << "its trajectories held to the end";
  EXPECT_FLOAT_EQ(margin_after(0.9f * high, 0), high);
  EXPECT_FLOAT_EQ(margin_after(1.05f * low, 10), low);
  EXPECT_FLOAT_EQ(margin_after(2 * low, 8, 1), 3 * low) << "so few pairs cost nothing";
  EXPECT_FLOAT_EQ(margin_after(1.9f * high, 8, 1), 2 * high);
  EXPECT_FLOAT_EQ(margin_after(1.9f * high, 8), high) << "but now they do";
  EXPECT_EQ(passes.counters().detections, 11u);
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
  EXPECT_EQ(passes.counters().detections, 12u);
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
    detected.passes.run("contact_arguments");
    const gpu::Counters counted = detected.passes.counters();
    EXPECT_EQ(counted.contacts_overflowed, capacity > 100 ? 0u : found.near[0] + found.near[1] - 400);
    EXPECT_EQ(counted.contacts_room, (std::max(found.near[0], found.near[1]) + 1) / 2);
    detected.passes.run("detect_arguments");   // none is needed
    EXPECT_EQ(detected.detection().near_faces.x + detected.detection().near_edges.x, 0u);
    detected.passes.run("contact_arguments");
    EXPECT_EQ(detected.passes.counters().contacts_overflowed, counted.contacts_overflowed) << "an old search is not counted again";
  }
}

TEST_F(DetectArguments, contact_arguments_dispatches_what_there_is_capacity_for_and_counts_the_rest) {
  Random random(12);
  Soup soup = random_soup(random, 40);
  Detected detected(device(), soup, {false, 64, 0.05, kMargin, 100}, "detect_arguments");
  const auto dispatched = [&](std::uint32_t candidates, std::uint32_t steps) {
    gpu::Detection state = detected.detection();
    state.candidates = candidates;
    state.steps = steps;
    for (std::uint32_t& changed : state.changed) changed = 1;
    state.falls_back = 1;
    detected.passes.put(buffers::detection, std::vector{state});
    detected.passes.run("contact_arguments");
    state = detected.detection();
    for (const std::uint32_t changed : state.changed) EXPECT_EQ(changed, 0u);
    EXPECT_EQ(state.falls_back, 0u);
    return std::pair(state.contacts.x, state.touched.x);
  };
  using Groups = std::pair<std::uint32_t, std::uint32_t>;
  EXPECT_EQ(dispatched(0, 0), Groups(0, 0));
  EXPECT_EQ(dispatched(65, 0), Groups(2, 2));
  EXPECT_EQ(dispatched(130, 0), Groups(2, 2));
  EXPECT_EQ(dispatched(140, 1), Groups(2, 2)) << "an old detection is not counted again";
  EXPECT_EQ(dispatched(3, 0), Groups(1, 2));
  EXPECT_EQ(detected.passes.counters().contacts_most, 130u);
  EXPECT_EQ(detected.passes.counters().contacts_overflowed, 30u);
}

}  // namespace
}  // namespace weft
