// Which cloths hold a gas, and what is said of the others.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/effects/pressure/pressure.h"
#include "shaders/pressure/pressure.ref.h"
#include "tests/support/closed.h"

namespace weft {
namespace {

std::string refusal_of(const Mesh& mesh, const Gas& gas = {}) {
  const auto fabric = cook(gas_scene(gas), std::vector{mesh});
  return fabric ? "" : fabric.error();
}

// As a program would make it: what load_mesh would mend is not mended.
Mesh with_triangles(Mesh mesh, std::vector<Triangle> triangles) {
  mesh.render.triangles = mesh.triangles = std::move(triangles);
  std::uint32_t ignored = 0;
  mesh.edges = winged_edges(mesh.triangles, &ignored);
  return mesh;
}

TEST(PressureRefusals, a_mesh_with_a_hole_names_how_many_edges_are_open) {
  Mesh mesh = ball(0.2, 1);
  EXPECT_EQ(refusal_of(mesh), "");
  std::vector<Triangle> triangles = mesh.triangles;
  triangles.pop_back();
  EXPECT_EQ(refusal_of(with_triangles(mesh, triangles)),
            "cloths[0]: pressure: the mesh is not closed and would not hold a gas: it has a triangle on one side only at 3 edges of 48");
}

TEST(PressureRefusals, a_mesh_with_a_third_triangle_at_an_edge_has_no_inside) {
  Mesh mesh = ball(0.2, 0);
  std::vector<Triangle> triangles = mesh.triangles;
  triangles.insert(triangles.end(), {{0, 2, 1}, {1, 3, 0}, {0, 1, 2}, {0, 3, 1}});   // walls across, with both sides
  const std::string what = refusal_of(with_triangles(mesh, triangles));
  EXPECT_NE(what.find("three triangles or more meet at 5 edges of 13"), std::string::npos) << what;
}

TEST(PressureRefusals, triangles_that_are_not_wound_alike_are_counted_by_their_edges) {
  Mesh mesh = ball(0.2, 1);
  std::vector<Triangle> triangles = mesh.triangles;
  std::swap(triangles[5][0], triangles[5][1]);
  const std::string what = refusal_of(with_triangles(mesh, triangles));
  EXPECT_NE(what.find("not wound alike, so that it has no inside: they run the same way at 3 edges of 48"), std::string::npos) << what;
}

TEST(PressureRefusals, a_mesh_inside_out_or_flat_says_so) {
  Mesh mesh = ball(1, 3);
  std::vector<Triangle> triangles = mesh.triangles;
  for (Triangle& t : triangles) std::swap(t[0], t[1]);
  const std::string inside_out = refusal_of(with_triangles(mesh, triangles));
  EXPECT_NE(inside_out.find("the mesh is inside out: its triangles face inwards, about 4.0"), std::string::npos) << inside_out;
  for (Vec3& p : mesh.points) p.y = 0;
  for (Vec3& p : mesh.render.positions) p.y = 0;
  const std::string flat = refusal_of(mesh);
  EXPECT_NE(flat.find("there is no room for a gas in it"), std::string::npos) << flat;
}

TEST(PressureRefusals, a_grid_and_numbers_out_of_their_limits_are_refused_by_their_paths) {
  const auto said = [](const Gas& gas) {
    const auto good = check(gas_scene(gas));
    return good ? std::string() : good.error();
  };
  EXPECT_EQ(said({}), "");
  EXPECT_NE(said({.rest_pressure = -1}).find("cloths[0].pressure.rest_pressure: -1 is less than 0"), std::string::npos);
  EXPECT_NE(said({.rest_pressure = NAN}).find("cloths[0].pressure.rest_pressure"), std::string::npos);
  EXPECT_NE(said({.rest_pressure = 2e7}).find("is more than 10000000"), std::string::npos);
  EXPECT_NE(said({.ambient = INFINITY}).find("cloths[0].pressure.ambient"), std::string::npos);
  EXPECT_NE(said({.volume = 0}).find("cloths[0].pressure.volume"), std::string::npos);
  const auto grid = parse_scene(R"({"cloths": [{"grid": {}, "pressure": {"rest_pressure": 10}}]})", ".");
  ASSERT_FALSE(grid);
  EXPECT_NE(grid.error().find("cloths[0].pressure: a grid is open and holds no gas: give the cloth a closed mesh"), std::string::npos)
      << grid.error();
}

// The gradients gathered round the rings are those of the triangles; with a point in which two bodies only touch, too.
TEST(PressureRings, go_round_every_particle_once_in_the_winding_order) {
  Mesh two = ball(0.2, 1);
  std::vector<Triangle> triangles = two.triangles;
  RenderMesh render = two.render;
  const auto other = ball(0.1, 1, {0.3f, 0, 0});   // touches the first in (0.2, 0, 0)
  const auto first = static_cast<std::uint32_t>(render.positions.size());
  render.positions.insert(render.positions.end(), other.render.positions.begin(), other.render.positions.end());
  for (const auto& [a, b, c] : other.render.triangles) render.triangles.push_back({a + first, b + first, c + first});
  render.normals = {}, render.tangents = {}, render.uvs = {};
  const Mesh mesh = must(weld_mesh(render));
  ASSERT_EQ(mesh.points.size(), two.points.size() + other.points.size() - 1);
  const auto fabric = must(cook(gas_scene(), std::vector{mesh}));
  const auto& lists = std::as_const(fabric).own.of<GasLists>();
  ASSERT_EQ(lists.rows.size(), fabric.positions.size());
  reference::Points x;
  for (const gpu::vec4& p : fabric.positions) x.push_back({p.x, p.y, p.z});
  const auto gradients = reference::volume_gradients(fabric.triangles, x);
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    reference::Vector gathered = reference::Vector::Zero(), before = gathered;
    for (std::uint32_t k = lists.rows[i].x; k < lists.rows[i].x + lists.rows[i].y; ++k)
      for (const std::uint32_t j : {lists.rings[k].x, lists.rings[k].y, lists.rings[k].z, lists.rings[k].w}) {
        gathered += before.cross(x[j] - x[i]) / 6;
        before = x[j] - x[i];
      }
    EXPECT_LT((gathered - gradients[i]).norm(), 1e-12) << i;
    sum += gathered.dot(x[i] - x[0]) / 3;
  }
  EXPECT_NEAR(sum, reference::volume(fabric.triangles, x), 1e-12);
  EXPECT_NEAR(sum, lists.gases[0].volume, 1e-8);
}

TEST(PressureParts, cover_all_particles_of_all_cloths_once) {
  Scene scene = gas_scene();
  for (int k = 0; k < 3; ++k) scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].pressure.reset();
  const auto fabric = must(cook(scene, std::vector{ball(0.1, 4), ball(0.1, 2), ball(0.2, 0), ball(0.3, 3)}));
  const auto& lists = std::as_const(fabric).own.of<GasLists>();
  ASSERT_EQ(lists.gases.size(), 3u);
  std::vector<int> seen(fabric.positions.size());
  std::uint32_t row = 0, part = 0;
  for (std::uint32_t k = 0; k < lists.gases.size(); ++k) {
    const gpu::Gas& gas = lists.gases[k];
    EXPECT_EQ(gas.first_part, part);
    EXPECT_EQ(gas.particle, fabric.cloths[gas.cloth].first_particle);
    for (; part < gas.first_part + gas.parts; ++part) {
      EXPECT_EQ(lists.parts[part].gas, k);
      EXPECT_EQ(lists.parts[part].first, row);
      for (std::uint32_t i = 0; i < lists.parts[part].count; ++i, ++row) ++seen[lists.parts[part].particle + i];
    }
  }
  EXPECT_EQ(part, lists.parts.size());
  for (std::uint32_t i = 0; i < seen.size(); ++i) {
    const bool without = i - fabric.cloths[1].first_particle < fabric.cloths[1].particles;
    EXPECT_EQ(seen[i], without ? 0 : 1) << i;
  }
}

}  // namespace
}  // namespace weft
