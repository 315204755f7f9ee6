// A file's own vertices keep their numbers: for anchors, and in what is written back.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "engine/cook/parts.h"
#include "engine/export.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

constexpr int kColumns = 10, kRows = 8;

/// A metre wide and high, row by row.
std::vector<Vec3> sheet() {
  std::vector<Vec3> positions;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i)
      positions.push_back({static_cast<float>(i) / (kColumns - 1) - 0.5f, 0, static_cast<float>(j) / (kRows - 1) - 0.5f});
  return positions;
}

/// Corners of a quad each, counted from `first`; the last quad comes first, and begins with its last corner.
std::vector<std::array<std::uint32_t, 4>> quads(std::uint32_t first) {
  std::vector<std::array<std::uint32_t, 4>> list;
  for (int j = kRows - 1; j-- > 0;)
    for (int i = kColumns - 1; i-- > 0;) {
      const auto v = first + static_cast<std::uint32_t>(j * kColumns + i);
      list.push_back({v + kColumns + 1, v + 1, v, v + kColumns});
    }
  return list;
}

std::string v_lines(const std::vector<Vec3>& positions) {
  std::ostringstream text;
  text.precision(9);
  for (const Vec3 p : positions) text << "v " << p.x << " " << p.y << " " << p.z << "\n";
  return text.str();
}

/// Every vertex of the file lies where the file says, by its number.
void expect_numbered(const Mesh& mesh, const std::vector<Vec3>& positions) {
  ASSERT_EQ(mesh.point_of_source.size(), positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    ASSERT_LT(mesh.point_of_source[v], mesh.points.size()) << v;
    EXPECT_EQ(mesh.points[mesh.point_of_source[v]], positions[v]) << v;
  }
}

void expect_written_back_in_order(const Mesh& mesh, const std::vector<Vec3>& positions) {
  const Folder folder;
  ASSERT_TRUE(write_glb(folder / "back.glb", mesh.render));
  const Result<Mesh> back = load_mesh(folder / "back.glb");
  ASSERT_TRUE(back) << back.error();
  ASSERT_GE(back->render.positions.size(), positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) EXPECT_EQ(back->render.positions[v], positions[v]) << v;
  EXPECT_EQ(back->render.positions, mesh.render.positions);
  EXPECT_EQ(back->render.triangles, mesh.render.triangles);
}

std::vector<Vec3> anchored(const Mesh& mesh, std::vector<std::uint32_t> vertices) {
  Cloth cloth;
  cloth.anchors.resize(1);
  cloth.anchors[0].vertices = std::move(vertices);
  const auto choices = cooking::choose_anchors(cloth, mesh);
  EXPECT_TRUE(choices) << choices.error();
  std::vector<Vec3> places;
  for (const auto& choice : *choices) places.push_back(mesh.points[choice.point]);
  return places;
}

TEST(SourceVertices, of_an_obj_of_quads_are_its_v_lines) {
  std::string text = v_lines(sheet());
  for (const auto& q : quads(1)) {
    text += "f";
    for (const std::uint32_t v : q) text += " " + std::to_string(v);
    text += "\n";
  }
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write("sheet.obj", text));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(anchored(*mesh, {0, 79}), (std::vector<Vec3>{{-0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}}));
  EXPECT_EQ(mesh->render.positions, sheet());
  expect_numbered(*mesh, sheet());
  expect_written_back_in_order(*mesh, sheet());
}

TEST(SourceVertices, of_an_obj_with_seams_stay_and_copies_come_after_the_last) {
  std::string text = v_lines(sheet());
  // Every quad has its own corner of the picture and its own normals, as some programs write it.
  std::size_t corner = 0;
  for (const auto& q : quads(1)) {
    std::string face = "f";
    for (const std::uint32_t v : q) {
      text += "vt 0." + std::to_string(1000 + corner) + " 0.5\nvn 0 1 0.001\n";
      ++corner;
      face += " " + std::to_string(v) + "/" + std::to_string(corner) + "/" + std::to_string(corner);
    }
    text += face + "\n";
  }
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write("seams.obj", text));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), corner);   // each corner looks different
  EXPECT_EQ(mesh->points.size(), 80u);
  EXPECT_EQ(anchored(*mesh, {0, 79}), (std::vector<Vec3>{{-0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}}));
  expect_numbered(*mesh, sheet());
  expect_written_back_in_order(*mesh, sheet());
}

TEST(SourceVertices, of_an_obj_that_look_the_same_are_one_however_often_the_file_says_it) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write("same.obj",
                                                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 1 1\n"
                                                   "vn 0 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1/5/2 3/6/2 4/4/2\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 4u);
}

