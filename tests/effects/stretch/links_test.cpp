// Links as they are cooked: which pairs hold a distance, how stiff they are together, and how they are packed.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "engine/cook/parts.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using cooking::Spring;
using cooking::vector;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr cooking::Stiffness kCotton{10e3, 45};

Mesh square(std::uint32_t cells, Topology topology) { return make_grid(Grid{{1, 1}, cells, cells, topology, true}); }
Pair sorted(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }
double straight(const Mesh& mesh, const Spring& s) { return (vector(mesh.points[s.a]) - vector(mesh.points[s.b])).norm(); }

// J, of the sheet mapped linearly.
double energy(const Mesh& mesh, const std::vector<Spring>& springs, const Eigen::Matrix3d& map) {
  double sum = 0;
  for (const Spring& s : springs) {
    const double c = (map * (vector(mesh.points[s.a]) - vector(mesh.points[s.b]))).norm() - s.rest;
    if (!s.only_pulls || c > 0) sum += c * c / (2 * s.compliance);
  }
  return sum;
}

Eigen::Matrix3d stretched(double x, double y, double shear) {
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(0, 0) += x;
  map(1, 1) += y;
  map(0, 1) = map(1, 0) = shear / 2;
  return map;
}

TEST(Links, every_edge_of_the_mesh_is_a_link_once) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const Mesh mesh = square(12, topology);
    std::map<Pair, int> found;
    for (const Spring& s : cooking::springs(mesh, kCotton)) ++found[sorted(s.a, s.b)];
    for (const WingedEdge& edge : mesh.edges) EXPECT_EQ(found[sorted(edge.a, edge.b)], 1);
    for (const auto& [pair, count] : found) EXPECT_EQ(count, 1) << pair.first << " " << pair.second;
  }
}

TEST(Links, only_the_edges_of_the_mesh_push) {
  const Mesh mesh = square(9, Topology::diagonal);
  std::set<Pair> edges;
  for (const WingedEdge& edge : mesh.edges) edges.insert(sorted(edge.a, edge.b));
  for (const Spring& s : cooking::springs(mesh, kCotton)) EXPECT_EQ(!s.only_pulls, edges.contains(sorted(s.a, s.b)));
}

TEST(Links, every_quad_has_its_second_diagonal) {
  const std::uint32_t n = 5;   // too short for far links
  const Mesh mesh = square(n, Topology::diagonal);
  std::set<Pair> found;
  for (const Spring& s : cooking::springs(mesh, kCotton))
    if (s.only_pulls) found.insert(sorted(s.a, s.b));
  EXPECT_EQ(found.size(), n * n);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) EXPECT_TRUE(found.contains(sorted(j * (n + 1) + i + 1, (j + 1) * (n + 1) + i)));
}

TEST(Links, an_equilateral_mesh_has_no_second_diagonal) {
  Mesh mesh = square(5, Topology::diagonal);
  for (Vec3& p : mesh.points) p = {p.x - 0.5f * p.y, 0.8660254f * p.y, 0};
  for (const Spring& s : cooking::springs(mesh, kCotton)) EXPECT_FALSE(s.only_pulls);
}

// Lines of eight edges: along rows and columns; between squares with centres along both diagonals and the rim.
TEST(Links, far_links_are_counted) {
  for (const std::uint32_t n : {7u, 8u, 9u, 20u}) {
    const Mesh rows = square(n, Topology::diagonal);
    const std::size_t near = rows.edges.size() + n * n, far = n < 8 ? 0 : 2 * (n + 1) * (n - 7);
    EXPECT_EQ(cooking::springs(rows, kCotton).size(), near + far) << n;

    const Mesh crosses = square(n, Topology::centre);
    const std::size_t inner = 2 * n * (n - 1), along = 2 * ((n - 3) * (n - 3) + (n - 4) * (n - 4)), rim = n < 8 ? 0 : 4 * (n - 7);
    EXPECT_EQ(cooking::springs(crosses, kCotton).size(), crosses.edges.size() + inner + along + rim) << n;
  }
}

