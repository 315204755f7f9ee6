// Coarse levels: that they measure along the cloth, carry what is linear exactly, and join nothing that the cloth does not.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "engine/cook/parts.h"
#include "engine/effects/level/coarsen.h"
#include "engine/effects/level/level.h"
#include "engine/effects/level/threads.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using cooking::Coarse;
using cooking::Rank;

Coarse coarse(const Mesh& mesh) { return cooking::coarsen(cooking::surface_of(mesh), cooking::ranks_of(mesh), {}); }

// The triangles whose middles `kept` keeps.
template <class Kept>
Mesh cut_out(const Grid& grid, Kept kept) {
  const Mesh whole = make_grid(grid);
  RenderMesh render;
  render.positions = whole.render.positions;
  for (const auto& t : whole.render.triangles)
    if (kept((1.f / 3) * (render.positions[t[0]] + render.positions[t[1]] + render.positions[t[2]]))) render.triangles.push_back(t);
  return must(weld_mesh(std::move(render)));
}

Vec3 carried(const Coarse& level, const std::vector<Vec3>& of_nodes, std::size_t p) {
  Vec3 sum{};
  for (int k = 0; k < 3; ++k) sum = sum + static_cast<float>(level.shares[p].part[k]) * of_nodes[level.shares[p].node[k]];
  return sum;
}

Vec3 particle(const CookedFabric& fabric, std::uint32_t i) { return {fabric.positions[i].x, fabric.positions[i].y, fabric.positions[i].z}; }

// Of all nodes.
std::vector<Vec3> middles(const CookedFabric& fabric) {
  const LevelLists& lists = fabric.own.of<LevelLists>();
  if (lists.ends.empty()) return {};
  std::vector<Vec3> at(lists.ends.back());
  for (std::uint32_t k = lists.ends.back(); k-- > 0;) {
    const std::uint32_t begin = gpu::unpack_level_node(lists.nodes[k]).first_gather, end = gpu::unpack_level_node(lists.nodes[k + 1]).first_gather;
    const bool finest = lists.ends.size() == 1 || k >= lists.ends[lists.ends.size() - 2];
    const auto point = [&](std::uint32_t g) { return finest ? particle(fabric, lists.gathers[g].x) : at[lists.gathers[g].x]; };
    at[k] = point(begin);
    for (std::uint32_t g = begin + 1; g < end; ++g)
      at[k] = at[k] + gpu::unpack_level_gather(lists.gathers[g]).in_middle * (point(g) - point(begin));
  }
  return at;
}

const Grid kLevelGrids[] = {
    {{1, 1}, 40, 40, Topology::diagonal, true}, {{2, 0.5f}, 60, 30, Topology::centre, true}, {{1, 1}, 16, 60, Topology::diagonal, true}};
const Grid kStrips[] = {{{1.3f, 0.05f}, 26, 1, Topology::diagonal, true}, {{1.3f, 0.1f}, 90, 3, Topology::centre, true}};

TEST(Levels, links_are_as_long_as_the_way_along_the_cloth_and_shares_carry_a_linear_displacement) {
  for (const cooking::Nodes where : {cooking::Nodes::anywhere, cooking::Nodes::along_threads})
   for (const Grid& grid : kLevelGrids) {
    const Mesh mesh = make_grid(grid);
    cooking::IntrinsicSurface surface = cooking::surface_of(mesh);
    std::vector<Rank> ranks = cooking::ranks_of(mesh);
    std::vector<Vec3> points = mesh.points;
    for (int level = 0; level < 3 && points.size() > 30; ++level) {
      SCOPED_TRACE(level);
      const Coarse made = cooking::coarsen(surface, ranks, {}, where);
      ASSERT_LT(made.points.size(), points.size() / 2);
      std::vector<Vec3> at_nodes;
      std::vector<Rank> rank_of_nodes;
      for (const std::uint32_t p : made.points) at_nodes.push_back(points[p]), rank_of_nodes.push_back(ranks[p]);
      for (const auto& link : made.links) EXPECT_NEAR(link.rest, length(at_nodes[link.a] - at_nodes[link.b]), 1e-3 * link.rest);
      for (std::size_t p = 0; p < points.size(); ++p) {
        const auto& part = made.shares[p].part;
        EXPECT_NEAR(part[0] + part[1] + part[2], 1, 1e-12);
        EXPECT_LT(length(carried(made, at_nodes, p) - points[p]), 2e-3f) << p;   // m
      }
      points = at_nodes;
      ranks = rank_of_nodes;
      surface = made.surface;
    }
  }
}