TEST(SourceVertices, that_no_triangle_has_keep_their_number_and_cannot_be_anchored) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(
      folder.write("unused.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 2 3 5\nf 5 4 6\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->point_of_source, (std::vector<std::uint32_t>{kNone, 0, 1, 1, 2, 3}));   // two lie at one place
  EXPECT_EQ(mesh->mended, (std::vector<std::string>{"1 vertex belonged to no triangle (or to dropped ones) and was dropped"}));
  EXPECT_EQ(mesh->loose, (std::vector<Vec3>{{9, 9, 9}}));
  EXPECT_EQ(anchored(*mesh, {5}), (std::vector<Vec3>{{1, 1, 0}}));
  Cloth cloth;
  cloth.anchors.resize(1);
  cloth.anchors[0].vertices = {0};
  const auto none = cooking::choose_anchors(cloth, *mesh);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "anchors[0]: vertex 0 belongs to no triangle, or to dropped ones, and is not simulated");
  cloth.anchors[0].vertices = {6};
  EXPECT_EQ(cooking::choose_anchors(cloth, *mesh).error(), "anchors[0]: vertex 6 is not below the mesh's 6 vertices");
}

TEST(SourceVertices, of_a_gltf_are_its_accessors_primitive_after_primitive_and_node_after_node) {
  std::vector<Vec3> positions = sheet();
  std::vector<float> numbers;
  for (const Vec3 p : positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
  std::vector<std::uint16_t> corners;
  for (const auto& q : quads(0))
    for (const int k : {2, 3, 0, 2, 0, 1}) corners.push_back(static_cast<std::uint16_t>(q[static_cast<std::size_t>(k)]));
  Gltf gltf;
  const std::size_t first = gltf.vec3(numbers), last = gltf.vec3({5, 0, 0, 7, 7, 7, 6, 0, 0, 5, 1, 0});
  const std::size_t indices = gltf.indices16(corners), three = gltf.indices16({3, 0, 2});
  gltf.primitive(first)["indices"] = indices;
  gltf.primitive(last)["indices"] = three;
  gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {0, 10, 0}}}};
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(gltf.write(folder));
  ASSERT_TRUE(mesh) << mesh.error();
  positions.insert(positions.end(), {{5, 0, 0}, {7, 7, 7}, {6, 0, 0}, {5, 1, 0}});
  ASSERT_EQ(mesh->point_of_source.size(), 2 * positions.size());
  for (std::size_t v = 0; v < 2 * positions.size(); ++v) {
    const std::size_t own = v % positions.size();
    if (own == 81)
      EXPECT_EQ(mesh->point_of_source[v], kNone);
    else
      EXPECT_EQ(mesh->points[mesh->point_of_source[v]], positions[own] + (own == v ? Vec3{} : Vec3{0, 10, 0})) << v;
  }
  EXPECT_EQ(anchored(*mesh, {0, 79, 167}), (std::vector<Vec3>{{-0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {5, 11, 0}}));
  expect_written_back_in_order(*mesh, sheet());
}

TEST(SourceVertices, of_primitives_that_share_their_accessors_are_there_once) {
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}), uvs = gltf.vec2({0, 0, 1, 0, 1, 1, 0, 1});
  const std::size_t low = gltf.indices16({0, 1, 2}), high = gltf.indices16({0, 2, 3});
  gltf.primitive(position)["indices"] = high;
  gltf.primitive(position)["indices"] = low;
  const Folder folder;
  Result<Mesh> mesh = load_mesh(gltf.write(folder));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->point_of_source, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_TRUE(mesh->mended.empty());
  gltf.json["meshes"][0]["primitives"][1]["attributes"]["TEXCOORD_0"] = uvs;   // they look different now
  mesh = load_mesh(gltf.write(folder));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->point_of_source, (std::vector<std::uint32_t>{0, kNone, 1, 2, 0, 3, 1, kNone}));
  EXPECT_EQ(mesh->loose, (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}}));
}

TEST(SourceVertices, of_a_primitive_without_indices_keep_their_numbers_when_they_are_joined) {
  Gltf gltf;
  gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}));
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(gltf.write(folder));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->point_of_source, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST(SourceVertices, of_a_grid_and_of_a_host_s_list_are_its_own) {
  Grid grid;
  grid.cells_x = 2;
  grid.cells_y = 1;
  EXPECT_EQ(make_grid(grid).point_of_source, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  RenderMesh render;
  render.positions = {{5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  render.triangles = {{1, 2, 3}};
  const Result<Mesh> mesh = weld_mesh(render);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->point_of_source, (std::vector<std::uint32_t>{kNone, 0, 1, 2}));
}

}   // namespace
}   // namespace weft
