// Damaged, foreign and hostile files: each ends in a sentence or in a mesh, never in a crash.
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "engine/export.h"
#include "engine/mesh.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

/// Loads and returns the sentence; a mesh that loads counts as a failure of the test.
std::string refusal(const std::filesystem::path& file) {
  const Result<Mesh> mesh = load_mesh(file);
  EXPECT_FALSE(mesh) << file;
  return mesh ? std::string() : mesh.error();
}

void expect_says(const std::string& sentence, const std::string& part) { EXPECT_NE(sentence.find(part), std::string::npos) << sentence; }

Gltf triangle() {
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}), indices = gltf.indices16({0, 1, 2});
  gltf.primitive(position)["indices"] = indices;
  return gltf;
}

TEST(MeshFaults, what_is_no_mesh_file_is_refused_by_name) {
  const Folder folder;
  expect_says(refusal(folder / "none.glb"), "none.glb does not exist");
  std::filesystem::create_directory(folder / "folder.glb");
  expect_says(refusal(folder / "folder.glb"), "is a folder");
  expect_says(refusal(folder.write("empty.obj", "")), "is empty");
  expect_says(refusal(folder.write("cloth.abc", "x")), "\".abc\"; .gltf, .glb, .obj, .ply, .stl, .dae and .fbx can be read");
  expect_says(refusal(folder / "cloth.usd"), "\".usd\"; .gltf, .glb, .obj, .ply, .stl, .dae and .fbx can be read");
  if (std::filesystem::exists("/dev/null")) {
    std::filesystem::create_symlink("/dev/null", folder / "device.obj");
    expect_says(refusal(folder / "device.obj"), "not a regular file");
  }
}

TEST(MeshFaults, foreign_content_under_a_mesh_s_name_is_refused) {
  const Folder folder;
  const std::string picture("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\b\2\0\0\0", 29);
  for (const char* name : {"a.glb", "a.gltf", "a.obj"}) expect_says(refusal(folder.write(name, picture)), name);
  expect_says(refusal(folder.write("list.gltf", "[1, 2]")), "not a JSON document");
  expect_says(refusal(folder.write("other.gltf", "{\"hello\": 1}")), "not a glTF 2.0 document");
  expect_says(refusal(folder.write("old.glb", std::string("glTF\1\0\0\0\24\0\0\0\0\0\0\0\0\0\0\0", 20))), "version 1");
}

TEST(MeshFaults, ten_megabytes_of_brackets_are_refused) {
  const Folder folder;
  for (const char bracket : {'[', '{'}) expect_says(refusal(folder.write("deep.gltf", std::string(10'000'000, bracket))), "nest deeper");
}

TEST(MeshFaults, a_missing_or_short_buffer_is_named) {
  const Folder folder;
  Gltf gltf = triangle();
  const std::filesystem::path file = gltf.write(folder);
  std::filesystem::resize_file(folder / "mesh.bin", 20);
  expect_says(refusal(file), "buffer 0 is cut short: it has 20 of 42 bytes");
  std::filesystem::remove(folder / "mesh.bin");
  expect_says(refusal(file), "mesh.bin does not exist");
}

TEST(MeshFaults, a_buffer_outside_the_file_s_folder_is_not_read) {
  const Folder folder;
  Gltf gltf = triangle();
  gltf.write(folder);
  std::filesystem::create_directories(folder / "own/sub");
  std::filesystem::copy_file(folder / "mesh.bin", folder / "own/sub/mesh.bin");
  std::filesystem::create_symlink("../mesh.bin", folder / "own/link.bin");
  std::filesystem::create_directory_symlink("..", folder / "own/up");
  std::filesystem::create_symlink("sub/mesh.bin", folder / "own/near.bin");
  std::filesystem::create_directory_symlink("own", folder / "alias");
  const auto named = [&](const std::string& uri) {
    gltf.json["buffers"][0]["uri"] = uri;
    return folder.write("own/mesh.gltf", gltf.json.dump());
  };
  for (const std::string& uri :
       {std::string("../mesh.bin"), std::string("%2e%2e/mesh.bin"), std::string("..%2Fmesh.bin"), std::string("sub/../../mesh.bin"),
        std::string("link.bin"), std::string("up/mesh.bin"), (folder / "mesh.bin").string(), std::string("/etc/passwd"),
        std::string("../../../../../../../../etc/passwd"), std::string("../no_such_file"), std::string("link.bin%00/../sub/mesh.bin")})
    expect_says(refusal(named(uri)), "lies outside the folder of the glTF");
  for (const std::string& uri : {std::string("../mesh.bin"), std::string("link.bin"), (folder / "mesh.bin").string()}) {
    const Result<Mesh> mesh = load_mesh(named(uri), BufferFiles::anywhere);
    EXPECT_TRUE(mesh) << mesh.error();
  }
  EXPECT_FALSE(load_mesh(named("../no_such_file"), BufferFiles::anywhere));
  for (const char* uri : {"sub/mesh.bin", "sub/../sub/mesh.bin", "%73ub/mesh.bin", "near.bin"}) {
    const std::filesystem::path file = named(uri);
    for (const std::filesystem::path& path : {file, folder / "alias/mesh.gltf", folder / "own/sub/../mesh.gltf"}) {
      const Result<Mesh> mesh = load_mesh(path);
      EXPECT_TRUE(mesh) << mesh.error();
    }
  }
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder / "own");
  EXPECT_TRUE(load_mesh("mesh.gltf"));
  std::filesystem::current_path(before);
}