TEST(Links, on_a_grid_every_link_is_as_long_as_its_line) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const Mesh mesh = square(16, topology);
    // Points are rounded to 2^-25 m at 0.5 m: the sum of eight lengths differs by that much per step.
    for (const Spring& s : cooking::springs(mesh, kCotton)) EXPECT_NEAR(s.rest, straight(mesh, s), 1e-7);
  }
}

TEST(Links, on_a_curved_sheet_no_far_link_is_shorter_than_the_straight_distance) {
  Mesh mesh = square(40, Topology::diagonal);
  for (Vec3& p : mesh.points) p = {0.2f * std::sin(5 * p.x), p.y + 0.03f * std::sin(9 * p.x), 0.2f * std::cos(5 * p.x)};
  double longest = 0;
  for (const Spring& s : cooking::springs(mesh, kCotton)) {
    EXPECT_GE(s.rest, straight(mesh, s) * (1 - 1e-12));
    longest = std::max(longest, s.rest / straight(mesh, s));
  }
  EXPECT_GT(longest, 1.01);   // the test had something to find
}

// Cotton's shear modulus is 0.45 % of its stretch modulus, and the diagonals add that much to both; squares with centres have half
// a cell less along each rim, 1.6 % of 32.
TEST(Links, an_evenly_stretched_sheet_has_half_modulus_times_strain_squared_times_area) {
  constexpr double kStrain = 1e-4;
  for (const Topology topology : {Topology::diagonal, Topology::centre})
    for (const std::uint32_t n : {32u, 64u}) {
      const Mesh mesh = square(n, topology);
      const auto springs = cooking::springs(mesh, kCotton);
      const double expected = 0.5 * kCotton.stretch * kStrain * kStrain;
      EXPECT_NEAR(energy(mesh, springs, stretched(kStrain, 0, 0)) / expected, 1, 0.02) << n;
      EXPECT_NEAR(energy(mesh, springs, stretched(0, kStrain, 0)) / expected, 1, 0.02) << n;
    }
}

TEST(Links, stiffness_does_not_depend_on_how_many_far_links_fit) {
  constexpr double kStrain = 1e-4;
  const double expected = 0.5 * kCotton.stretch * kStrain * kStrain;
  for (const std::uint32_t n : {2u, 7u, 8u, 9u, 15u, 17u, 24u}) {
    const Mesh mesh = square(n, Topology::diagonal);
    EXPECT_NEAR(energy(mesh, cooking::springs(mesh, kCotton), stretched(kStrain, 0, 0)) / expected, 1, 0.01) << n;
  }
}

// Taut, so that both diagonals of every quad pull. Edges grow by gamma^2 / 8 and take 0.7 % part at this tension.
TEST(Links, a_sheared_taut_sheet_has_half_modulus_times_angle_squared_times_area) {
  constexpr double kAngle = 1e-4, kTension = 0.6e-4;
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const Mesh mesh = square(32, topology);
    const auto springs = cooking::springs(mesh, kCotton);
    const double rest = energy(mesh, springs, stretched(kTension, kTension, 0));
    for (const double angle : {kAngle, -kAngle}) {
      const double added = energy(mesh, springs, stretched(kTension, kTension, angle)) - rest;
      EXPECT_NEAR(added / (0.5 * kCotton.shear * kAngle * kAngle), 1, 0.02) << angle;
    }
  }
}

// Diagonals at 27 degrees add four shear moduli, 1.8 %, along x.
TEST(Links, oblong_cells_are_as_stiff_as_square_ones) {
  constexpr double kStrain = 1e-4;
  const Mesh mesh = make_grid(Grid{{2, 1}, 16, 16, Topology::diagonal, true});
  const auto springs = cooking::springs(mesh, kCotton);
  const double expected = 0.5 * kCotton.stretch * kStrain * kStrain * 2;
  EXPECT_NEAR(energy(mesh, springs, stretched(kStrain, 0, 0)) / expected, 1, 0.02);
  EXPECT_NEAR(energy(mesh, springs, stretched(0, kStrain, 0)) / expected, 1, 0.02);
}