// Of each point of a grid.
std::vector<Vec2> uvs_of(const Mesh& mesh) {
  std::vector<Vec2> uvs(mesh.points.size());
  for (std::size_t v = 0; v < mesh.point_of.size(); ++v) uvs[mesh.point_of[v]] = mesh.render.uvs[v];
  return uvs;
}

double area_of(const cooking::IntrinsicSurface& surface) {
  double area = 0;
  for (const auto& flat : surface.flat) area += 0.5 * flat.corners[1].x() * flat.corners[2].y();
  return area;
}

TEST(Levels, nodes_of_a_grid_lie_where_its_threads_cross) {
  for (const Grid& grid : kLevelGrids)
    for (const bool held : {false, true}) {
      const Mesh mesh = make_grid(grid);
      cooking::IntrinsicSurface surface = cooking::surface_of(mesh);
      std::vector<Rank> ranks = cooking::ranks_of(mesh);
      std::vector<Vec2> uvs = uvs_of(mesh);
      for (std::size_t p = 0; held && p < ranks.size(); ++p)
        if (uvs[p].y < 1e-6f) ranks[p] = Rank::held;
      for (int level = 0; level < 2; ++level) {
        SCOPED_TRACE(testing::Message() << grid.cells_x << " x " << grid.cells_y << ", level " << level << (held ? ", held" : ""));
        const Coarse made = cooking::coarsen(surface, ranks, uvs, cooking::Nodes::along_threads);
        std::vector<Rank> rank_of_nodes;
        std::vector<Vec2> at_nodes;
        for (const std::uint32_t p : made.points) at_nodes.push_back(uvs[p]), rank_of_nodes.push_back(ranks[p]);
        std::set<long> columns, rows;
        for (const Vec2 uv : at_nodes) columns.insert(std::lround(1e4 * double(uv.x))), rows.insert(std::lround(1e4 * double(uv.y)));
        ASSERT_EQ(made.points.size(), columns.size() * rows.size());
        EXPECT_EQ(*columns.begin(), 0);
        EXPECT_EQ(*columns.rbegin(), 10000);
        EXPECT_EQ(*rows.begin(), 0);
        EXPECT_EQ(*rows.rbegin(), 10000);
        std::vector<int> along_threads(made.points.size());
        for (const auto& link : made.links)
          if (link.along > 1 - 1e-9 || link.along < 1e-9) ++along_threads[link.a], ++along_threads[link.b];
        for (std::size_t k = 0; k < at_nodes.size(); ++k) {
          const auto inner = [](float c) { return c > 1e-3f && c < 1 - 1e-3f; };
          EXPECT_EQ(along_threads[k], 2 + inner(at_nodes[k].x) + inner(at_nodes[k].y)) << at_nodes[k].x << ' ' << at_nodes[k].y;
        }
        // Links along both threads, and both diagonals of every rectangle.
        const std::size_t across = columns.size() - 1, up = rows.size() - 1;
        EXPECT_EQ(made.links.size(), across * rows.size() + up * columns.size() + 2 * across * up);
        EXPECT_NEAR(area_of(made.surface), double(grid.size.x) * double(grid.size.y), 1e-6);
        uvs = at_nodes;
        ranks = rank_of_nodes;
        surface = made.surface;
      }
    }
}

