// The cook: masses, order, bends, tethers, surface, and that all of it is the same every time.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "engine/cook/parts.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using cooking::vector;

Scene hung(std::uint32_t cells, Topology topology = Topology::diagonal) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, topology, true};
  cloth.anchors.resize(1);
  cloth.anchors[0].corners = {Corner::low_high, Corner::high_high};
  return scene;
}

// Particle -> its entries (id, payload) without padding.
std::vector<std::vector<gpu::uvec2>> unpacked(const PairRows& rows) {
  std::vector<std::vector<gpu::uvec2>> lists(rows.rows.size());
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (std::uint32_t k = 0; k < rows.rows[i].y; ++k) {
      const gpu::uvec4& pair = rows.pairs[rows.rows[i].x + k / 2];
      lists[i].push_back(k % 2 == 0 ? gpu::uvec2{pair.x, pair.y} : gpu::uvec2{pair.z, pair.w});
    }
  return lists;
}

TEST(Fabric, masses_sum_to_area_times_density) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    Scene scene = hung(17, topology);
    scene.cloths[0].grid->size = {2, 0.5f};
    scene.cloths[0].anchors.clear();
    double mass = 0;
    for (const gpu::vec4& p : cooked(scene).positions) mass += 1 / double(p.w);
    EXPECT_NEAR(mass, 0.12, 1e-7);   // of single precision
  }
}

TEST(Fabric, anchors_alone_have_no_inverse_mass) {
  const CookedFabric fabric = cooked(hung(8));
  ASSERT_EQ(fabric.anchors.size(), 2u);
  EXPECT_EQ(std::count_if(fabric.positions.begin(), fabric.positions.end(), [](const gpu::vec4& p) { return p.w == 0; }), 2);
  for (const AnchorTarget& anchor : fabric.anchors) {
    EXPECT_EQ(fabric.positions[anchor.particle].w, 0);
    EXPECT_EQ(fabric.split_weights[anchor.particle], 0);
    EXPECT_EQ(fabric.positions[anchor.particle].x, anchor.rest.x);
    EXPECT_EQ(fabric.surface_rows[anchor.vertex].x, anchor.particle);
  }
}

double bandwidth(const Mesh& mesh, const std::vector<std::uint32_t>& order) {
  std::vector<double> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<double>(k);
  double widest = 0;
  for (const WingedEdge& edge : mesh.edges) widest = std::max(widest, std::abs(place[edge.a] - place[edge.b]));
  return widest;
}

TEST(Fabric, the_order_is_a_permutation_that_brings_neighbours_together) {
  const Mesh regular = make_grid(Grid{{1, 1}, 40, 40, Topology::diagonal, true});
  std::vector<std::uint32_t> shuffle(regular.points.size()), unshuffled(shuffle.size());
  std::iota(shuffle.begin(), shuffle.end(), 0u);
  unshuffled = shuffle;
  std::shuffle(shuffle.begin(), shuffle.end(), std::mt19937_64(1));
  RenderMesh render;
  render.positions.resize(shuffle.size());
  for (std::size_t p = 0; p < shuffle.size(); ++p) render.positions[shuffle[p]] = regular.points[p];
  for (const auto& [a, b, c] : regular.triangles) render.triangles.push_back({shuffle[a], shuffle[b], shuffle[c]});
  const auto mesh = weld_mesh(std::move(render));
  ASSERT_TRUE(mesh) << mesh.error();

  const auto order = cooking::locality_order(*mesh);
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, unshuffled);
  // A level of the walk over n x n cells has up to 2 n points with one diagonal; an edge spans two levels at most.
  EXPECT_LT(bandwidth(*mesh, order), 4 * 40);
  EXPECT_GT(bandwidth(*mesh, unshuffled), 1000);
}

