// The search for crossings and the pass untangle against their twin.
#include <gtest/gtest.h>

#include <set>

#include "engine/effects/untangle/untangle.h"
#include "shaders/untangle/untangle.ref.h"
#include "tests/support/detected.h"

namespace weft {
namespace {

using KernelUntangle = GpuTest;

// Strips of `cells` by two squares, each its own way through the others: some are cut in two, some only slit.
Soup strips(Random& random, std::uint32_t count, std::uint32_t cells) {
  Soup soup = soup_of(random, count * 3 * (cells + 1));
  for (std::uint32_t strip = 0; strip < count; ++strip) {
    const gpu::vec4 middle = anywhere(random, 0.15, 0), along = anywhere(random, 0.06, 0), across = anywhere(random, 0.04, 0);
    for (std::uint32_t k = 0; k < 3 * (cells + 1); ++k) {
      const std::uint32_t i = strip * 3 * (cells + 1) + k;
      const float s = static_cast<float>(k / 3) - 0.5f * static_cast<float>(cells), t = static_cast<float>(k % 3) - 1;
      const gpu::vec4 x = sum(sum(middle, times(s, along)), sum(times(t, across), anywhere(random, 0.01, 0)));
      soup.fabric.positions[i] = {x.x, x.y, x.z, strip == 0 ? 0 : soup.fabric.positions[i].w};
      soup.fabric.velocities[i].w = std::bit_cast<float>(strip % 3);
      soup.fabric.rest[i] = {x.x, x.y, x.z, 0.002f};
      if (k < 3 || k % 3 == 0) continue;
      add_triangle(soup, i - 4, i - 3, i);
      add_triangle(soup, i - 4, i, i - 1);
    }
  }
  soup.predicted = soup.fabric.positions;
  return soup;
}

reference::Tangle tangle_of(const Detected& detected) {
  reference::Tangle t;
  t.at = points(detected.soup.fabric.positions);
  t.inverse_masses = inverse_masses(detected.soup.fabric);
  for (const gpu::uvec4& e : detected.fabric.own.of<ClusterLists>().edges) t.edges.push_back({e.x, e.y});
  for (const gpu::uvec4& f : detected.fabric.own.of<ClusterLists>().faces) t.triangles.push_back({f.x, f.y, f.z});
  return t;
}

TEST_F(KernelUntangle, finds_what_goes_through_what_the_regions_and_what_is_to_be_taken_back) {
  Random random(31);
  std::size_t cut = 0, slit = 0;
  for (const std::uint32_t count : {2u, 3u, 12u, 40u})
    for (const bool storage : {false, true}) {
      SCOPED_TRACE(std::to_string(count) + " strips");
      const Soup soup = strips(random, count, 9);
      Detected detected(device(), soup, {.gather_storage = storage, .untangle = true});
      for (const char* pass : {"contact_prepare", "untangle"}) detected.passes.run(pass);
      const reference::Tangle tangle = tangle_of(detected);
      const auto crossed = reference::crossings(tangle);
      std::size_t crossings = 0;
      for (const auto& of_edge : crossed) crossings += of_edge.size();
      const gpu::Detection found = detected.detection();
      ASSERT_EQ(found.crossings, crossings);
      EXPECT_EQ(detected.passes.counters().crossings_most, crossings);
      const auto triangles = detected.passes.get<gpu::uvec2>(buffers::crossed_triangles, tangle.edges.size());
      std::set<std::pair<std::uint32_t, std::uint32_t>> tangled;
      for (std::size_t e = 0; e < crossed.size(); ++e) {
        EXPECT_EQ(triangles[e].y >> 31, crossed[e].size() % 2);
        EXPECT_EQ(triangles[e].x, crossed[e].empty() ? WEFT_NONE : crossed[e].begin()->second);
        if (!crossed[e].empty()) { EXPECT_EQ(triangles[e].y & 0x7fffffff, crossed[e].rbegin()->second); }
        for (const auto& [where, t] : crossed[e]) {
          for (const std::uint32_t i : tangle.edges[e])
            for (const std::uint32_t j : tangle.triangles[t]) tangled.insert(std::minmax(i, j));
        }
      }
      const std::uint32_t places = contact_settings(Detected::scene({}), detected.fabric).tangled_room;
      const auto room = detected.passes.get<std::uint32_t>(buffers::tangled_pairs, places);
      if (crossings > 0) { EXPECT_EQ(std::ranges::count_if(room, [](std::uint32_t key) { return key != 0; }), tangled.size()); }
      if (crossings == 0) continue;
      const auto regions = reference::regions(tangle, crossed);
      EXPECT_EQ(detected.passes.get<std::uint32_t>(buffers::regions, regions.size()), regions);

      std::vector<reference::Back> wanted = reference::taken_back(tangle, crossed, regions), got;
      std::erase_if(wanted, [&](const reference::Back& back) {   // nobody there can move
        return soup.fabric.positions[back.first].w == 0 && soup.fabric.positions[back.second[0]].w == 0;
      });
      std::size_t drawn_in = 0;
      const auto candidates = detected.candidates(found.candidates);
      const auto normals = detected.passes.get<gpu::vec4>(buffers::contact_normals, found.candidates);
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        const auto& p = candidates[k].particle;
        if (candidates[k].separation != WEFT_UNTANGLED) {
          for (std::size_t i = 0; i < (candidates[k].edges ? 2u : 1u); ++i)
            for (std::size_t j = candidates[k].edges ? 2 : 1; j < 4; ++j)
              EXPECT_FALSE(tangled.contains(std::minmax(p[i], p[j]))) << "no contact holds what is to come apart";
          continue;
        }
        reference::Corners corners{p[1], p[2], p[3]};
        std::ranges::sort(corners);
        const reference::Back back{p[0], corners};
        if (const auto at = std::ranges::find(wanted, back); at != wanted.end()) {
          wanted.erase(at);
          const reference::Vector n = vector(normals[k]), from = tangle.at[p[1]];
          EXPECT_NEAR(n.norm(), 1, 1e-5);
          EXPECT_LT(n.dot(tangle.at[p[0]] - from), 0) << "it is behind the triangle";
          ++cut;
        } else {
          ++drawn_in;
        }
      }
      EXPECT_TRUE(wanted.empty()) << wanted.size() << " of them are not taken back";
      slit += drawn_in;
      EXPECT_EQ(found.needs_detection != 0, cut + slit > 0);
    }
  EXPECT_GT(cut, 100u) << "too few to tell anything";
  EXPECT_GT(slit, 20u);
}

TEST_F(KernelUntangle, has_nothing_to_do_where_nothing_crosses_and_does_not_look_again) {
  Random random(32);
  const Soup soup = strips(random, 1, 9);
  Detected detected(device(), soup, {.untangle = true});
  const gpu::Detection found = detected.detection();
  EXPECT_EQ(found.looks, 1u) << "the first detection";
  EXPECT_EQ(found.crossings, 0u);
  EXPECT_EQ(found.tangles.x, 0u);
  for (const std::uint32_t may_cross : {0u, 1u}) {
    gpu::Detection next = found;
    next.needs_detection = 1;
    next.may_cross = may_cross;
    detected.passes.put(buffers::detection, std::vector{next});
    detected.passes.run("detect_arguments");
    EXPECT_EQ(detected.detection().looks, may_cross);
    EXPECT_EQ(detected.detection().may_cross, 0u);
  }
}

}  // namespace
}  // namespace weft
