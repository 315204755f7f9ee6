// What the formats allow: kinds of indices and primitives, node transforms, missing attributes, and files from elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/mesh.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};   // anticlockwise seen from +z

/// The direction a mesh's triangles face, if they all face the same; what winding and transforms come down to.
Vec3 facing(const Mesh& mesh) {
  Vec3 sum;
  for (const Triangle& t : mesh.triangles) sum = sum + cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
  return 1 / length(sum) * sum;
}

void expect_near(Vec3 found, Vec3 wanted) { EXPECT_LT(length(found - wanted), 1e-5f) << found.x << " " << found.y << " " << found.z; }

Result<Mesh> load_written(Gltf& gltf) {
  const Folder folder;
  return load_mesh(gltf.write(folder));
}

TEST(MeshLoad, indices_of_8_16_and_32_bits_give_the_same_mesh) {
  for (const int bits : {8, 16, 32}) {
    Gltf gltf;
    const std::size_t position = gltf.vec3(kSquare);
    const std::size_t indices = bits == 8    ? gltf.indices8({0, 1, 2, 0, 2, 3})
                                : bits == 16 ? gltf.indices16({0, 1, 2, 0, 2, 3})
                                             : gltf.indices32({0, 1, 2, 0, 2, 3});
    gltf.primitive(position)["indices"] = indices;
    const Result<Mesh> mesh = load_written(gltf);
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_EQ(mesh->render.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}})) << bits;
    EXPECT_EQ(mesh->points.size(), 4u);
    EXPECT_TRUE(mesh->mended.empty());
    expect_near(facing(*mesh), {0, 0, 1});
  }
}

TEST(MeshLoad, a_primitive_without_indices_is_welded_and_joined) {
  Gltf gltf;
  gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}));
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 4u);
  EXPECT_EQ(mesh->edges.size(), 5u);
}

TEST(MeshLoad, strips_and_fans_are_unrolled_with_their_winding) {
  for (const int mode : {5, 6}) {
    Gltf gltf;
    gltf.primitive(gltf.vec3(mode == 5 ? std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}
                                       : std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0}),
                   mode);
    const Result<Mesh> mesh = load_written(gltf);
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_EQ(mesh->triangles.size(), 3u);
    EXPECT_TRUE(mesh->mended.empty()) << mesh->mended[0];
    expect_near(facing(*mesh), {0, 0, 1});
  }
}

TEST(MeshLoad, points_and_lines_are_left_out_and_counted) {
  Gltf gltf;
  const std::size_t position = gltf.vec3(kSquare), indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  gltf.primitive(position)["indices"] = indices;
  gltf.primitive(position, 0);
  gltf.primitive(position, 1);
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->mended, (std::vector<std::string>{"4 points were left out", "2 lines were left out"}));
  EXPECT_EQ(mesh->render.positions.size(), 4u);
}

TEST(MeshLoad, several_primitives_become_one_cloth_sewn_where_they_touch) {
  Gltf gltf;
  const std::size_t left = gltf.vec3(kSquare), right = gltf.vec3({1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0});
  const std::size_t uvs = gltf.vec2({0, 1, 1, 1, 1, 0, 0, 0}), indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  gltf.primitive(left)["indices"] = indices;
  auto& second = gltf.primitive(right);
  second["indices"] = indices;
  second["attributes"]["TEXCOORD_0"] = uvs;
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 8u);
  EXPECT_EQ(mesh->points.size(), 6u);
  EXPECT_EQ(mesh->edges.size(), 9u);
  EXPECT_EQ(mesh->render.uvs[4], (Vec2{0, 1}));      // its own, as the file has it
  EXPECT_EQ(mesh->render.uvs[2], (Vec2{0.5f, 0}));   // projected: 2 m wide, 1 m high
}

TEST(MeshLoad, a_file_s_own_normals_and_tangents_are_kept) {
  Gltf gltf;
  const std::size_t position = gltf.vec3(kSquare), indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  const std::size_t normal = gltf.vec3({0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0, 0});   // the last one is missing
  const std::size_t tangent = gltf.vec4({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}), uvs = gltf.vec2({0, 1, 1, 1, 1, 0, 0, 0});
  auto& primitive = gltf.primitive(position);
  primitive["indices"] = indices;
  primitive["attributes"]["NORMAL"] = normal;
  primitive["attributes"]["TANGENT"] = tangent;
  primitive["attributes"]["TEXCOORD_0"] = uvs;
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  expect_near(mesh->render.normals[0], {0, 0.6f, 0.8f});
  expect_near(mesh->render.normals[3], {0, 0, 1});
  EXPECT_EQ(mesh->render.tangents[0], (Vec4{1, 0, 0, -1}));
  EXPECT_EQ(mesh->mended, (std::vector<std::string>{"1 normal was not finite or had no direction; made anew"}));
}