TEST(Fabric, cloths_follow_one_another_and_share_no_link) {
  Scene scene = hung(6);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "second";
  const CookedFabric fabric = cooked(scene);
  ASSERT_EQ(fabric.cloths.size(), 2u);
  for (const StretchLink& link : fabric.links) EXPECT_EQ(link.a < 49, link.b < 49);
  for (std::uint32_t i = 0; i < 98; ++i) EXPECT_EQ(std::bit_cast<std::uint32_t>(fabric.velocities[i].w), i / 49);
  EXPECT_EQ(fabric.cloths[1].first_particle, 49u);
  EXPECT_EQ(fabric.cloths[1].first_vertex, 49u);
  EXPECT_EQ(fabric.cloths[1].first_anchor, 2u);
}

TEST(Fabric, both_ends_of_a_link_list_it_and_odd_lists_are_padded_with_their_owner) {
  const CookedFabric fabric = cooked(hung(9, Topology::centre));
  const auto lists = unpacked(fabric.stretch);
  std::size_t entries = 0;
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    entries += lists[i].size();
    const gpu::uvec2 row = fabric.stretch.rows[i];
    if (row.y % 2 == 0) continue;
    const gpu::uvec4& last = fabric.stretch.pairs[row.x + row.y / 2];
    const gpu::Link padding = gpu::unpack_link(last.z, last.w);
    EXPECT_TRUE(padding.other == i && padding.rest == 0);
  }
  EXPECT_EQ(entries, 2 * fabric.links.size());
  for (const StretchLink& link : fabric.links)
    for (const auto& [own, other] : {std::pair(link.a, link.b), std::pair(link.b, link.a)})
      EXPECT_EQ(std::count_if(lists[own].begin(), lists[own].end(), [&, other = other](gpu::uvec2 e) {
        const gpu::Link found = gpu::unpack_link(e.x, e.y);
        return found.other == other && found.rest == link.rest && found.response == link.gain && found.only_pulls == link.only_pulls;
      }), 1);
}

TEST(Fabric, a_particle_shows_its_links_as_many_times_its_inverse_mass_and_with_plain_counts_just_that) {
  Scene scene = hung(10);
  CookedFabric fabric = cooked(scene);
  for (std::size_t i = 0; i < fabric.positions.size(); ++i)
    EXPECT_EQ(fabric.split_weights[i], static_cast<float>(fabric.stretch.rows[i].y) * fabric.positions[i].w);
  scene.solver.averaging = Averaging::count;
  fabric = cooked(scene);
  for (std::size_t i = 0; i < fabric.positions.size(); ++i) EXPECT_EQ(fabric.split_weights[i], fabric.positions[i].w);
}

// Rounded to single precision; the largest coefficient of a stencil is below 40.
constexpr double kRounding = 40 * 0x1p-23;

TEST(Fabric, bending_coefficients_sum_to_zero_and_slivers_are_limited_and_noted) {
  Scene scene = hung(6);
  scene.cloths[0].grid->size = {0.05f, 3};   // one degree between diagonals and columns
  auto meshes = make_meshes(scene);
  for (Vec3& p : (*meshes)[0].points) p.x += 0.5f * p.y;   // askew: no lattice
  const CookedFabric fabric = *cook(scene, *meshes);
  ASSERT_FALSE(fabric.notes.empty());
  EXPECT_NE(fabric.notes[0].find("slivers"), std::string::npos) << fabric.notes[0];
  for (const gpu::Bend& bend : fabric.bends) {
    EXPECT_NEAR(double(bend.k[0]) + bend.k[1] + bend.k[2] + bend.k[3], 0, kRounding);
    for (const float k : bend.k) EXPECT_LE(std::abs(k), 40.001f);
    EXPECT_TRUE(std::isfinite(bend.split_weight) && bend.compliance > 0);
  }
  EXPECT_TRUE(cooked(hung(6)).notes.empty());
}

// Of lines that cross a point from one neighbour to the opposite one, and of quads. Grids with centres have theirs askew: lines over
// every centre and every inner corner, and a quad about every inner side of a cell.
TEST(Fabric, a_lattice_bends_along_its_lines_and_over_its_quads) {
  for (const long n : {1l, 2l, 7l}) {
    const auto stencils = [&](Topology topology) {
      Scene scene = hung(std::uint32_t(n), topology);
      scene.cloths[0].bends_as_plate = true;
      return static_cast<long>(cooked(scene).bends.size());
    };
    EXPECT_EQ(stencils(Topology::diagonal), 2 * (n - 1) * (n + 1) + n * n) << n;
    if (n == 1) continue;
    EXPECT_EQ(stencils(Topology::centre), 2 * n * n + 2 * (n - 1) * (n - 1) + 2 * n * (n - 1))
        << n << ", with centres";
  }
}