// Cells 2.6 times as long as the strip is wide, and long cells that hang by their long side.
TEST(Levels, narrow_strips_and_long_cells_have_levels) {
  for (const Grid& grid : {Grid{{1.3f, 0.05f}, 10, 1, Topology::diagonal, true}, Grid{{1.3f, 0.02f}, 26, 1, Topology::diagonal, true},
                           Grid{{1, 1}, 10, 40, Topology::diagonal, true}}) {
    const Mesh mesh = make_grid(grid);
    const std::vector<Vec2> uvs = uvs_of(mesh);
    std::vector<Rank> ranks = cooking::ranks_of(mesh);
    for (std::size_t p = 0; p < ranks.size(); ++p)
      if (uvs[p].x < 1e-6f) ranks[p] = Rank::held;
    const Coarse made = cooking::coarsen(cooking::surface_of(mesh), ranks, uvs, cooking::Nodes::along_threads);
    EXPECT_LT(2 * made.points.size(), mesh.points.size());
    EXPECT_GT(area_of(made.surface), 0.99 * double(grid.size.x) * double(grid.size.y));
  }
}

TEST(Levels, where_edges_follow_no_threads_no_crossings_are_chosen) {
  Mesh askew = make_grid({{1, 1}, 30, 30, Topology::diagonal, true});
  for (Vec2& uv : askew.render.uvs) uv = {0.9f * uv.x - 0.4f * uv.y, 0.4f * uv.x + 0.9f * uv.y};   // by 24 degrees
  const cooking::Crossings none = cooking::crossings_of(cooking::surface_of(askew), askew.points.size());
  EXPECT_EQ(std::ranges::count(none.is_woven, true), 0);
  EXPECT_EQ(std::ranges::count(none.is_on, true), 0);
  // Rows along the weft alone: equilateral triangles.
  Mesh rows = make_grid({{1, 0.8f}, 30, 30, Topology::diagonal, true});
  for (std::size_t v = 0; v < rows.render.uvs.size(); ++v) {
    Vec2& uv = rows.render.uvs[v];
    const float shift = 0.5f / 30 * static_cast<float>(std::lround(30 * uv.y));
    rows.points[rows.point_of[v]].x += shift, rows.render.positions[v].x += shift, uv.x += shift;
  }
  EXPECT_EQ(std::ranges::count(cooking::crossings_of(cooking::surface_of(rows), rows.points.size()).is_on, true), 0);
  const Mesh even = make_grid({{1, 1}, 30, 30, Topology::diagonal, true});
  const cooking::Crossings all = cooking::crossings_of(cooking::surface_of(even), even.points.size());
  EXPECT_EQ(std::ranges::count(all.is_woven, true), 961);
  EXPECT_EQ(std::ranges::count(all.is_on, true), 121);
}

TEST(Levels, on_a_curved_sheet_that_unrolls_they_measure_along_it) {
  Mesh mesh = make_grid({{1, 1}, 48, 40, Topology::diagonal, true});
  const std::vector<Vec3> flat = mesh.points;
  const float radius = 0.2f;   // wound up to 5 radians
  for (Vec3& p : mesh.points) p = {radius * std::cos(p.x / radius), p.y, radius * std::sin(p.x / radius)};
  const Coarse made = coarse(mesh);
  std::vector<Vec3> at_nodes;
  for (const std::uint32_t p : made.points) at_nodes.push_back(flat[p]);
  for (const auto& link : made.links)
    EXPECT_NEAR(link.rest, length(at_nodes[link.a] - at_nodes[link.b]), 4e-3 * link.rest);
  for (std::size_t p = 0; p < flat.size(); ++p) EXPECT_LT(length(carried(made, at_nodes, p) - flat[p]), 2e-3f);
}