TEST(MeshFaults, what_a_file_makes_the_program_read_and_hold_is_bounded) {
  const Folder folder;
  folder.write("large.obj", "v 0 0 0\n");
  std::filesystem::resize_file(folder / "large.obj", std::uintmax_t{1} << 40);   // a hole: nothing lies on the disk
  expect_says(refusal(folder / "large.obj"), "has 1099511627776 bytes; at most 1073741824 are read");
  Gltf gltf = triangle();
  const std::filesystem::path file = gltf.write(folder);
  std::filesystem::resize_file(folder / "mesh.bin", std::uintmax_t{1} << 40);   // the buffer is its first bytes
  EXPECT_TRUE(load_mesh(file));
  gltf.json["buffers"].push_back({{"byteLength", 1 << 30}, {"uri", "mesh.bin"}});
  expect_says(refusal(folder.write("buffers.gltf", gltf.json.dump())), "at most 1073741824 are allowed");
  expect_says(refusal(folder.write("values.gltf", "{\"extras\":[" + std::string(5'000'000, ',') + "]}")), "more than 4000000 values");
  gltf = triangle();
  gltf.json["scenes"][0]["nodes"] = std::vector<int>(1000, 0);
  expect_says(refusal(gltf.write(folder)), "its scene has the node 0 twice");
}

TEST(MeshFaults, a_hundred_thousand_nodes_or_sets_of_accessors_are_too_many) {
  const Folder folder;
  Gltf gltf = triangle();
  gltf.json["nodes"] = nlohmann::json(100'001, {{"mesh", 0}});
  gltf.json.erase("scenes");
  gltf.json.erase("scene");
  expect_says(refusal(gltf.write(folder)), "its scene has more than 100000 nodes");
  gltf = triangle();
  for (std::size_t k = 0; k < 100'000; ++k) {
    const std::size_t next = gltf.json["accessors"].size();
    gltf.json["accessors"].push_back(nlohmann::json(gltf.json["accessors"][0]));
    gltf.primitive(next);
  }
  expect_says(refusal(gltf.write(folder)), "its primitives have more than 100000 sets of accessors");
}

TEST(MeshFaults, an_obj_reads_no_other_file) {
  const Folder folder;
  const std::string text = "mtllib /dev/zero ../../etc/passwd\ncall /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_TRUE(load_mesh(folder.write("a.obj", text)));
}

TEST(MeshFaults, a_line_that_goes_on_a_million_times_is_read_in_one_go) {
  const Folder folder;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 ";
  for (int k = 0; k < 1'000'000; ++k) text += "\\\n";
  EXPECT_TRUE(load_mesh(folder.write("a.obj", text + "3\n")));
}

TEST(MeshFaults, compressed_primitives_are_named_and_their_plain_copies_read) {
  const Folder folder;
  Gltf gltf = triangle();
  gltf.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  gltf.json["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", 0}}}};
  EXPECT_TRUE(load_mesh(gltf.write(folder)));
  for (auto& accessor : gltf.json["accessors"]) accessor.erase("bufferView");
  expect_says(refusal(gltf.write(folder)), "a primitive is compressed (KHR_draco_mesh_compression): ");
  gltf.json["meshes"][0]["primitives"][0].erase("extensions");
  expect_says(refusal(gltf.write(folder)), "the accessor of \"POSITION\" has no \"bufferView\"");
  gltf = triangle();
  gltf.write(folder);
  gltf.json["buffers"].push_back({{"byteLength", 100}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  EXPECT_TRUE(load_mesh(folder.write("meshopt.gltf", gltf.json.dump())));
  gltf.json["bufferViews"][0]["buffer"] = 1;   // where nothing is
  expect_says(refusal(folder.write("meshopt.gltf", gltf.json.dump())), "past the end of its buffer");
}

TEST(MeshFaults, corners_that_make_no_whole_triangles_are_refused) {
  const auto refuse = [](const std::vector<std::uint16_t>& corners, int mode, const char* part) {
    const Folder folder;
    Gltf gltf;
    const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}), indices = gltf.indices16(corners);
    gltf.primitive(position, mode)["indices"] = indices;
    expect_says(refusal(gltf.write(folder)), part);
  };
  refuse({0, 1, 2, 0, 1}, 4, "a primitive has 5 corners, which is no multiple of 3");
  refuse({0, 1}, 4, "a primitive has 2 corners");
  refuse({0, 1}, 5, "a strip or fan has 2 corners; 3 are needed");
  refuse({0}, 6, "a strip or fan has 1 corners; 3 are needed");
}

