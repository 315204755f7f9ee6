// The counter of crossings against brute force in integers, against counts known by hand, and where doubles round wrongly.
#include "engine/reference/intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

using namespace weft;

namespace {

struct Soup {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

// __extension__: the standard has no such type, -Wpedantic knows.
__extension__ using Wide = __int128;
using Whole = std::array<Wide, 3>;

Whole whole(Vec3 v) { return {static_cast<Wide>(v.x), static_cast<Wide>(v.y), static_cast<Wide>(v.z)}; }
Whole minus(const Whole& a, const Whole& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide times(const Whole& a, const Whole& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Whole across(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Clips the segment a + s (b - a) to the triangle in rational numbers: by its plane to one s or all, then by each side, seen
// along the normal. Unlike the counter it works with one parameter along the edge, not with orientations.
bool clip_meets(const Whole& a, const Whole& b, const std::array<Whole, 3>& t) {
  const Whole normal = across(minus(t[1], t[0]), minus(t[2], t[0]));
  if (times(normal, normal) == 0) return false;
  // s in [low / low_under, high / high_under]
  Wide low = 0, low_under = 1, high = 1, high_under = 1;
  const auto keep = [&](Wide from, Wide slope) {   // from + s slope >= 0
    if (slope == 0) return from >= 0;
    if (slope > 0) {
      if (-from * low_under > low * slope) low = -from, low_under = slope;
    } else if (from * high_under < high * -slope) {
      high = from, high_under = -slope;
    }
    return low * high_under <= high * low_under;
  };
  const Whole along = minus(b, a);
  const Wide height = times(normal, minus(a, t[0])), rise = times(normal, along);
  bool inside = keep(height, rise) && keep(-height, -rise);
  for (int i = 0; i < 3 && inside; ++i) {
    const Whole inward = across(normal, minus(t[(i + 1) % 3], t[i]));
    inside = keep(times(inward, minus(a, t[i])), times(inward, along));
  }
  return inside;
}

// All pairs, for whole coordinates up to some thousands.
std::vector<Crossing> brute_force(const Soup& soup) {
  std::set<std::array<std::uint32_t, 2>> edges;
  for (const Triangle& t : soup.triangles)
    for (int i = 0; i < 3; ++i) edges.insert({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
  std::vector<Crossing> crossings;
  for (const auto& edge : edges)
    for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
      const Triangle& t = soup.triangles[i];
      if (std::count(t.begin(), t.end(), edge[0]) + std::count(t.begin(), t.end(), edge[1]) > 0) continue;
      if (clip_meets(whole(soup.positions[edge[0]]), whole(soup.positions[edge[1]]),
                     {whole(soup.positions[t[0]]), whole(soup.positions[t[1]]), whole(soup.positions[t[2]])}))
        crossings.push_back({edge, i});
    }
  return crossings;
}

std::vector<Crossing> all_of(const Soup& soup) { return find_crossings(soup.positions, soup.triangles, soup.triangles.size() * 1000); }

Soup random_soup(unsigned seed, int range_x, int range_y, int range_z, std::uint32_t vertices, int triangles) {
  std::mt19937 random(seed);
  const auto within = [&](int range) { return static_cast<float>(std::uniform_int_distribution<int>(-range, range)(random)); };
  Soup soup;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const float x = within(range_x), y = within(range_y), z = within(range_z);
    soup.positions.push_back({x, y, z});
  }
  std::uniform_int_distribution<std::uint32_t> vertex(0, vertices - 1);
  while (static_cast<int>(soup.triangles.size()) < triangles) {
    const Triangle t = {vertex(random), vertex(random), vertex(random)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) soup.triangles.push_back(t);
  }
  return soup;
}

template <class F>
Soup sheet(std::uint32_t cells, F&& place) {
  const Mesh grid = make_grid({.size = {1, 1}, .cells_x = cells, .cells_y = cells});
  Soup soup{{}, grid.triangles};
  for (const Vec3 v : grid.points) soup.positions.push_back(place(v));
  return soup;
}

void append(Soup& soup, const Soup& more) {
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  soup.positions.insert(soup.positions.end(), more.positions.begin(), more.positions.end());
  for (const Triangle& t : more.triangles) soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Soup face_and_edge(Vec3 from, Vec3 to) {
  // The edge's own triangle has no area: only the edge is tested.
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, from, to, to}, {{0, 1, 2}, {3, 4, 5}}};
}

bool meets_face(Vec3 from, Vec3 to) {
  for (const Crossing& crossing : all_of(face_and_edge(from, to)))
    if (crossing == Crossing{{3, 4}, 0}) return true;
  return false;
}

}  // namespace

TEST(Intersections, random_soups_have_the_crossings_that_integers_find) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 8; ++seed)
    for (const auto& [x, y, z] : {std::array{1000, 1000, 1000}, std::array{20, 20, 20}, std::array{3, 3, 3}}) {
      const Soup soup = random_soup(seed, x, y, z, 150, 150);
      const std::vector<Crossing> expected = brute_force(soup);
      EXPECT_EQ(all_of(soup), expected) << "seed " << seed << ", range " << x;
      EXPECT_EQ(count_crossings(soup.positions, soup.triangles), expected.size());
      found += expected.size();
    }
  EXPECT_GT(found, 1000u) << "soups that cross";
}

TEST(Intersections, coplanar_and_degenerate_triangles_are_as_integers_find) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const auto& [x, y, z] :
         {std::array{9, 9, 0}, std::array{0, 9, 9}, std::array{9, 0, 9}, std::array{1, 1, 1}, std::array{9, 0, 0}}) {
      const Soup soup = random_soup(seed, x, y, z, 60, 100);
      EXPECT_EQ(all_of(soup), brute_force(soup)) << "seed " << seed << ", ranges " << x << ' ' << y << ' ' << z;
    }
}