TEST(Fabric, where_there_is_no_lattice_inner_edges_bend_and_boundary_edges_do_not) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    Scene scene = hung(7, topology);
    scene.cloths[0].bends_as_plate = true;
    auto meshes = make_meshes(scene);
    // Askew, and cells of two squares, whose quads have angles of 53 degrees.
    for (Vec3& p : (*meshes)[0].points) p = topology == Topology::centre ? Vec3{p.x, 2 * p.y, p.z} : Vec3{p.x + 0.5f * p.y, p.y, p.z};
    const auto inner = std::count_if((*meshes)[0].edges.begin(), (*meshes)[0].edges.end(),
                                     [](const WingedEdge& e) { return e.triangle[1] != kNone && e.triangle[0] != kNone; });
    EXPECT_EQ(static_cast<long>(cook(scene, *meshes)->bends.size()), static_cast<long>(inner));
  }
}

// A sheet of masses over two decades: every particle's row against the stencils themselves.
struct BendSheet {
  CookedFabric fabric;
  std::vector<std::map<std::uint32_t, double>> matrix, from_stencils;   // off the diagonal; the diagonal in from_stencils only
};

BendSheet bend_sheet() {
  Scene scene = hung(9);
  scene.cloths[0].fabric.bend = 1e-3;
  auto meshes = make_meshes(scene);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> shift(-0.03f, 0.03f);
  for (Vec3& p : (*meshes)[0].points) p = {p.x + shift(random), p.y + shift(random), shift(random)};
  auto fabric = cook(scene, *meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  BendSheet sheet{std::move(*fabric), {}, {}};
  const std::size_t n = sheet.fabric.positions.size();
  sheet.matrix.resize(n);
  sheet.from_stencils.resize(n);
  const auto lists = unpacked(sheet.fabric.bend);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const auto& [other, bits] : lists[i]) sheet.matrix[i][other] = std::bit_cast<float>(bits);
  std::vector<int> uses(n);
  for (const gpu::Bend& bend : sheet.fabric.bends)
    for (int j = 0; j < (bend.k[3] == 0 ? 3 : 4); ++j) ++uses[bend.particle[j]];
  for (const gpu::Bend& bend : sheet.fabric.bends) {
    double weight = 0;
    for (int j = 0; j < 4; ++j) weight += uses[bend.particle[j]] * double(sheet.fabric.positions[bend.particle[j]].w) * bend.k[j] * bend.k[j];
    const double softness = std::max(bend.compliance / (double(sheet.fabric.h) * sheet.fabric.h), weight / 1.25);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        sheet.from_stencils[bend.particle[i]][bend.particle[j]] +=
            double(bend.k[i]) * sheet.fabric.positions[bend.particle[i]].w * bend.k[j] / softness;
  }
  return sheet;
}

TEST(Fabric, the_bending_matrix_is_the_sum_of_the_stencils_and_its_rows_sum_to_zero_with_the_diagonal) {
  const BendSheet sheet = bend_sheet();
  for (std::uint32_t i = 0; i < sheet.matrix.size(); ++i) {
    const double diagonal = sheet.from_stencils[i].contains(i) ? sheet.from_stencils[i].at(i) : 0;
    const double tolerance = 1e-6 * std::max(diagonal, 1e-9);
    double sum = diagonal;
    for (const auto& [j, m] : sheet.matrix[i]) {
      sum += m;
      ASSERT_NEAR(m, sheet.from_stencils[i].at(j), tolerance) << i << " " << j;
    }
    EXPECT_NEAR(sum, 0, 10 * tolerance);
    EXPECT_FALSE(sheet.matrix[i].contains(i));
    EXPECT_EQ(sheet.matrix[i].empty(), sheet.fabric.positions[i].w == 0);
  }
}