TEST(MeshFaults, a_vertex_too_far_away_is_refused_with_its_number) {
  const Folder folder;
  expect_says(refusal(folder.write("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 0 0\nv 0 2e30 0\nf 1 2 4\n")),
              "2 of 4 vertices lie 1e+10 m or more from the origin, the first is vertex 1, 1e+30 m away");
  Gltf gltf;
  gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1e12f, 0}));
  expect_says(refusal(gltf.write(folder)), "1 of 3 vertices lies 1e+10 m or more from the origin, the first is vertex 2, 1e+12 m away");
}

TEST(MeshFaults, ranges_and_references_out_of_bounds_are_named) {
  const auto refuse = [](const char* pointer, const nlohmann::json& value, const char* part) {
    const Folder folder;
    Gltf gltf = triangle();
    gltf.json[nlohmann::json::json_pointer(pointer)] = value;
    expect_says(refusal(gltf.write(folder)), part);
  };
  refuse("/accessors/0/count", 4, "reaches past the end of its buffer view");
  refuse("/accessors/0/count", -1, "\"count\" is -1");
  refuse("/accessors/0/count", 4'000'000'000u, "at most");
  refuse("/accessors/0/byteOffset", 1u << 30, "reaches past");
  refuse("/accessors/0/componentType", 5125, "5120 to 5123 (integers) and 5126 (float)");
  refuse("/accessors/0/type", "MAT4", "is not a VEC3");
  refuse("/accessors/0/type", 3, "is not a VEC3");
  refuse("/accessors/0/sparse", {{"count", 1}}, "component type 0");
  refuse("/accessors/0/bufferView", 9, "points to 9 of a list of 2");
  refuse("/bufferViews/0/byteLength", 1000, "past the end of its buffer");
  refuse("/bufferViews/0/byteStride", 2, "stride of 2");
  refuse("/bufferViews/0/buffer", 3, "past the end of its buffer");
  refuse("/meshes/0/primitives/0/attributes/POSITION", 5, "points to 5");
  refuse("/meshes/0/primitives/0/attributes", 5, "POSITION");
  refuse("/meshes/0/primitives/0/mode", 9, "mode");
  refuse("/meshes", 1, "not a list");
  refuse("/nodes/0/mesh", 4, "points to 4 of 1");
  refuse("/nodes/0/children", {0}, "below itself");
  refuse("/nodes/0/scale", {1, 2}, "not 3 numbers");
  refuse("/scene", 2, "points to 2");
  refuse("/scenes/0/nodes/0", 7, "node 7");
  refuse("/extensionsRequired", {"KHR_technique_webgl"}, "KHR_technique_webgl");
}

TEST(MeshFaults, an_index_past_the_last_vertex_is_refused) {
  const Folder folder;
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}), indices = gltf.indices16({0, 1, 2, 0, 1, 3});
  gltf.primitive(position)["indices"] = indices;
  expect_says(refusal(gltf.write(folder)), "index 5 is 3, past the last of 3 vertices");
}

