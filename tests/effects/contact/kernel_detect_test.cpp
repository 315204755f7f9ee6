// The detection's passes against their twin: on random soups every pair that may meet is found once and no other, whatever the
// cell, the workgroup and the way of gathering; nothing overflows silently; and what is degenerate loses no pair either.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <cstring>
#include <map>
#include <set>

#include "tests/support/detected.h"

namespace weft {
namespace {

using Detect = GpuTest;
using reference::Particles;

// A pair's name: which kind, and its particles in the order in which the buffers list them.
using Name = std::pair<bool, Particles>;

// Edges find each other from either side.
Name name_of(bool edges, Particles p) {
  if (edges && std::pair(p[2], p[3]) < std::pair(p[0], p[1])) p = {p[2], p[3], p[0], p[1]};
  return {edges, p};
}

struct Oracle {
  std::map<Name, double> certain;   // pairs that are candidates beyond doubt, and their separation
  std::set<Name> doubtful;          // within the error of single precision
};

Oracle all_pairs(const Soup& soup, const reference::Tracks& t, double doubt) {
  Oracle oracle;
  const auto judge = [&](const Particles& p, int a) {
    if (!reference::can_be_pair(t, p, a)) return;
    const double spare = reference::spare_distance(t, p, a);
    if (spare < -doubt) oracle.certain[name_of(a == 2, p)] = reference::keep_of(t, p, a);
    else if (spare <= doubt) oracle.doubtful.insert(name_of(a == 2, p));
  };
  for (std::uint32_t i = 0; i < soup.fabric.positions.size(); ++i)
    for (const auto& [a, b, c] : soup.fabric.triangles) judge({i, a, b, c}, 1);
  for (std::size_t i = 0; i < soup.fabric.edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      judge({soup.fabric.edges[j].x, soup.fabric.edges[j].y, soup.fabric.edges[i].x, soup.fabric.edges[i].y}, 2);
  return oracle;
}

// Each box may be larger by four units in the last place of the largest coordinate, on purpose (grid.glsl), and the chain of
// some twenty operations rounds as often; coordinates, trajectories included, are below `size`.
double doubt_of(double size) { return (2 * 8 + 40) * kRounding * size; }

void expect_agreement(const Detected& detected, const Oracle& oracle, double doubt) {
  const std::uint32_t count = detected.detection().candidates;
  std::map<Name, int> found;
  for (const gpu::Candidate& c : detected.candidates(count)) {
    const Name name = name_of(c.edges, {c.particle[0], c.particle[1], c.particle[2], c.particle[3]});
    ++found[name];
    const auto wanted = oracle.certain.find(name);
    if (wanted == oracle.certain.end()) EXPECT_TRUE(oracle.doubtful.contains(name)) << "not a pair that may meet";
    else EXPECT_NEAR(c.separation, wanted->second, doubt);
  }
  for (const auto& [name, times] : found) EXPECT_EQ(times, 1);
  std::size_t missed = 0;
  for (const auto& [name, separation] : oracle.certain) missed += !found.contains(name);
  EXPECT_EQ(missed, 0u) << "of " << oracle.certain.size();
}

// Of a cluster's neighbours, at most.
std::uint32_t longest_list(const Detected& detected) {
  const std::size_t clusters = detected.fabric.own.of<ClusterLists>().clusters.size() - 1;
  const auto lists = detected.passes.get<std::uint32_t>(buffers::near_clusters, (WEFT_NEAR_CLUSTERS + 1) * clusters);
  std::uint32_t most = 0;
  for (std::size_t k = 0; k < clusters; ++k) most = std::max(most, lists[(WEFT_NEAR_CLUSTERS + 1) * k] & 0xff);
  return most;
}

TEST_F(Detect, finds_every_pair_that_may_meet_once_and_no_other) {
  std::uint32_t longest = 0;
  for (const bool gather_storage : {false, true})
    for (const std::uint32_t workgroup : {64u, 512u})
      for (const std::uint64_t seed : {1u, 2u}) {
        Random random(10 * seed + 2 * gather_storage + (workgroup > 64));
        const Soup soup = random_soup(random, 100);
        const Setting setting{gather_storage, workgroup, std::pow(10, between(random, -3, 0.5))};
        const Detected detected(device(), soup, setting);
        const double doubt = doubt_of(2);
        const Oracle oracle = all_pairs(soup, detected.tracks(), doubt);
        SCOPED_TRACE(testing::Message() << "cell " << setting.cell << ", " << oracle.certain.size() << " pairs, " << oracle.doubtful.size()
                                        << " in doubt");
        ASSERT_GT(oracle.certain.size(), 500u);
        ASSERT_LT(oracle.doubtful.size(), 50u);
        expect_agreement(detected, oracle, doubt);
        longest = std::max(longest, longest_list(detected));
      }
  EXPECT_GT(longest, WEFT_NEAR_CLUSTERS) << "no list was too long";
}

// Kinematic particles are a third of the soup. What they come at has a displacement bound by which it can be out of their way.
TEST_F(Detect, finds_every_pair_where_kinematic_particles_push) {
  int pushed = 0, left = 0;
  for (const double fastest : {0.5 * kMargin, 1.5 * kMargin, 5 * kMargin, 1.0}) {
    Random random(60 + static_cast<std::uint64_t>(1000 * fastest));
    const Soup soup = random_soup(random, 60);
    const Setting setting{.cell = 0.05, .fastest = fastest};
    const Detected detected(device(), soup, setting);
    const auto tracks = detected.tracks();
    const double most = fastest > kMargin ? std::min(fastest, WEFT_MOST_PUSHED * setting.cell) : 0;
    EXPECT_NEAR(detected.detection().most_pushed, most, 1e-7);
    EXPECT_EQ(detected.detection().fastest, 0u) << "the next substep's is found anew";
    for (const double bound : tracks.bounds) {
      EXPECT_GE(bound, kMargin * (1 - 1e-6));
      EXPECT_LE(bound, (kMargin + most) * (1 + 1e-6));
      ++(bound > 2 * kMargin ? pushed : left);
    }
    expect_agreement(detected, all_pairs(soup, tracks, doubt_of(2)), doubt_of(2));
  }
  EXPECT_GT(pushed, 50);
  EXPECT_GT(left, 50);
}

// Where a level has no more primitives than a search has cells, the grid is not asked.
TEST_F(Detect, finds_every_pair_among_a_handful_of_primitives) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(100 + seed);
    const Soup soup = random_soup(random, static_cast<std::uint32_t>(2 + seed % 8));
    const Detected detected(device(), soup, {false, 64, std::pow(10, between(random, -2, 0))});
    expect_agreement(detected, all_pairs(soup, detected.tracks(), doubt_of(2)), doubt_of(2));
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

TEST_F(Detect, holds_all_particles_of_pairs_that_find_no_place_and_counts_them) {
  Random random(6);
  const Soup soup = random_soup(random, 60);
  const gpu::Detection all = Detected(device(), soup, {}).detection();
  const std::uint32_t capacity = 16, near_capacity = WEFT_NEAR * capacity;
  const Detected detected(device(), soup, {false, 64, 0.05, kMargin, capacity});
  EXPECT_EQ(detected.detection().near[0], all.near[0]);
  EXPECT_EQ(detected.detection().near[1], all.near[1]);
  const std::uint32_t stored = std::min(capacity, detected.detection().candidates);
  EXPECT_EQ(detected.passes.counters().contacts_overflowed,
            all.near[0] + all.near[1] - 2 * near_capacity + detected.detection().candidates - stored);
  std::set<Name> placed;
  for (const gpu::Candidate& c : detected.candidates(stored))
    placed.insert(name_of(c.edges, {c.particle[0], c.particle[1], c.particle[2], c.particle[3]}));
  EXPECT_EQ(placed.size(), stored);
  const auto displacement_bounds = detected.passes.get<std::uint32_t>(buffers::displacement_bounds, soup.predicted.size());
  for (const auto& [name, separation] : all_pairs(soup, detected.tracks(), doubt_of(2)).certain)
    if (!placed.contains(name)) { for (const std::uint32_t i : name.second) EXPECT_EQ(displacement_bounds[i] & ~WEFT_PAIRED, 0u); }
}

TEST_F(Detect, holds_the_four_particles_of_an_overflowed_pair_and_no_other) {
  Random random(13);
  Soup soup = soup_of(random, 8);   // twice a vertex above a triangle
  for (std::uint32_t i = 0; i < 8; ++i) {
    const gpu::vec4 corners[] = {{0, 0.001f, 0, 1}, {-0.1f, 0, -0.1f, 1}, {0.1f, 0, -0.1f, 1}, {0, 0, 0.1f, 1}};
    soup.fabric.positions[i] = soup.fabric.rest[i] = sum(corners[i % 4], {i < 4 ? 0.f : 1, 0, 0, 0});
    soup.fabric.rest[i].w = 0.001f;
    if (i % 4 == 3) add_triangle(soup, i - 2, i - 1, i);
  }
  soup.predicted = soup.fabric.positions;
  const Detected detected(device(), soup, {false, 64, 0.05, kMargin, 1});
  EXPECT_EQ(detected.detection().candidates, 2u);
  const std::uint32_t stored = detected.candidates(1)[0].particle[0];
  const auto displacement_bounds = detected.passes.get<std::uint32_t>(buffers::displacement_bounds, 8);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(displacement_bounds[i], i / 4 == stored / 4 ? WEFT_PAIRED | std::bit_cast<std::uint32_t>(float(kMargin)) : 0) << i;
}

TEST_F(Detect, a_flat_sheet_at_rest_has_no_candidates_when_the_margin_is_small_against_its_edges) {
  constexpr std::uint32_t kFew = 17;
  Random random(7);
  Soup soup = soup_of(random, kFew * kFew);
  for (std::uint32_t i = 0; i < kFew * kFew; ++i) {
    const gpu::vec4 x{0.05f * static_cast<float>(i % kFew), 0, 0.05f * static_cast<float>(i / kFew), 10};
    soup.fabric.positions[i] = x;
    soup.fabric.velocities[i].w = 0;
    soup.fabric.rest[i] = {x.x, x.y, x.z, 0.5f};   // far thicker than an edge
    soup.predicted[i] = x;
    if (i % kFew == kFew - 1 || i / kFew == kFew - 1) continue;
    add_triangle(soup, i, i + 1, i + kFew);
    add_triangle(soup, i + 1, i + kFew + 1, i + kFew);
  }
  for (const double speed : {0.0, 0.002}) {
    for (gpu::vec4& p : soup.predicted) p.y = static_cast<float>(speed);
    EXPECT_EQ(Detected(device(), soup, {false, 64, 0.08, 5e-4}).detection().candidates, 0u) << "falling " << speed << " m a substep";
  }
}

// ---- smooth cloth

constexpr double kCell = 0.05, kThickness = 0.01;   // m

// A flat sheet that is now `bent`, with its particles off by up to `noise`, and on its way by `way` in a substep.
Soup sheet_of(Random& random, reference::Vector (*bent)(double, double), double noise, const reference::Vector& way,
              std::uint32_t side = 25) {
  Soup soup = soup_of(random, side * side);
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double u = kCell * (i % side), v = kCell * (i / side);
    const reference::Vector at = bent(u, v);
    const gpu::vec4 x = sum({static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()), 10}, anywhere(random, noise, 0));
    soup.fabric.positions[i] = {x.x, x.y, x.z, 10};
    soup.fabric.velocities[i].w = 0;
    soup.fabric.rest[i] = {static_cast<float>(u), 0, static_cast<float>(v), static_cast<float>(kThickness)};
    const reference::Vector step = between(random, 0.95, 1) * way;
    soup.predicted[i] = sum(x, {static_cast<float>(step.x()), static_cast<float>(step.y()), static_cast<float>(step.z()), 0});
  }
  for (std::uint32_t i = 0; i < side * side; ++i) {
    if (i % side == side - 1 || i / side == side - 1) continue;
    add_triangle(soup, i, i + 1, i + side);
    add_triangle(soup, i + 1, i + side + 1, i + side);
  }
  return soup;
}

// Somewhere on their trajectories, each up to a step behind and off it by the margin: towards a plane that parts the two, or anywhere.
reference::Points astray(Random& random, const reference::Tracks& t, const Particles& p, int a, double lifetime) {
  const double passed = between(random, 0, 1);
  reference::Points at;
  for (const std::uint32_t i : p)
    at.push_back(t.references[i] + std::max(0.0, passed - between(random, 0, 1 / lifetime)) * t.paths[i]);
  reference::Vector towards = reference::Vector::Zero();
  for (std::size_t j = 0; j < 4; ++j) towards += (static_cast<int>(j) < a ? -1.0 / a : 1.0 / (4 - a)) * at[j];
  for (std::size_t j = 0; j < 4; ++j) {
    reference::Vector way = static_cast<int>(j) < a ? towards : reference::Vector(-towards);
    if (random() % 2 == 0) way = vector(anywhere(random, 1, 0));
    at[j] += t.bounds[p[j]] / std::max(way.norm(), 1e-12) * way;
  }
  return at;
}

// The share of clusters that are smooth; none may have two places that can meet with one that it touches.
double smooth_share(const compute::Device& device, const Soup& soup, double margin, Random& random) {
  const Detected detected(device, soup, {false, 64, 0.08, margin}, "outline_edges");
  const ClusterLists& lists = detected.fabric.own.of<ClusterLists>();
  const auto smooth = detected.passes.get<std::uint32_t>(buffers::smooth_clusters, lists.surroundings.size());
  const reference::Tracks t = detected.tracks();
  const double lifetime = detected.detection().lifetime;
  double nearest = INFINITY;
  for (std::uint32_t k = 0; k < smooth.size(); ++k) {
    if (smooth[k] == 0) continue;
    const gpu::uvec4 &own = lists.surroundings[k], &first = lists.clusters[k], &end = lists.clusters[k + 1];
    for (int sample = 0; sample < 600; ++sample) {
      const std::uint32_t other = lists.around[own.x + random() % (own.y - own.x)];
      const gpu::uvec4 &from = lists.clusters[other], &to = lists.clusters[other + 1];
      const gpu::uvec4 &e = lists.edges[first.y + random() % (end.y - first.y)], &f = lists.edges[from.y + random() % std::max(1u, to.y - from.y)];
      const gpu::uvec4& face = lists.faces[from.x + random() % (to.x - from.x)];
      const bool edges = sample % 2 == 0 && to.y > from.y;
      const Particles p = edges ? Particles{e.x, e.y, f.x, f.y} : Particles{e.x, face.x, face.y, face.z};
      const int a = edges ? 2 : 1;
      if (!reference::can_be_pair(t, p, a)) continue;
      const reference::Points at = astray(random, t, p, a, lifetime);
      nearest = std::min(nearest, reference::closest({at[0], at[1], at[2], at[3]}, a).distance);
    }
  }
  EXPECT_GE(nearest, kThickness) << "margin " << margin;
  return double(std::ranges::count(smooth, 1u)) / double(smooth.size());
}

TEST_F(Detect, two_places_of_smooth_cloth_that_are_no_neighbours_cannot_meet) {
  using reference::Vector;
  const auto flat = [](double u, double v) { return Vector(u, 0, v); };
  const auto rolled = [](double u, double v) { return Vector(0.5 * std::sin(u / 0.5), 0.5 * std::cos(u / 0.5), v); };
  const auto pleated = [](double u, double v) { return Vector(0.45 * u, 0.06 * std::sin(20 * u), v); };
  const auto folded = [](double u, double v) { return Vector(std::abs(u - 0.6), u > 0.6 ? 0.012 : 0, v); };   // onto itself
  const auto pressed = [](double u, double v) { return Vector(0.25 * u, 0, v); };                              // less than its thickness wants
  const Vector still(0, 0, 0), across(0, 0.03, 0), along(0.03, 0, 0);
  Random random(40);
  EXPECT_GE(smooth_share(device(), sheet_of(random, flat, 0, still), 0.001, random), 1);
  EXPECT_GT(smooth_share(device(), sheet_of(random, flat, 0.001, across), 0.001, random), 0.5) << "falling on its flat side";
  EXPECT_GT(smooth_share(device(), sheet_of(random, rolled, 0.001, still), 0.002, random), 0.5);
  const double in_pleats = smooth_share(device(), sheet_of(random, pleated, 0.001, still), 0.001, random);
  const double about_a_fold = smooth_share(device(), sheet_of(random, folded, 0, still), 0.001, random);
  EXPECT_LT(in_pleats, 0.5);
  EXPECT_GT(about_a_fold, 0.25);
  EXPECT_LT(about_a_fold, 0.9);
  EXPECT_EQ(smooth_share(device(), sheet_of(random, flat, 0, still), 0.025, random), 0) << "particles may be anywhere";
  EXPECT_EQ(smooth_share(device(), sheet_of(random, flat, 0, along), 0.001, random), 0) << "those before may be stopped";
  EXPECT_EQ(smooth_share(device(), sheet_of(random, pressed, 0, still), 0.001, random), 0);
  EXPECT_EQ(smooth_share(device(), sheet_of(random, flat, 0.03, still), 0.001, random), 0) << "crumpled";
}

// A candidate, and what has been prepared for it.
using Prepared = std::array<gpu::uvec4, 3>;

std::vector<Prepared> prepared_by(const Detected& detected) {
  const std::uint32_t count = detected.detection().candidates;
  const auto read = [&](const Buffer& row) { return detected.passes.get<gpu::uvec4>(row, count); };
  const auto pairs = read(buffers::candidates), normals = read(buffers::contact_normals), weights = read(buffers::contact_weights);
  std::vector<Prepared> all;
  for (std::uint32_t k = 0; k < count; ++k) {
    const bool is_active = std::bit_cast<float>(normals[k].w) >= 0;
    all.push_back({pairs[k], normals[k], is_active ? weights[k] : gpu::uvec4{}});
  }
  std::ranges::sort(all, {}, [](const Prepared& p) { return std::array{p[0].x, p[0].y, p[0].z, p[0].w}; });
  return all;
}

// The ten passes; a search and pairs of both kinds at once; one workgroup before these; and after that one dispatch for all that is left:
// in one detection, in the next, which measures bounds by the first, and in a substep without one.
TEST_F(Detect, one_that_is_seldom_or_united_or_calm_finds_and_prepares_the_same_to_the_bit) {
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
  };
  for (const std::uint32_t triangles : {3u, 300u})
    for (const bool gather_storage : {false, true})
      for (const bool untangle : {false, true}) {
        Random random(41 + triangles);
        const Soup soup = random_soup(random, triangles);
        std::vector<Setting> settings(untangle ? 3 : 4);   // what may have crossed is not calm
        settings[1].seldom = settings[2].united = true;
        if (!untangle) settings[3].calm = true;
        std::vector<std::unique_ptr<Detected>> ways;
        for (Setting& setting : settings) {
          setting.gather_storage = gather_storage;
          setting.fastest = 0.01;
          setting.untangle = untangle;
          ways.push_back(std::make_unique<Detected>(device(), soup, setting));
        }
        for (int round = 0; round < 3; ++round) {
          for (std::size_t k = 0; k < ways.size(); ++k)
            if (!settings[k].calm) ways[k]->passes.run("contact_prepare");
          const Detected& often = *ways[0];
          const gpu::Detection a = often.detection();
          ASSERT_GT(a.candidates, 0u);
          EXPECT_TRUE(round == 2 || a.most_pushed > 0);
          EXPECT_TRUE(triangles < 300 || a.listings[WEFT_ACTIVE] > 100);
          EXPECT_TRUE(!untangle || triangles < 300 || a.crossings > 0);
          const std::size_t particles = soup.predicted.size();
          for (const auto& other : ways) {
            EXPECT_TRUE(same(prepared_by(often), prepared_by(*other)));
            for (const Buffer* row : {&buffers::detected_positions, &buffers::trajectories})
              EXPECT_TRUE(same(often.passes.particles(*row), other->passes.particles(*row))) << row->name;
            for (const Buffer* row : {&buffers::displacement_bounds, &buffers::near_bounds, &buffers::contact_counts}) {
              const auto read = [&](const Detected& detected) { return detected.passes.get<std::uint32_t>(*row, particles); };
              EXPECT_TRUE(same(read(often), read(*other))) << row->name;
            }
            EXPECT_TRUE(same(std::vector{a}, std::vector{other->detection()}));
            EXPECT_TRUE(same(std::vector{often.passes.counters()}, std::vector{other->passes.counters()}));
          }
          if (round == 2) break;
          // Another detection; and then a substep without one, in which candidates are prepared anew.
          for (std::size_t k = 0; k < ways.size(); ++k) {
            auto& passes = ways[k]->passes;
            gpu::Detection next = ways[k]->detection();
            next.needs_detection = round == 0;
            next.fastest = std::bit_cast<std::uint32_t>(0.02f);
            passes.put(buffers::detection, std::vector{next});
            passes.put(buffers::contact_counts, std::vector<std::uint32_t>(particles));
            for (const std::string_view name : Detected::passes_of(settings[k])) passes.run(name);
          }
        }
      }
}

// Pairs that meet are found in spite of it.
TEST_F(Detect, finds_the_pairs_of_a_folded_sheet_whose_halves_are_smooth) {
  Random random(41);
  const Soup soup = sheet_of(random, [](double u, double v) { return reference::Vector(std::abs(u - 0.3), u > 0.3 ? 0.012 : 0, v); }, 0,
                             reference::Vector(0, 0, 0), 13);
  const Detected detected(device(), soup, {false, 64, 0.08, 0.002});
  const Oracle oracle = all_pairs(soup, detected.tracks(), doubt_of(2));
  ASSERT_GT(oracle.certain.size(), 1000u);
  expect_agreement(detected, oracle, doubt_of(2));
}

}  // namespace
}  // namespace weft