TEST(Fabric, the_bending_matrix_conserves_momentum) {
  const BendSheet sheet = bend_sheet();
  for (std::uint32_t i = 0; i < sheet.matrix.size(); ++i)
    for (const auto& [j, m] : sheet.matrix[i]) {
      // Terms are rounded to single precision before they are summed, and may nearly cancel.
      const double tolerance = 1e-6 * sheet.from_stencils[i].at(i) / sheet.fabric.positions[i].w;
      if (sheet.fabric.positions[j].w == 0) continue;
      const double there = m / sheet.fabric.positions[i].w, back = sheet.matrix[j].at(i) / sheet.fabric.positions[j].w;
      EXPECT_NEAR(there, back, tolerance) << i << " " << j;
    }
}

TEST(Fabric, tethers_are_as_long_as_the_way_plus_slack_and_anchors_have_none) {
  Scene scene = hung(16);
  scene.cloths[0].tether_slack = 0.1;
  const CookedFabric fabric = cooked(scene);
  ASSERT_EQ(fabric.tethers_per_particle, 2u);
  EXPECT_EQ(fabric.tether_count, (17u * 17 - 2) * 2);
  for (std::uint32_t i = 0; i < fabric.positions.size(); ++i)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const gpu::Tether& tether = fabric.tethers[2 * i + k];
      if (fabric.positions[i].w == 0) {
        EXPECT_EQ(tether.anchor, WEFT_NONE);
        continue;
      }
      const gpu::vec4 &a = fabric.positions[tether.anchor], &p = fabric.positions[i];
      EXPECT_EQ(a.w, 0);
      EXPECT_NEAR(tether.max_distance, 1.1 * std::hypot(double(a.x) - p.x, double(a.y) - p.y), 1e-6);
    }
}

// By the strain of a line that carries the cloth's weight, (q L / Y)^(2/3) / 24^(1/3), as stiff as the fabric is in that direction.
// As long as the way, tethers held a sheet between two corners as a board.
TEST(Fabric, tethers_give_way_as_the_fabric_does_along_its_threads_and_across_them) {
  const auto angle = [](const gpu::vec4& a, const gpu::vec4& p) { return std::atan2(double(p.y) - a.y, double(p.x) - a.x); };
  for (const double turned : {0.0, 30.0}) {   // degrees: the threads turn with the cloth
    Scene scene = hung(16);
    scene.cloths[0].transform.axis = {0, 0, 1};
    scene.cloths[0].transform.degrees = turned;
    const CookedFabric fabric = cooked(scene);
    ASSERT_EQ(fabric.tethers_per_particle, 2u);
    for (std::uint32_t k = 0; k < fabric.tethers.size(); ++k) {
      const gpu::Tether& tether = fabric.tethers[k];
      if (tether.anchor == WEFT_NONE) continue;
      const gpu::vec4 &a = fabric.positions[tether.anchor], &p = fabric.positions[k / 2];
      const double across = std::sin(2 * (angle(a, p) - turned * std::numbers::pi / 180)), askew = across * across / 4;
      const double longest = std::sqrt(2.0), compliance = (1 - 2 * askew) / 10e3 + askew / 45;   // m, m/N: cotton
      const double strain = std::pow(0.12 * 9.81 * longest * compliance, 2.0 / 3) / std::cbrt(24);
      EXPECT_NEAR(tether.max_distance, (1 + strain) * std::hypot(double(p.x) - a.x, double(p.y) - a.y), 2e-6) << turned << " " << k;
    }
  }
}

TEST(Fabric, lists_of_tethers_are_even_and_padded) {
  Scene scene = hung(4);
  scene.cloths[0].anchors[0].corners = {Corner::low_high};
  const CookedFabric fabric = cooked(scene);
  EXPECT_EQ(fabric.tethers_per_particle, 2u);
  EXPECT_EQ(fabric.tether_count, 24u);
  EXPECT_EQ(std::count_if(fabric.tethers.begin(), fabric.tethers.end(), [](const gpu::Tether& t) { return t.anchor == WEFT_NONE; }), 26);
}