TEST(MeshLoad, node_transforms_multiply_down_the_tree) {
  Gltf gltf;
  const std::size_t position = gltf.vec3(kSquare), indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  gltf.primitive(position)["indices"] = indices;
  gltf.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}},
                        {{"mesh", 0}, {"rotation", {0, 0.70710678, 0, 0.70710678}}}};   // a quarter turn about +y: +z goes to +x, +x to -z
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  expect_near(mesh->points[1], {10, 0, -2});
  expect_near(mesh->points[3], {10, 2, 0});
  expect_near(facing(*mesh), {1, 0, 0});
  expect_near(mesh->render.normals[0], {1, 0, 0});
}

TEST(MeshLoad, a_rotation_turns_and_does_not_scale_whatever_the_length_of_its_quaternion) {
  Gltf gltf;
  gltf.primitive(gltf.vec3({1, 0, 0, 1, 1, 0, 2, 0, 0}));
  gltf.json["nodes"][0]["rotation"] = {0, 3, 0, 3};
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  expect_near(mesh->points[1], {0, 1, -1});
  expect_near(mesh->points[2], {0, 0, -2});
}

TEST(MeshLoad, a_mirroring_node_turns_the_winding_so_that_normals_still_agree) {
  Gltf gltf;
  const std::size_t position = gltf.vec3(kSquare), normal = gltf.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const std::size_t indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  auto& primitive = gltf.primitive(position);
  primitive["indices"] = indices;
  primitive["attributes"]["NORMAL"] = normal;
  for (const auto& [scale, out] : {std::pair{Vec3{-1, 1, 1}, Vec3{0, 0, 1}},
                                   {Vec3{1, 1, -3}, Vec3{0, 0, -1}},
                                   {Vec3{-1, -2, -1}, Vec3{0, 0, -1}},
                                   {Vec3{-1, -1, 1}, Vec3{0, 0, 1}}}) {
    gltf.json["nodes"][0]["scale"] = {scale.x, scale.y, scale.z};
    const Result<Mesh> mesh = load_written(gltf);
    ASSERT_TRUE(mesh) << mesh.error();
    expect_near(facing(*mesh), out);
    expect_near(mesh->render.normals[0], out);
    EXPECT_TRUE(mesh->mended.empty());
  }
}

TEST(MeshLoad, a_sheared_node_keeps_normals_at_right_angles_to_the_surface) {
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 1}), normal = gltf.vec3({0, -1, 1, 0, -1, 1, 0, -1, 1});
  gltf.primitive(position)["attributes"]["NORMAL"] = normal;
  gltf.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0.5, 3, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};   // column by column
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  expect_near(mesh->points[2], {4.5f, 8, 7});
  expect_near(mesh->render.normals[0], facing(*mesh));
}

TEST(MeshLoad, a_mesh_shown_by_two_nodes_is_there_twice) {
  Gltf gltf;
  gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->points.size(), 6u);
}

TEST(MeshLoad, a_skinned_mesh_stands_where_the_file_stores_it_and_morph_targets_are_counted) {
  Gltf gltf;
  const std::size_t position = gltf.vec3(kSquare), indices = gltf.indices16({0, 1, 2, 0, 2, 3});
  auto& primitive = gltf.primitive(position);
  primitive["indices"] = indices;
  primitive["targets"] = {{{"POSITION", position}}, {{"POSITION", position}}};
  gltf.json["skins"] = {{{"joints", {0}}}};
  gltf.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                        {{"mesh", 0}, {"skin", 0}, {"scale", {-2, 3, 4}}, {"children", {2}}},
                        {{"mesh", 0}}};   // not skinned: below the first two as ever
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {10, 0, 0}, {8, 0, 0}, {8, 3, 0}, {10, 3, 0}}));
  EXPECT_EQ(mesh->mended,
            (std::vector<std::string>{"its skin was left out: \"JOINTS_0\" points to nothing of a list of 2",
                                      "4 morph targets were left out: the mesh has its base shape"}));
}

TEST(MeshLoad, ten_thousand_primitives_over_one_accessor_are_as_many_triangles_and_no_more_vertices) {
  Gltf gltf;
  std::vector<float> positions;
  std::vector<std::uint16_t> corners;
  for (int i = 0; i < 10002; ++i) {
    positions.insert(positions.end(), {static_cast<float>(i / 2), static_cast<float>(i % 2), 0});
    if (i >= 2)
      for (const int k : {i % 2 ? i - 1 : i - 2, i % 2 ? i - 2 : i - 1, i}) corners.push_back(static_cast<std::uint16_t>(k));
  }
  const std::size_t position = gltf.vec3(positions), all = gltf.indices16(corners);
  const nlohmann::json whole = gltf.json["accessors"][all];
  for (std::size_t t = 0; t < 10000; ++t) {
    gltf.json["accessors"].push_back(whole);
    gltf.json["accessors"].back()["byteOffset"] = 6 * t;
    gltf.json["accessors"].back()["count"] = 3;
    gltf.primitive(position)["indices"] = gltf.json["accessors"].size() - 1;
  }
  const Result<Mesh> mesh = load_written(gltf);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 10002u);
  EXPECT_EQ(mesh->triangles.size(), 10000u);
  EXPECT_TRUE(mesh->mended.empty()) << mesh->mended[0];
}