TEST(Levels, nothing_reaches_from_piece_to_piece_or_across_a_slit) {
  // Two pieces, 0.1 m apart.
  const Mesh pieces = cut_out({{2, 1}, 60, 30, Topology::diagonal, true}, [](Vec3 m) { return std::abs(m.x) > 0.05f; });
  const Coarse apart = coarse(pieces);
  const auto side = [&](std::uint32_t node) { return pieces.points[apart.points[node]].x > 0; };
  for (const auto& link : apart.links) EXPECT_EQ(side(link.a), side(link.b));
  for (std::size_t p = 0; p < pieces.points.size(); ++p)
    for (int k = 0; k < 3; ++k)
      if (apart.shares[p].part[k] != 0) { EXPECT_EQ(side(apart.shares[p].node[k]), pieces.points[p].x > 0); }
  // A slit of a cell's width, from the middle upwards: around its end it is far from side to side.
  const Mesh slit =
      cut_out({{1, 1}, 40, 40, Topology::diagonal, true}, [](Vec3 m) { return m.y < 0 || m.x < 0 || m.x > 0.025f; });
  const Coarse around = coarse(slit);
  for (const auto& link : around.links) {
    const Vec3 a = slit.points[around.points[link.a]], b = slit.points[around.points[link.b]];
    if ((a.x > 0.01f) == (b.x > 0.01f) || std::min(a.y, b.y) < 0.05f) continue;
    EXPECT_GT(link.rest, 0.99 * (length(a - Vec3{0, 0, 0}) + length(b - Vec3{0.025f, 0, 0}))) << a.y << ' ' << b.y;
  }
}

TEST(Levels, what_is_held_is_held_at_every_level) {
  Scene scene = without_contacts();
  scene.solver.method = Method::strands;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 60, 60, Topology::diagonal, true};
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  const CookedFabric fabric = cooked(scene);
  const LevelLists& lists = fabric.own.of<LevelLists>();
  ASSERT_GE(lists.ends.size(), 2u);
  for (std::uint32_t level = 0, first = 0; level < lists.ends.size(); first = lists.ends[level++]) {
    int held = 0;
    for (std::uint32_t k = first; k < lists.ends[level]; ++k) {
      const gpu::LevelNode node = gpu::unpack_level_node(lists.nodes[k]);
      if (node.inverse_mass > 0) continue;
      ++held;
      // Of one point alone, which is held on the finer level.
      ASSERT_EQ(gpu::unpack_level_node(lists.nodes[k + 1]).first_gather, node.first_gather + 1);
      const std::uint32_t point = lists.gathers[node.first_gather].x;
      EXPECT_EQ(level + 1 == lists.ends.size() ? fabric.positions[point].w : gpu::unpack_level_node(lists.nodes[point]).inverse_mass, 0);
    }
    EXPECT_EQ(held, 2);
  }
}

TEST(Levels, a_free_cloth_weighs_the_same_at_every_level) {
  for (const Grid& grid : kLevelGrids) {
    Scene scene = without_contacts();
    scene.solver.method = Method::strands;
    scene.cloths.emplace_back().grid = grid;
    const CookedFabric fabric = cooked(scene);
    double mass = 0;
    for (const gpu::vec4& p : fabric.positions) mass += 1 / double(p.w);
    const LevelLists& lists = fabric.own.of<LevelLists>();
    ASSERT_GE(lists.ends.size(), 2u);
    for (std::uint32_t level = 0, first = 0; level < lists.ends.size(); first = lists.ends[level++]) {
      double of_level = 0;
      for (std::uint32_t k = first; k < lists.ends[level]; ++k) of_level += 1 / double(gpu::unpack_level_node(lists.nodes[k]).inverse_mass);
      EXPECT_NEAR(of_level, mass, 1e-5 * mass);
    }
  }
}

