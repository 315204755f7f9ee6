// Files that are written: complete, readable by others, or not there at all.
#include "engine/export.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;

TEST(Export, a_glb_loads_back_as_the_same_mesh) {
  Grid grid;
  grid.cells_x = 5;
  grid.cells_y = 3;
  grid.topology = Topology::centre;
  const Mesh mesh = make_grid(grid);
  const Folder folder;
  const Result<void> written = write_glb(folder / "out.glb", mesh.render);
  ASSERT_TRUE(written) << written.error();
  const Result<Mesh> back = load_mesh(folder / "out.glb");
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->render.positions, mesh.render.positions);
  EXPECT_EQ(back->render.normals, mesh.render.normals);
  EXPECT_EQ(back->render.triangles, mesh.render.triangles);
  EXPECT_EQ(back->render.uvs, mesh.render.uvs);
  EXPECT_TRUE(back->mended.empty());
}

// Text is written in pieces: of so many vertices, more than one of each kind of line.
TEST(Export, a_large_obj_loads_back_as_the_same_bits) {
  Grid grid;
  grid.cells_x = grid.cells_y = 70;
  Mesh mesh = make_grid(grid);
  for (std::size_t v = 0; v < mesh.render.positions.size(); ++v) {
    const float angle = static_cast<float>(v);
    mesh.render.positions[v] = mesh.render.positions[v] + Vec3{0.001f * std::sin(angle), std::cos(angle), 0};
    mesh.render.normals[v] = {std::sin(angle), 0, std::cos(angle)};
  }
  const Folder folder;
  const RenderMesh& render = mesh.render;
  ASSERT_TRUE(write_obj(folder / "out.obj", render.positions, render.normals, render.uvs, render.triangles));
  EXPECT_GT(test::slurp(folder / "out.obj").size(), 600'000u);
  const Result<Mesh> back = load_mesh(folder / "out.obj");
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->render.positions, render.positions);
  EXPECT_EQ(back->render.triangles, render.triangles);
}

TEST(Export, a_glb_states_the_bounds_of_its_positions) {
  const Folder folder;
  ASSERT_TRUE(write_glb(folder / "out.glb", make_grid({}).render));
  const std::string bytes = test::slurp(folder / "out.glb");
  std::uint32_t size = 0, text = 0;
  std::memcpy(&size, bytes.data() + 8, 4);
  std::memcpy(&text, bytes.data() + 12, 4);
  EXPECT_EQ(size, bytes.size());
  EXPECT_EQ(text % 4, 0u);
  const auto json = nlohmann::json::parse(bytes.substr(20, text));
  EXPECT_EQ(json["accessors"][0]["min"], (nlohmann::json{-0.5, 0.0, -0.5}));
  EXPECT_EQ(json["accessors"][0]["max"], (nlohmann::json{0.5, 0.0, 0.5}));
}

TEST(Export, a_ply_has_exactly_the_bytes_its_header_promises) {
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, normals(3, Vec3{0, 0, 1});
  const std::vector<float> strain{0, 0.25f, -0.5f};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const Folder folder;
  ASSERT_TRUE(write_ply(folder / "out.ply", positions, normals, strain, triangles));
  const std::string bytes = test::slurp(folder / "out.ply"), end = "end_header\n";
  EXPECT_TRUE(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_NE(bytes.find("element vertex 3\n"), std::string::npos);
  const std::size_t body = bytes.find(end) + end.size();
  ASSERT_EQ(bytes.size() - body, 3 * 28 + 13u);
  float second[7];
  std::memcpy(second, bytes.data() + body + 28, sizeof second);
  EXPECT_EQ(second[0], 1);
  EXPECT_EQ(second[5], 1);
  EXPECT_EQ(second[6], 0.25f);
}

TEST(Export, what_is_not_given_is_left_out_of_a_ply) {
  const Folder folder;
  ASSERT_TRUE(write_ply(folder / "out.ply", std::vector<Vec3>(2), {}, {}, {}));
  const std::string bytes = test::slurp(folder / "out.ply");
  EXPECT_EQ(bytes.find("nx"), std::string::npos);
  EXPECT_EQ(bytes.find("float strain"), std::string::npos);
}

TEST(Export, lists_that_do_not_fit_together_are_refused) {
  const Folder folder;
  const std::vector<Vec3> three(3), two(2);
  const Result<void> normals = write_ply(folder / "out.ply", three, two, {}, {});
  ASSERT_FALSE(normals);
  EXPECT_NE(normals.error().find("2 normals for 3 vertices"), std::string::npos) << normals.error();
  EXPECT_FALSE(write_ply(folder / "out.ply", three, {}, std::vector<float>(4), {}));
  EXPECT_FALSE(write_ply(folder / "out.ply", three, {}, {}, std::vector<Triangle>{{0, 1, 3}}));
  EXPECT_FALSE(write_glb(folder / "out.glb", {}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.ply"));
}

TEST(Export, a_place_that_cannot_be_written_is_a_sentence_and_leaves_nothing) {
  const Folder folder;
  const RenderMesh mesh = make_grid({}).render;
  EXPECT_FALSE(write_glb(folder / "missing/out.glb", mesh));
  std::filesystem::create_directory(folder / "taken.glb");
  const Result<void> taken = write_glb(folder / "taken.glb", mesh);
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().find("is a folder"), std::string::npos) << taken.error();
}

}   // namespace
}   // namespace weft