TEST(MeshLoad, materials_animations_and_unknown_extras_do_not_matter) {
  Gltf gltf;
  gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}))["material"] = 77;
  gltf.json["animations"] = {{{"channels", "none"}}};
  gltf.json["skins"] = 5;
  gltf.json["extensionsUsed"] = {"KHR_materials_sheen"};
  gltf.json["extensionsRequired"] = {"KHR_materials_sheen"};
  EXPECT_TRUE(load_written(gltf));
}

TEST(MeshLoad, an_obj_with_quads_and_without_normals_or_uvs_loads) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write(
      "two.OBJ",
      "mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nusemtl red\nf 1 2 3 4\nusemtl blue\nf -5 -2 -1 -4\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->points.size(), 6u);
  EXPECT_EQ(mesh->render.positions.size(), 6u);
  EXPECT_EQ(mesh->triangles.size(), 4u);
  expect_near(mesh->render.normals[0], {0, 0, 1});
}

TEST(MeshLoad, an_obj_s_lines_points_comments_and_continued_lines_are_understood) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(
      folder.write("a.obj", "v +0 0 0 # origin\r\nv 1 0 0\r\nv 0 \\\r\n 1e0 0\r\np 1 2\r\nl 1 2 3\r\ncurv 0 1 2\r\nf 1// 2/ \\\r\n 3"));
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh->mended, (std::vector<std::string>{"2 points were left out", "2 lines were left out"}));
}

TEST(MeshLoad, an_obj_s_v_is_turned_to_point_down) {
  const Folder folder;
  const Result<Mesh> mesh = load_mesh(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"));
  ASSERT_TRUE(mesh) << mesh.error();
  std::map<std::pair<float, float>, Vec2> uv_at;
  for (std::size_t v = 0; v < 3; ++v) uv_at[{mesh->render.positions[v].x, mesh->render.positions[v].y}] = mesh->render.uvs[v];
  EXPECT_EQ((uv_at[{0, 0}]), (Vec2{0, 1}));
  EXPECT_EQ((uv_at[{0, 1}]), (Vec2{0, 0}));
  EXPECT_EQ(mesh->render.tangents[0], (Vec4{1, 0, 0, 1}));
}

/// How many closed walks the boundary edges make up.
std::size_t boundary_loops(const Mesh& mesh) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (const WingedEdge& e : mesh.edges)
    if (e.triangle[1] == kNone) next[e.a] = e.b;
  std::size_t loops = 0;
  while (!next.empty()) {
    ++loops;
    for (auto at = next.begin(); at != next.end();) {
      const std::uint32_t to = at->second;
      next.erase(at);
      at = next.find(to);
    }
  }
  return loops;
}

TEST(MeshLoad, flamenco_s_cloth_becomes_a_tube_of_4160_points_with_two_rims) {
  const std::filesystem::path file = std::filesystem::path(WEFT_SOURCE_DIR) / "../shared/data/flamenco_cloth/CustomCloth.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Result<Mesh> mesh = load_mesh(file);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 4225u);   // 65 x 65: the seam's column is there twice
  EXPECT_EQ(mesh->points.size(), 4160u);             // 65 x 64
  EXPECT_EQ(mesh->triangles.size(), 8192u);
  EXPECT_EQ(mesh->points.size() + mesh->triangles.size(), mesh->edges.size());   // Euler characteristic 0: a tube
  EXPECT_EQ(std::ranges::count_if(mesh->edges, [](const WingedEdge& e) { return e.triangle[1] == kNone; }), 128);
  EXPECT_EQ(boundary_loops(*mesh), 2u);
  EXPECT_TRUE(mesh->mended.empty()) << mesh->mended[0];
}

TEST(MeshLoad, the_pbd_library_s_sheet_and_torus_load_without_a_seam) {
  const std::filesystem::path folder = std::filesystem::path(WEFT_SOURCE_DIR) / "../shared/data/pbd_models";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Result<Mesh> sheet = load_mesh(folder / "plane_30x30.obj"), torus = load_mesh(folder / "torus.obj");
  ASSERT_TRUE(sheet) << sheet.error();
  EXPECT_EQ(sheet->points.size(), 961u);
  EXPECT_EQ(boundary_loops(*sheet), 1u);
  ASSERT_TRUE(torus) << torus.error();
  EXPECT_EQ(torus->points.size(), 400u);
  EXPECT_EQ(boundary_loops(*torus), 0u);
  EXPECT_TRUE(sheet->mended.empty() && torus->mended.empty());
}

}   // namespace
}   // namespace weft
