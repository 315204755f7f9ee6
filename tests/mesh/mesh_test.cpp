// Grids, winged edges, normals and transforms: what every mesh is made of.
#include "engine/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

namespace weft {
namespace {

Grid grid_of(std::uint32_t x, std::uint32_t y, Topology topology, bool upright = false) {
  Grid grid;
  grid.cells_x = x;
  grid.cells_y = y;
  grid.topology = topology;
  grid.upright = upright;
  return grid;
}

/// Euler's formula for a disc fixes the number of edges, so nothing is counted by the code under test.
void expect_exact_counts(std::uint32_t x, std::uint32_t y) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const bool centre = topology == Topology::centre;
    const Mesh mesh = make_grid(grid_of(x, y, topology));
    const std::size_t cells = std::size_t{x} * y, vertices = (std::size_t{x} + 1) * (std::size_t{y} + 1) + (centre ? cells : 0);
    const std::size_t triangles = cells * (centre ? 4 : 2);
    ASSERT_EQ(mesh.points.size(), vertices) << x << " x " << y;
    ASSERT_EQ(mesh.render.positions.size(), vertices);
    ASSERT_EQ(mesh.render.normals.size(), vertices);
    ASSERT_EQ(mesh.render.tangents.size(), vertices);
    ASSERT_EQ(mesh.render.uvs.size(), vertices);
    ASSERT_EQ(mesh.point_of.size(), vertices);
    ASSERT_EQ(mesh.triangles.size(), triangles) << x << " x " << y;
    ASSERT_EQ(mesh.edges.size(), vertices + triangles - 1) << x << " x " << y;
    ASSERT_EQ(std::ranges::count_if(mesh.edges, [](const WingedEdge& e) { return e.triangle[1] == kNone; }), 2 * (std::ptrdiff_t{x} + y));
    ASSERT_FLOAT_EQ(mesh.points[0].x, -0.5f);
    ASSERT_FLOAT_EQ(mesh.points[x].x, 0.5f);
    ASSERT_FLOAT_EQ(mesh.points[(std::size_t{x} + 1) * y].z, 0.5f);   // the last row is there and ends exactly at the border
  }
}

TEST(Mesh, a_square_grid_has_exact_counts_for_every_size_to_64_and_for_large_ones) {
  for (std::uint32_t n = 1; n <= 64; ++n) expect_exact_counts(n, n);
  expect_exact_counts(200, 200);   // the size at which a grid built with a float step loses a row
  expect_exact_counts(1024, 1024);
}

TEST(Mesh, a_strip_has_exact_counts_for_every_length_to_1024) {
  for (std::uint32_t n = 1; n <= 1024; ++n) {
    expect_exact_counts(n, 2);
    expect_exact_counts(1, n);
  }
}

/// Every edge's record agrees with the triangles it names, and every triangle's three sides are recorded.
void expect_consistent_edges(const Mesh& mesh) {
  std::size_t sides = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const WingedEdge& edge : mesh.edges) {
    EXPECT_TRUE(seen.insert(std::minmax(edge.a, edge.b)).second);
    for (int side = 0; side < 2; ++side) {
      if (edge.triangle[side] == kNone) {
        EXPECT_EQ(side, 1);
        EXPECT_EQ(edge.across[side], kNone);
        continue;
      }
      Triangle wanted = side == 0 ? Triangle{edge.a, edge.b, edge.across[0]} : Triangle{edge.b, edge.a, edge.across[1]};
      Triangle found = mesh.triangles[edge.triangle[side]];
      for (Triangle* cycle : {&wanted, &found})   // the same cycle, whichever corner comes first
        std::rotate(cycle->begin(), std::ranges::min_element(*cycle), cycle->end());
      EXPECT_EQ(wanted, found);
      ++sides;
    }
  }
  EXPECT_EQ(sides, mesh.triangles.size() * 3);
}

TEST(Mesh, a_winged_edge_names_both_triangles_in_order) {
  expect_consistent_edges(make_grid(grid_of(5, 3, Topology::diagonal)));
  expect_consistent_edges(make_grid(grid_of(5, 3, Topology::centre, true)));
}

TEST(Mesh, edges_are_sorted_by_smaller_then_greater_point) {
  const Mesh mesh = make_grid(grid_of(7, 4, Topology::centre));
  EXPECT_TRUE(std::ranges::is_sorted(mesh.edges, {}, [](const WingedEdge& e) { return std::minmax({e.a, e.b}); }));
}