TEST(Intersections, an_oblique_plane_is_flat_however_doubles_round) {
  // Whole points of the plane 3x + 5y + 7z = 0, far from the origin, in units that are no power of two apart.
  for (unsigned seed = 0; seed < 6; ++seed) {
    Soup soup = random_soup(seed, 40, 40, 0, 60, 100);
    for (Vec3& v : soup.positions) v = {7 * v.x, 7 * v.y, -3 * v.x - 5 * v.y};
    const std::vector<Crossing> expected = brute_force(soup);
    EXPECT_EQ(all_of(soup), expected) << "seed " << seed;
    // The same far off: still whole numbers below 2^24.
    for (Vec3& v : soup.positions) v = {v.x + 9'999'991, v.y - 7'777'777, v.z + 5'555'555};
    EXPECT_EQ(all_of(soup), expected) << "seed " << seed;
  }
}

TEST(Intersections, a_side_is_told_apart_where_double_sees_a_plane) {
  // The edge's end stands 2^-80 above the side of the face; its distance is lost in the rounding of any difference.
  const float tiny = std::ldexp(1.0f, -80);
  const Vec3 p{0, 0, 1}, q{3, 0, 1}, r{0, 3, 1};
  // The face x + y + z = 1 lies oblique, so that the small part meets great ones.
  const auto crosses = [&](float offset) {
    const Soup soup{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, 0.5f, offset}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}, {3, 4, 5}}};
    return count_crossings(soup.positions, soup.triangles) > 0;
  };
  EXPECT_FALSE(crosses(tiny));
  EXPECT_TRUE(crosses(0)) << "it touches the side";
  // Two edges of a triangle without area stand on the face with one point; its own face is none.
  const Soup standing{{p, q, r, {1, 1, 1}, {1, 1, 2}, {1, 1, 2}}, {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(count_crossings(standing.positions, standing.triangles), 2u);
}

TEST(Intersections, touching_counts) {
  EXPECT_TRUE(meets_face({1, 1, -1}, {1, 1, 1})) << "through the face";
  EXPECT_TRUE(meets_face({1, 1, 0}, {1, 1, 5})) << "an end in the face";
  EXPECT_TRUE(meets_face({2, 2, -1}, {2, 2, 1})) << "through a side";
  EXPECT_TRUE(meets_face({4, 0, -1}, {4, 0, 1})) << "through a corner";
  EXPECT_TRUE(meets_face({1, 1, 0}, {2, 1, 0})) << "within the face";
  EXPECT_TRUE(meets_face({-1, 5, 0}, {5, -1, 0})) << "along a side";
  EXPECT_TRUE(meets_face({-9, 1, 0}, {9, 1, 0})) << "across the face in its plane";
  EXPECT_TRUE(meets_face({4, -1, 0}, {4, 1, 0})) << "by a corner in its plane";
  EXPECT_TRUE(meets_face({1, 1, 0}, {1, 1, 0})) << "a point";
}

TEST(Intersections, near_is_not_touching) {
  const float tiny = std::ldexp(1.0f, -140);
  EXPECT_FALSE(meets_face({1, 1, tiny}, {1, 1, 5}));
  EXPECT_FALSE(meets_face({1, -tiny, -1}, {1, -tiny, 1}));
  EXPECT_FALSE(meets_face({1, -tiny, 0}, {2, -tiny, 0}));
  EXPECT_FALSE(meets_face({5, 0, 0}, {9, 0, 0})) << "on the line of a side, beyond it";
  EXPECT_FALSE(meets_face({2, std::nextafter(2.0f, 3.0f), -1}, {2, std::nextafter(2.0f, 3.0f), 1}));
}

TEST(Intersections, edges_that_share_a_vertex_are_skipped) {
  const Soup folded{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(count_crossings(folded.positions, folded.triangles), 0u);
}

TEST(Intersections, two_sheets_that_cross_have_a_known_number) {
  // A flat sheet of n x n cells at y = 0, and an upright one whose two rows of vertices stand above and below it, turned
  // so that only its 2 n + 1 steep edges (n + 1 upright, n diagonal) pass through faces, and none through a side.
  //
  //    seen from the side        +---+---+   0.5       the flat sheet's edges cross the upright one's faces too:
  //                           ===|===|===|=== 0         those of the row of cells it stands in
  //                              +---+---+  -0.5
  Soup soup;
  soup.positions = {{-8, 0, -8}, {8, 0, -8}, {0, 0, 8}};
  soup.triangles = {{0, 1, 2}};
  constexpr std::uint32_t n = 5;
  Soup upright;
  for (std::uint32_t row = 0; row < 2; ++row)
    for (std::uint32_t i = 0; i <= n; ++i) upright.positions.push_back({0.5f * i - 1.25f, row == 0 ? -0.5f : 0.5f, 0.25f});
  for (std::uint32_t i = 0; i < n; ++i) {
    upright.triangles.push_back({i, i + 1, i + n + 2});
    upright.triangles.push_back({i, i + n + 2, i + n + 1});
  }
  append(soup, upright);
  const std::vector<Crossing> crossings = all_of(soup);
  EXPECT_EQ(crossings.size(), 2 * n + 1);
  for (const Crossing& crossing : crossings) EXPECT_EQ(crossing.triangle, 0u);
  EXPECT_EQ(find_crossings(soup.positions, soup.triangles, 4), std::vector(crossings.begin(), crossings.begin() + 4));
  EXPECT_TRUE(find_crossings(soup.positions, soup.triangles, 0).empty());
}

TEST(Intersections, a_rolled_sheet_has_none) {
  // An Archimedean spiral of three turns, 1 cm of air between them; at 64 cells a side chords sag 0.5 mm.
  const Soup rolled = sheet(64, [](Vec3 v) {
    const double angle = 6 * std::numbers::pi * (v.x + 0.5), radius = 0.02 + 0.01 * angle / (2 * std::numbers::pi);
    return Vec3{static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), v.z};
  });
  EXPECT_EQ(count_crossings(rolled.positions, rolled.triangles), 0u);
}

TEST(Intersections, a_sheet_at_rest_has_none_in_any_pose) {
  for (const double angle : {0.0, 0.3, 1.0, 2.2}) {
    const Soup turned = sheet(40, [&](Vec3 v) {
      const double x = v.x * std::cos(angle) - v.z * std::sin(angle), z = v.x * std::sin(angle) + v.z * std::cos(angle);
      return Vec3{static_cast<float>(x), static_cast<float>(0.7 * z + 0.1), static_cast<float>(0.6 * z)};
    });
    EXPECT_EQ(count_crossings(turned.positions, turned.triangles), 0u) << angle;
  }
}

TEST(Intersections, order_of_vertices_and_triangles_does_not_matter) {
  const Soup soup = random_soup(42, 30, 30, 30, 300, 400);
  std::mt19937 random(7);
  std::vector<std::uint32_t> place(soup.positions.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[i] = i;
  std::shuffle(place.begin(), place.end(), random);
  Soup mixed{std::vector<Vec3>(soup.positions.size()), soup.triangles};
  for (std::size_t i = 0; i < place.size(); ++i) mixed.positions[place[i]] = soup.positions[i];
  for (Triangle& t : mixed.triangles) {
    for (std::uint32_t& corner : t) corner = place[corner];
    std::shuffle(t.begin(), t.end(), random);
  }
  std::shuffle(mixed.triangles.begin(), mixed.triangles.end(), random);
  EXPECT_EQ(count_crossings(mixed.positions, mixed.triangles), count_crossings(soup.positions, soup.triangles));
}

TEST(Intersections, moving_and_scaling_exactly_changes_nothing) {
  const Soup soup = random_soup(11, 100, 100, 100, 200, 300);
  const std::vector<Crossing> expected = all_of(soup);
  for (const float scale : {1.0f, std::ldexp(1.0f, -20), std::ldexp(1.0f, 30)}) {
    Soup moved = soup;   // whole numbers below 2^24 before they are scaled by a power of two
    for (Vec3& v : moved.positions) v = {scale * (v.x + 1'048'576), scale * (v.y - 524'289), scale * (v.z + 8'000'001)};
    EXPECT_EQ(all_of(moved), expected) << scale;
  }
}

TEST(Intersections, triangles_that_are_not_finite_are_left_out) {
  Soup soup = face_and_edge({1, 1, -1}, {1, 1, 1});
  ASSERT_GT(count_crossings(soup.positions, soup.triangles), 0u);
  soup.positions[2].y = std::nanf("");
  EXPECT_EQ(count_crossings(soup.positions, soup.triangles), 0u);
  EXPECT_EQ(count_crossings({}, {}), 0u);
}

// Slivers along the diagonal of space: every box meets every other, and nothing crosses.
TEST(Intersections, a_count_gives_up_where_there_are_too_many_candidates_and_says_so) {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const float x = static_cast<float>(i) * 0.01f;
    for (const Vec3 p : {Vec3{x, 0, 0}, Vec3{x + 100, 100, 100}, Vec3{x + 100, 100, 100.005f}}) positions.push_back(p);
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  // Two more that cross come last.
  for (const Vec3 p : {Vec3{500, 0, 0}, Vec3{502, 0, 0}, Vec3{500, 2, 0}, Vec3{500.5f, 0.5f, -1}, Vec3{500.5f, 0.5f, 1}, Vec3{503, 3, 1}})
    positions.push_back(p);
  triangles.push_back({600, 601, 602});
  triangles.push_back({603, 604, 605});
  const CrossingCount whole = count_crossings_among(positions, triangles, 1'000'000);
  EXPECT_TRUE(whole.all);
  EXPECT_EQ(whole.pairs, count_crossings(positions, triangles));
  EXPECT_GT(whole.pairs, 0u);
  const CrossingCount part = count_crossings_among(positions, triangles, 10'000);
  EXPECT_FALSE(part.all);
  EXPECT_EQ(part.pairs, 0u);
}

TEST(Intersections, passive_triangles_are_crossed_by_cloth_but_not_by_one_another) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Soup soup = random_soup(seed, 20, 20, 20, 150, 150);
    const std::size_t first_passive = 60;
    std::set<std::array<std::uint32_t, 2>> cloth_edges;
    for (std::size_t t = 0; t < first_passive; ++t)
      for (int i = 0; i < 3; ++i) {
        const auto [a, b] = std::minmax(soup.triangles[t][i], soup.triangles[t][(i + 1) % 3]);
        cloth_edges.insert({a, b});
      }
    std::vector<Crossing> expected = brute_force(soup);
    const std::size_t all = expected.size();
    std::erase_if(expected, [&](const Crossing& c) { return c.triangle >= first_passive && !cloth_edges.contains(c.edge); });
    EXPECT_LT(expected.size(), all);
    EXPECT_EQ(find_crossings(soup.positions, soup.triangles, all, first_passive), expected) << "seed " << seed;
    EXPECT_EQ(count_crossings(soup.positions, soup.triangles, first_passive), expected.size());
    EXPECT_EQ(count_crossings(soup.positions, soup.triangles, 0), 0u);
  }
}