TEST(Levels, an_even_strain_costs_as_much_energy_as_without_them) {
  const auto energy = [](bool levels, double shear, double along_x, double along_y) {
    Scene scene = without_contacts();
    scene.solver.method = Method::jacobi;
    scene.solver.levels = levels;
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 1}, 60, 60, Topology::diagonal, true};
    cloth.fabric.stretch = 1000;
    cloth.fabric.shear = shear;
    const CookedFabric fabric = cooked(scene);
    const auto of_link = [&](Vec3 a, Vec3 b, double rest, double compliance) {
      const double length = std::hypot((1 + along_x) * (a.x - b.x), (1 + along_y) * (a.y - b.y));
      return 0.5 * (length - rest) * (length - rest) / compliance;
    };
    double sum = 0;
    for (const StretchLink& link : fabric.links)
      sum += of_link(particle(fabric, link.a), particle(fabric, link.b), link.rest, link.own_compliance());
    const LevelLists& lists = fabric.own.of<LevelLists>();
    const std::vector<Vec3> at = middles(fabric);
    for (std::uint32_t k = 0; k < at.size(); ++k) {
      const gpu::LevelNode node = gpu::unpack_level_node(lists.nodes[k]);
      for (std::uint32_t l = node.first_link; l < node.first_link + node.links; ++l) {
        const gpu::LevelLink link = gpu::unpack_level_link(lists.links[l]);
        sum += of_link(at[k], at[link.other], link.rest, link.compliance) / 2;
      }
    }
    return sum;
  };
  for (const double shear : {1000.0, 30.0})
    for (const auto& [along_x, along_y] : {std::pair(0.02, 0.0), std::pair(0.0, 0.02)}) {
      const double without = energy(false, shear, along_x, along_y), with = energy(true, shear, along_x, along_y);
      EXPECT_NEAR(with, without, 0.1 * without) << shear << " N/m, " << along_x << ' ' << along_y;
    }
}

// The rest lengths of links, over what their middles are apart in the cloth laid flat.
void expect_links_as_long_as_middles_are_apart(const Mesh& mesh, const std::vector<Vec3>& flat, double within) {
  Scene scene = without_contacts();
  scene.solver.method = Method::strands;
  scene.cloths.emplace_back().mesh = "given";
  CookedFabric fabric = must(cook(scene, {&mesh, 1}));
  const LevelLists& lists = fabric.own.of<LevelLists>();
  ASSERT_GE(lists.ends.size(), 1u);
  const std::vector<std::uint32_t> order = cooking::locality_order(mesh);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const Vec3 place = flat[order[i]];
    fabric.positions[i] = {place.x, place.y, place.z, fabric.positions[i].w};
  }
  const std::vector<Vec3> at = middles(fabric);
  for (std::uint32_t k = 0; k < at.size(); ++k) {
    const gpu::LevelNode node = gpu::unpack_level_node(lists.nodes[k]);
    for (std::uint32_t l = node.first_link; l < node.first_link + node.links; ++l) {
      const gpu::LevelLink link = gpu::unpack_level_link(lists.links[l]);
      EXPECT_NEAR(link.rest, length(at[k] - at[link.other]), within * link.rest) << "node " << k << " of " << at.size();
    }
  }
}

TEST(Levels, links_are_as_long_as_middles_are_apart_in_flat_cloth_and_in_cloth_that_unrolls) {
  for (const std::span<const Grid> grids : {std::span<const Grid>(kLevelGrids), std::span<const Grid>(kStrips)})
   for (const Grid& grid : grids) {
    const Mesh mesh = make_grid(grid);
    expect_links_as_long_as_middles_are_apart(mesh, mesh.points, 2e-3);
  }
  Mesh rolled = make_grid({{1, 1}, 48, 40, Topology::diagonal, true});
  const std::vector<Vec3> flat = rolled.points;
  const float radius = 0.2f;
  for (Vec3& p : rolled.points) p = {radius * std::cos(p.x / radius), p.y, radius * std::sin(p.x / radius)};
  expect_links_as_long_as_middles_are_apart(rolled, flat, 1e-2);
}

TEST(Levels, only_scenes_that_call_for_them_have_them) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{};
  scene.solver.method = Method::strands;
  const auto has = [&] { return effect(EffectId::level).called_for(scene, cooked(scene)); };
  EXPECT_TRUE(has());
  scene.solver.levels = false;
  EXPECT_FALSE(has());
  scene.solver.levels = {};
  for (const Method method : {Method::jacobi, Method::gauss_seidel}) {
    scene.solver.method = method;
    EXPECT_FALSE(has());
    scene.solver.levels = true;
    EXPECT_TRUE(has());
    scene.solver.levels = {};
  }
  scene.solver.method = Method::strands;
  scene.cloths[0].grid = Grid{{1, 1}, 1, 1};
  EXPECT_FALSE(has()) << "four particles";
}

}  // namespace
}  // namespace weft