TEST(MeshFaults, a_vertex_that_is_not_finite_is_refused_with_its_place) {
  const Folder folder;
  expect_says(refusal(folder.write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n")),
              "1 of 3 vertices is not finite, the first is vertex 2");
  Gltf gltf = triangle();
  gltf.json["nodes"][0]["scale"] = {1e38, 1, 1};
  gltf.json["nodes"].push_back({{"children", {0}}, {"scale", {1e38, 1, 1}}});
  gltf.json["scenes"][0]["nodes"] = {1};
  expect_says(refusal(gltf.write(folder)), "not finite");
}

TEST(MeshFaults, a_damaged_line_of_an_obj_is_named_by_its_number) {
  const Folder folder;
  const auto refuse = [&](const std::string& line, const char* part) {
    expect_says(refusal(folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + line + "\n")), part);
  };
  refuse("f 1 2 4", "line 4 refers to v number 4 of 3");
  refuse("f 1 2 -4", "line 4: \"-4\" is not the index of a v; there are 3 so far");
  refuse("f 1 2 0", "\"0\" is not the index");
  refuse("f 1/1 2/1 3/1", "line 4 refers to vt number 1 of 0");
  refuse("f 1 2", "a face has 2 corners; 3 are needed");
  refuse("f 1 2 3/1/1/1", "is not the corner of a face");
  refuse("f 1 2 \\\n x", "line 5: \"x\" is not the index");
  refuse("v 1 2", "v has 2 numbers; 3 are needed");
  refuse("v 1 2 3.5f", "\"3.5f\" is not a number");
}

TEST(MeshFaults, nothing_but_lines_has_no_triangle) {
  const Folder folder;
  expect_says(refusal(folder.write("line.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), "no triangle");
}

TEST(MeshFaults, a_tree_of_nodes_too_deep_to_walk_is_refused) {
  const Folder folder;
  Gltf gltf = triangle();
  for (int n = 1; n < 1000; ++n) gltf.json["nodes"].push_back({{"children", {n - 1}}});
  gltf.json["scenes"][0]["nodes"] = {999};
  expect_says(refusal(gltf.write(folder)), "deeper than");
}

/// A mesh that loads in spite of everything must keep what mesh.h promises.
void expect_sound_or_sentence(const std::filesystem::path& file) {
  const Result<Mesh> mesh = load_mesh(file);
  if (!mesh) {
    ASSERT_GT(mesh.error().size(), 20u);
    return;
  }
  const std::size_t vertices = mesh->render.positions.size();
  ASSERT_EQ(mesh->render.normals.size(), vertices);
  ASSERT_EQ(mesh->render.tangents.size(), vertices);
  ASSERT_EQ(mesh->render.uvs.size(), vertices);
  ASSERT_EQ(mesh->point_of.size(), vertices);
  for (std::size_t t = 0; t < mesh->triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(mesh->render.triangles[t][k], vertices);
      ASSERT_EQ(mesh->point_of[mesh->render.triangles[t][k]], mesh->triangles[t][k]);
      ASSERT_LT(mesh->triangles[t][k], mesh->points.size());
    }
  for (std::size_t v = 0; v < vertices; ++v) {
    ASSERT_NEAR(length(mesh->render.normals[v]), 1, 1e-4);
    ASSERT_TRUE(std::isfinite(mesh->render.uvs[v].x) && std::isfinite(mesh->render.uvs[v].y));
    ASSERT_EQ(std::abs(mesh->render.tangents[v].w), 1);
  }
}

/// Cuts the file every few bytes, then flips random bits, each time in one to eight bytes.
void damage(const std::string& content, const std::string& name, unsigned flips) {
  const Folder folder;
  for (std::size_t size = 1; size < content.size(); size += 47) {
    SCOPED_TRACE(testing::Message() << "cut to " << size);
    expect_sound_or_sentence(folder.write(name, content.substr(0, size)));
  }
  std::mt19937 random(11);
  for (unsigned round = 0; round < flips; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    std::string damaged = content;
    for (unsigned k = 0; k <= round % 8; ++k) damaged[random() % damaged.size()] ^= static_cast<char>(1u << random() % 8);
    expect_sound_or_sentence(folder.write(name, damaged));
  }
}

TEST(MeshFaults, a_damaged_glb_never_crashes) {
  const Folder folder;
  Grid grid;
  grid.cells_x = grid.cells_y = 4;
  ASSERT_TRUE(write_glb(folder / "whole.glb", make_grid(grid).render));
  damage(test::slurp(folder / "whole.glb"), "damaged.glb", 400);
}

TEST(MeshFaults, a_damaged_obj_never_crashes) {
  std::ostringstream text;
  text << "o sheet\n";
  for (int j = 0; j <= 4; ++j)
    for (int i = 0; i <= 4; ++i) text << "v " << i * 0.25 << " " << j * 0.25 << " 0\nvt " << i * 0.25 << " " << j * 0.25 << "\nvn 0 0 1\n";
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      text << "f";
      for (const int v : {j * 5 + i + 1, j * 5 + i + 2, j * 5 + i + 7, j * 5 + i + 6}) text << " " << v << "/" << v << "/" << v;
      text << "\n";
    }
  damage(text.str(), "damaged.obj", 400);
}

}   // namespace
}   // namespace weft