TEST(Links, a_rigid_fabric_has_no_compliance) {
  const double rigid = std::numeric_limits<double>::infinity();
  for (const Topology topology : {Topology::diagonal, Topology::centre})
    for (const Spring& s : cooking::springs(square(10, topology), {rigid, rigid})) EXPECT_EQ(s.compliance, 0);
}

TEST(Links, they_are_packed_within_their_tolerance) {
  Scene scene = without_contacts();
  scene.solver.method = Method::jacobi;
  scene.cloths.emplace_back().grid = Grid{{1.3f, 0.7f}, 21, 13, Topology::centre, false};
  const auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes) << meshes.error();
  const auto fabric = cook(scene, *meshes);
  ASSERT_TRUE(fabric) << fabric.error();
  const auto springs = cooking::springs((*meshes)[0], {scene.cloths[0].fabric.stretch, scene.cloths[0].fabric.shear});
  ASSERT_EQ(fabric->links.size(), springs.size());
  for (std::size_t k = 0; k < springs.size(); ++k) {
    EXPECT_NEAR(fabric->links[k].rest / springs[k].rest, 1, 8e-6);
    EXPECT_NEAR(fabric->links[k].compliance / springs[k].compliance, 1, 0.005);
  }
}

TEST(PackedLink, it_comes_back_within_its_tolerance) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> exponent(-37, 37), length_exponent(-9, 9);
  for (int trial = 0; trial < 100'000; ++trial) {
    const gpu::Link link{static_cast<std::uint32_t>(random() % (WEFT_MAX_PARTICLES + 1)), std::pow(10.0f, length_exponent(random)),
                         std::pow(10.0f, exponent(random)), trial % 2 == 0};
    const gpu::uvec2 packed = gpu::pack_link(link);
    const gpu::Link back = gpu::unpack_link(packed.x, packed.y);
    ASSERT_EQ(back.other, link.other);
    ASSERT_EQ(back.only_pulls, link.only_pulls);
    ASSERT_NEAR(back.rest / link.rest, 1, 0x1.01p-19);   // 18 bits of mantissa, rounded
    ASSERT_NEAR(back.response / link.response, 1, 0.004);
    // What the GPU will read packs to itself: nothing drifts.
    const gpu::uvec2 again = gpu::pack_link(back);
    ASSERT_TRUE(again.x == packed.x && again.y == packed.y);
  }
}

TEST(PackedLink, extremes_stay_in_their_fields) {
  constexpr float kValues[] = {0, std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(), 1e30f, 3.3e38f,
                               std::numeric_limits<float>::infinity()};
  for (const float rest : kValues)
    for (const float compliance : kValues)
      for (const std::uint32_t other : {0u, 1u, WEFT_MAX_PARTICLES})
        for (const bool only_pulls : {false, true}) {
          const gpu::uvec2 packed = gpu::pack_link({other, rest, compliance, only_pulls});
          const gpu::Link back = gpu::unpack_link(packed.x, packed.y);
          EXPECT_EQ(back.other, other);
          EXPECT_EQ(back.only_pulls, only_pulls);
          // Below the normal numbers only the size is kept: an absolute error of half a last kept bit.
          const auto near = [](float value, float expected, double relative) {
            return value == expected || std::abs(double(value) - expected) <= std::max(relative * expected, 1e-40);
          };
          EXPECT_EQ(back.rest, rest < 1 ? 0 : 0x1.ffffcp31f) << rest;
          EXPECT_TRUE(near(back.response, compliance, 0.004)) << compliance;
        }
}

}  // namespace
}  // namespace weft