TEST(Fabric, render_vertices_know_their_particle_and_all_corners_around_it) {
  const CookedFabric fabric = cooked(hung(5));
  std::size_t corners = 0;
  for (const gpu::uvec4& row : fabric.surface_rows) {
    corners += row.z;
    for (std::uint32_t k = row.y; k < row.y + row.z; ++k) {
      const Triangle wanted{row.x, fabric.corners[k].x, fabric.corners[k].y};
      const auto same = [&](Triangle t) {
        for (int turn = 0; turn < 3; ++turn, std::rotate(t.begin(), t.begin() + 1, t.end()))
          if (t == wanted) return true;
        return false;
      };
      EXPECT_EQ(std::count_if(fabric.triangles.begin(), fabric.triangles.end(), same), 1);
    }
  }
  EXPECT_EQ(corners, 3 * fabric.triangles.size());
}

TEST(Fabric, a_link_answers_with_its_gain_in_one_iteration_and_with_its_compliance_in_several) {
  Scene scene = hung(9);
  const CookedFabric fabric = cooked(scene);
  for (const StretchLink& link : fabric.links) {
    const double weight = double(fabric.split_weights[link.a]) + fabric.split_weights[link.b];
    // 7 bits of mantissa, rounded: 2^-8.
    EXPECT_NEAR(link.gain * (weight + relaxation_of(scene) * link.compliance / (fabric.h * fabric.h)), 1, 0.004);
  }
  scene.solver.iterations = 2;
  const CookedFabric iterated = cooked(scene);
  const auto lists = unpacked(iterated.stretch);
  for (const StretchLink& link : iterated.links) {
    EXPECT_EQ(link.gain, 0);
    EXPECT_EQ(std::count_if(lists[link.a].begin(), lists[link.a].end(), [&](gpu::uvec2 e) {
      const gpu::Link found = gpu::unpack_link(e.x, e.y);
      return found.other == link.b && found.response == link.compliance;
    }), 1);
  }
}

TEST(Fabric, the_softest_fabric_has_finite_compliances) {
  Scene scene = hung(10);
  scene.cloths[0].fabric.shear = scene.cloths[0].fabric.bend = 1e-300;
  const CookedFabric fabric = cooked(scene);
  for (const StretchLink& link : fabric.links) EXPECT_LT(link.compliance, 2e12f);
  for (const gpu::Bend& bend : fabric.bends) EXPECT_LT(bend.compliance, 2e12f);
}

TEST(Fabric, a_hosts_scene_without_iterations_or_rate_is_a_sentence) {
  Scene scene = hung(2);
  const auto meshes = make_meshes(scene);
  scene.solver.iterations = 0;
  EXPECT_EQ(cook(scene, *meshes).error(), "solver.iterations: 0 is less than 1");
  scene.solver = {};
  scene.solver.rate = 0;
  EXPECT_EQ(cook(scene, *meshes).error(), "solver.rate: 0 is not above 0 (Hz)");
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(Fabric, cooking_twice_gives_the_same_bits) {
  for (const std::uint32_t iterations : {1u, 3u}) {
    Scene scene = hung(24, Topology::centre);
    scene.solver.iterations = iterations;
    const CookedFabric a = cooked(scene), b = cooked(scene);
    EXPECT_TRUE(same_bits(a.positions, b.positions) && same_bits(a.velocities, b.velocities) &&
                same_bits(a.split_weights, b.split_weights));
    for (const auto rows : {&CookedFabric::stretch, &CookedFabric::bend, &CookedFabric::bend_uses})
      EXPECT_TRUE(same_bits((a.*rows).rows, (b.*rows).rows) && same_bits((a.*rows).pairs, (b.*rows).pairs));
    EXPECT_TRUE(same_bits(a.bends, b.bends) && same_bits(a.tethers, b.tethers) && same_bits(a.materials, b.materials));
    EXPECT_TRUE(same_bits(a.surface_rows, b.surface_rows) && same_bits(a.corners, b.corners) && same_bits(a.triangles, b.triangles));
    EXPECT_EQ(a.links.size(), b.links.size());
  }
}

}  // namespace
}  // namespace weft
