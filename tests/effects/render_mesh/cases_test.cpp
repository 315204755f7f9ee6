// A finer mesh that a coarse cloth carries, as a host sees it.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/effects/render_mesh/render_mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using RenderMeshCase = GpuTest;

// A sheet of 8 x 8 cells that carries one of 30 x 30, which stands 3 cm off it.
struct Carrying {
  Scene scene = sheet(8);
  std::vector<Mesh> meshes;
  Carrying() {
    meshes = must(make_meshes(scene));
    meshes.push_back(make_grid({{1, 1}, 30, 30, Topology::diagonal, false}));
    for (Vec3& p : meshes[1].points) p.y += 0.03f;
    for (Vec3& p : meshes[1].render.positions) p.y += 0.03f;
    scene.cloths[0].render_mesh = "of the host";
    scene.cloths[0].start.imperfection = 0;
  }
};

TEST_F(RenderMeshCase, at_rest_it_is_where_it_was_made) {
  for (const Vec3 off : {Vec3{}, Vec3{200, 0, -700}}) {
    Carrying carrying;
    for (Mesh& mesh : carrying.meshes) {
      for (Vec3& p : mesh.points) p = p + off;
      for (Vec3& p : mesh.render.positions) p = p + off;
    }
    const auto simulation = must(Simulation::create(device(), carrying.scene, carrying.meshes));
    const CarriedMesh& carried = simulation->fabric().render_meshes.at(0);
    EXPECT_EQ(carried.cloth, 0u);
    EXPECT_EQ(carried.first_vertex, 81u);
    EXPECT_EQ(simulation->positions().count, 81u + 31 * 31);
    const auto positions = must(simulation->read_vertex_positions()), normals = must(simulation->read_vertex_normals());
    ASSERT_EQ(positions.size(), simulation->positions().count);
    for (std::uint32_t v = 0; v < carried.vertices; ++v) {
      EXPECT_LT(length(positions[carried.first_vertex + v] - carrying.meshes[1].render.positions[v]), off == Vec3{} ? 1e-6f : 1e-4f);
      EXPECT_LT(length(normals[carried.first_vertex + v] - carrying.meshes[1].render.normals[v]), 1e-5f);
    }
  }
}

// Rolled onto a cylinder: the chords of its cells are 12 mm inside it, and what they carry is nearly round.
TEST_F(RenderMeshCase, the_cells_of_the_cloth_do_not_show) {
  Carrying carrying;
  const auto simulation = must(Simulation::create(device(), carrying.scene, carrying.meshes));
  const double radius = 0.3;
  auto positions = must(simulation->read_positions());
  for (gpu::vec4& p : positions) {
    const double angle = p.x / radius;
    p.x = static_cast<float>(radius * std::sin(angle));
    p.y = static_cast<float>(radius * std::cos(angle));
  }
  must(simulation->write_positions(positions));
  const CarriedMesh& carried = simulation->fabric().render_meshes[0];
  const auto drawn = must(simulation->read_vertex_positions()), normals = must(simulation->read_vertex_normals());
  const double chord = radius * std::cos(0.0625 / radius);
  ASSERT_LT(chord, radius - 0.006);
  for (std::uint32_t v = 0; v < carried.vertices; ++v) {
    const Vec3 rest = carrying.meshes[1].render.positions[v], x = drawn[carried.first_vertex + v], n = normals[carried.first_vertex + v];
    if (std::abs(rest.x) > 0.37f) continue;   // at the rim the normals of the last row are those of its only triangles
    EXPECT_NEAR(std::hypot(x.x, x.y), radius + 0.03, 0.0013);
    const double along = double(n.x) * x.x + double(n.y) * x.y;
    EXPECT_GT(along / std::hypot(x.x, x.y), 0.995);
  }
}

// What hangs, swings and turns carries it within the cloth: no vertex leaves its triangle's neighbourhood; the same bits each way, and
// twice.
TEST_F(RenderMeshCase, goes_where_the_cloth_goes_in_all_ways) {
  std::vector<std::vector<Vec3>> found;
  for (const Way way : kWays) {
    Carrying carrying;
    carrying.scene.cloths[0].anchors = {held_at({Corner::low_low, Corner::high_low})};
    const auto simulation = must(Simulation::create(device(), carrying.scene, carrying.meshes));
    for (int k = 0; k < 40; ++k) run_frame(device(), *simulation, way);
    found.push_back(must(simulation->read_vertex_positions()));
    const auto& lists = simulation->fabric().own.of<RenderMeshLists>();
    for (const gpu::Carried& bound : lists.carried)
      EXPECT_LT(length(found.back()[bound.vertex] - found.back()[bound.corners[0]]), 0.25f);
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

// The cloth itself does not notice.
TEST_F(RenderMeshCase, the_cloth_has_the_bits_that_it_has_without) {
  Carrying carrying;
  const auto with = must(Simulation::create(device(), carrying.scene, carrying.meshes));
  carrying.scene.cloths[0].render_mesh.clear();
  carrying.meshes.pop_back();
  const auto without = must(Simulation::create(device(), carrying.scene, carrying.meshes));
  run(*with, 0.5);
  run(*without, 0.5);
  EXPECT_EQ(hash_of(*with), hash_of(*without));
}

TEST_F(RenderMeshCase, what_is_wrong_is_a_sentence) {
  Carrying carrying;
  carrying.meshes[1].render.positions[5].x = NAN;
  const auto damaged = Simulation::create(device(), carrying.scene, carrying.meshes);
  ASSERT_FALSE(damaged);
  EXPECT_TRUE(damaged.error().starts_with("cloths[0]: its render mesh: ")) << damaged.error();
  carrying.meshes.pop_back();
  const auto missing = Simulation::create(device(), carrying.scene, carrying.meshes);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error(), "the scene has 1 cloths, 0 mesh colliders and 1 render meshes but 1 meshes were given");
  carrying.scene.cloths[0].render_mesh = "nowhere.glb";
  const auto nowhere = Simulation::create(device(), carrying.scene);
  ASSERT_FALSE(nowhere);
  EXPECT_TRUE(nowhere.error().starts_with("cloths[0].render_mesh: ")) << nowhere.error();
}

}  // namespace
}  // namespace weft