TEST(Mesh, an_edge_of_three_triangles_is_listed_once_and_counted) {
  const std::vector<Triangle> fin{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  std::uint32_t non_manifold = 0;
  const std::vector<WingedEdge> edges = winged_edges(fin, &non_manifold);
  EXPECT_EQ(non_manifold, 1u);
  EXPECT_EQ(edges.size(), 7u);
  EXPECT_EQ(edges[0].triangle, (std::array<std::uint32_t, 2>{0, 1}));
}

TEST(Mesh, two_triangles_that_run_the_same_way_along_an_edge_do_not_become_neighbours) {
  const std::vector<Triangle> clash{{0, 1, 2}, {0, 1, 3}};
  std::uint32_t non_manifold = 0;
  const std::vector<WingedEdge> edges = winged_edges(clash, &non_manifold);
  EXPECT_EQ(non_manifold, 1u);
  EXPECT_EQ(edges[0].triangle[1], kNone);
}

TEST(Mesh, no_triangle_has_no_edge) { EXPECT_TRUE(winged_edges({}, nullptr).empty()); }

TEST(Mesh, a_grid_faces_up_or_forward_and_its_normals_and_tangents_agree_with_its_geometry) {
  for (const bool upright : {false, true})
    for (const Topology topology : {Topology::diagonal, Topology::centre}) {
      const Mesh grid = make_grid(grid_of(3, 2, topology, upright));
      const Vec3 out = upright ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
      for (const Triangle& t : grid.triangles) {
        const Vec3 normal = cross(grid.points[t[1]] - grid.points[t[0]], grid.points[t[2]] - grid.points[t[0]]);
        EXPECT_GT(dot(normal, out), 0);
      }
      RenderMesh bare;
      bare.positions = grid.render.positions;
      bare.triangles = grid.render.triangles;
      bare.uvs = grid.render.uvs;
      const Result<Mesh> made = weld_mesh(bare);
      ASSERT_TRUE(made);
      EXPECT_TRUE(made->mended.empty());
      for (std::size_t v = 0; v < grid.points.size(); ++v) {
        EXPECT_EQ(grid.render.normals[v], out);
        EXPECT_NEAR(dot(made->render.normals[v], out), 1, 1e-6);   // float rounding
        EXPECT_NEAR(made->render.tangents[v].x, grid.render.tangents[v].x, 1e-6);
        EXPECT_EQ(made->render.tangents[v].w, grid.render.tangents[v].w);
      }
    }
}

TEST(Mesh, a_picture_on_a_grid_is_upright_and_not_mirrored) {
  const Mesh standing = make_grid(grid_of(4, 4, Topology::diagonal, true)), lying = make_grid(grid_of(4, 4, Topology::diagonal));
  EXPECT_EQ(standing.render.uvs[0], (Vec2{0, 1}));   // low corner of a standing cloth: lower left of the picture
  EXPECT_EQ(standing.render.uvs[24], (Vec2{1, 0}));
  EXPECT_EQ(lying.render.uvs[0], (Vec2{0, 0}));   // -x, -z: the far left corner for whoever stands at +z and looks down
  EXPECT_EQ(lying.render.uvs[24], (Vec2{1, 1}));
}

TEST(Mesh, a_transform_scales_then_rotates_then_translates) {
  Mesh mesh = make_grid(grid_of(1, 1, Topology::diagonal));
  const double tolerance = mesh.weld_tolerance;
  Transform transform;
  transform.scale = 2;
  transform.axis = {0, 0, 1};
  transform.degrees = 90;
  transform.translate = {0, 5, 0};
  transform_mesh(mesh, transform);
  EXPECT_NEAR(mesh.points[0].x, 0, 1e-6);   // (-0.5, 0, -0.5) -> (-1, 0, -1) -> (0, -1, -1) -> (0, 4, -1)
  EXPECT_NEAR(mesh.points[0].y, 4, 1e-6);
  EXPECT_NEAR(mesh.points[0].z, -1, 1e-6);
  EXPECT_EQ(mesh.render.positions[0], mesh.points[0]);
  EXPECT_NEAR(mesh.render.normals[0].x, -1, 1e-6);   // +y turns to -x
  EXPECT_NEAR(mesh.render.tangents[0].y, 1, 1e-6);
  EXPECT_EQ(mesh.render.tangents[0].w, 1);
  EXPECT_DOUBLE_EQ(mesh.weld_tolerance, 2 * tolerance);
}

TEST(Mesh, a_normal_does_not_depend_on_how_a_face_is_cut) {
  // A cube's corner 0 with one face cut into two triangles there, the others not: all three faces still weigh the same.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
  const std::vector<Triangle> faces{{0, 1, 4}, {0, 4, 2}, {0, 2, 3}, {0, 3, 1}};
  const Vec3 normal = smooth_normals(points, faces)[0];
  const float third = 1 / std::numbers::sqrt3_v<float>;
  EXPECT_NEAR(normal.x, third, 1e-6);
  EXPECT_NEAR(normal.y, third, 1e-6);
  EXPECT_NEAR(normal.z, third, 1e-6);
}

TEST(Mesh, a_vertex_without_a_face_gets_an_upward_normal) { EXPECT_EQ(smooth_normals(std::vector<Vec3>(1), {})[0], (Vec3{0, 1, 0})); }

}   // namespace
}   // namespace weft
