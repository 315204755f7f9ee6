// What real files hold: quantised, sparse and compressed accessors, transformed textures, and the formats that assimp reads.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

Mesh loaded(Gltf gltf) {
  const Folder folder;
  return must(load_mesh(gltf.write(folder)));
}

// Made of files that are kept for fuzzing.
Result<Mesh> kept(const std::string& name) { return load_mesh(std::filesystem::path(WEFT_SOURCE_DIR) / "tests/fuzz/corpus/mesh" / name); }

void expect_near(Vec3 found, Vec3 wanted, float tolerance = 1e-5f) {
  EXPECT_LT(length(found - wanted), tolerance) << found.x << " " << found.y << " " << found.z;
}

TEST(MeshFormats, quantised_attributes_are_numbers_or_fractions) {
  Gltf gltf;
  const std::size_t position = gltf.accessor<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}, 5122, "VEC3", 4);
  gltf.json["bufferViews"][0]["byteStride"] = 8;
  gltf.json["accessors"][0]["normalized"] = true;
  const std::size_t normal = gltf.accessor<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 5120, "VEC3", 4);
  gltf.json["bufferViews"][1]["byteStride"] = 4;
  gltf.json["accessors"][1]["normalized"] = true;
  const std::size_t uv = gltf.accessor<std::uint16_t>({0, 0, 3, 1, 7, 9}, 5123, "VEC2", 2);
  auto& primitive = gltf.primitive(position);
  primitive["attributes"]["NORMAL"] = normal;
  primitive["attributes"]["TEXCOORD_0"] = uv;
  gltf.json["nodes"][0]["scale"] = {2, 3, 1};   // back to the size that it had
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Mesh mesh = loaded(gltf);
  EXPECT_EQ(mesh.points, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}));
  EXPECT_EQ(mesh.render.normals[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(mesh.render.uvs[2], (Vec2{7, 9}));
}

TEST(MeshFormats, a_sparse_accessor_is_its_elements_with_some_changed) {
  for (const bool has_base : {true, false}) {
    Gltf gltf;
    const std::size_t position = gltf.vec3({0, 0, 0, 5, 5, 5, 0, 0, 0});
    gltf.indices8({1, 2});
    gltf.vec3({1, 0, 0, 0, 1, 0});
    auto& accessor = gltf.json["accessors"][position];
    accessor["sparse"] = {{"count", 2}, {"indices", {{"bufferView", 1}, {"componentType", 5121}}}, {"values", {{"bufferView", 2}}}};
    if (!has_base) accessor.erase("bufferView");
    gltf.primitive(position);
    EXPECT_EQ(loaded(gltf).points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    gltf.json["accessors"][position]["count"] = 2;   // the second change is one too far
    const Folder folder;
    EXPECT_NE(load_mesh(gltf.write(folder)).error().find("changes element 2 of 2"), std::string::npos);
  }
}

TEST(MeshFormats, sparse_accessors_of_a_few_words_cannot_claim_the_memory) {
  Gltf gltf;
  gltf.indices8({0});
  gltf.vec3({1, 0, 0});
  for (int k = 0; k < 10; ++k) {
    gltf.json["accessors"].push_back({{"componentType", 5126}, {"count", 4'000'000}, {"type", "VEC3"}, {"sparse",
        {{"count", 1}, {"indices", {{"bufferView", 0}, {"componentType", 5121}}}, {"values", {{"bufferView", 1}}}}}});
    gltf.primitive(gltf.json["accessors"].size() - 1, 0);
  }
  const Folder folder;
  EXPECT_NE(load_mesh(gltf.write(folder)).error().find("its sparse accessors have more than 268435456 bytes"), std::string::npos);
}

TEST(MeshFormats, texture_coordinates_are_transformed_as_the_base_colour_has_it) {
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const std::size_t first = gltf.vec2({9, 9, 9, 9, 9, 9}), second = gltf.vec2({0, 0, 1, 0, 0, 1});
  auto& primitive = gltf.primitive(position);
  primitive["attributes"]["TEXCOORD_0"] = first;
  primitive["attributes"]["TEXCOORD_1"] = second;
  primitive["material"] = 0;
  const nlohmann::json transform = {{"offset", {0.5, 0.25}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}, {"texCoord", 1}};
  const nlohmann::json colour = {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
  gltf.json["materials"] = {{{"normalTexture", {{"index", 0}}}, {"pbrMetallicRoughness", {{"baseColorTexture", colour}}}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["images"] = {{{"uri", "data:image/png;base64,iVBORw=="}}};
  gltf.json["extensionsRequired"] = {"KHR_texture_transform"};
  const Mesh mesh = loaded(gltf);
  // Anticlockwise as one sees it, and v points down: u becomes -v, v becomes u.
  const Vec2 wanted[3] = {{0.5f, 0.25f}, {0.5f, -1.75f}, {3.5f, 0.25f}};
  for (int v = 0; v < 3; ++v) {
    EXPECT_NEAR(mesh.render.uvs[v].x, wanted[v].x, 1e-6);
    EXPECT_NEAR(mesh.render.uvs[v].y, wanted[v].y, 1e-6);
  }
  EXPECT_EQ(mesh.mended, (std::vector<std::string>{"1 material has textures with other coordinates than the first's, which all have now"}));
  ASSERT_TRUE(mesh.render.materials);
  EXPECT_EQ(mesh.render.materials->text.find("transform"), std::string::npos);   // it is in the coordinates
}

/// A sheet of 5 x 5 vertices, a metre wide, however it was stored.
void expect_sheet(const Mesh& mesh) {
  EXPECT_EQ(mesh.points.size(), 25u);
  EXPECT_EQ(mesh.triangles.size(), 32u);
  for (const Vec3 p : mesh.points) expect_near(p, {std::round(p.x * 4) / 4, 0, std::round(p.z * 4) / 4}, 2e-3f);
  for (const Vec3 n : mesh.render.normals) expect_near(n, {0, 1, 0}, 1e-3f);
}

#ifdef WEFT_DRACO
TEST(MeshFormats, draco_is_unpacked) {
  const Mesh mesh = must(kept("draco_sheet.gltf"));
  expect_sheet(mesh);
  for (std::size_t v = 0; v < 25; ++v) {
    EXPECT_NEAR(mesh.render.uvs[v].x, mesh.render.positions[v].x, 2e-3);
    EXPECT_NEAR(mesh.render.uvs[v].y, mesh.render.positions[v].z, 2e-3);
  }
}

TEST(MeshFormats, a_stream_of_draco_s_that_is_not_what_the_document_says_is_refused) {
  const Folder folder;
  const auto refused = [&](const char* pointer, const nlohmann::json& value) {
    auto json = nlohmann::json::parse(test::slurp(std::filesystem::path(WEFT_SOURCE_DIR) / "tests/fuzz/corpus/mesh/draco_sheet.gltf"));
    json[nlohmann::json::json_pointer(pointer)] = value;
    const Result<Mesh> mesh = load_mesh(folder.write("wrong.gltf", json.dump()));
    return mesh ? std::string("read") : mesh.error().substr(mesh.error().find(": ") + 2);
  };
  const std::string of = "a primitive is compressed (KHR_draco_mesh_compression): ";
  EXPECT_EQ(refused("/accessors/0/count", 93), of + "its stream has 25 vertices and 32 triangles, and the document says 25 and 31");
  EXPECT_EQ(refused("/accessors/1/count", 24), "a compressed primitive has 24 and 25 vertices");
  EXPECT_EQ(refused("/accessors/1/componentType", 5123),
            of + "attribute 0 of its stream has 3 numbers of another type than the document says");
  EXPECT_EQ(refused("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/POSITION", 7),
            of + "its stream has no attribute 7");
  EXPECT_EQ(refused("/bufferViews/0/byteLength", 90).substr(0, of.size() + 11), of + "Draco says:");
  EXPECT_EQ(refused("/accessors/0/count", 4'000'000'000u).substr(0, 22), "a compressed primitive");
}
#endif

#ifdef WEFT_MESHOPT
TEST(MeshFormats, meshopt_is_unpacked) {
  for (const char* name : {"meshopt_sheet.gltf", "meshopt_sequence.gltf"}) expect_sheet(must(kept(name)));
}

TEST(MeshFormats, a_stream_of_meshopt_s_that_is_not_what_the_document_says_is_refused) {
  const Folder folder;
  const auto refused = [&](const char* key, const nlohmann::json& value, std::size_t view = 0) {
    auto json = nlohmann::json::parse(test::slurp(std::filesystem::path(WEFT_SOURCE_DIR) / "tests/fuzz/corpus/mesh/meshopt_sheet.gltf"));
    json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
    if (std::string(key) == "count" && value > 1000) json["bufferViews"][view]["byteLength"] = 8 * value.get<int>();
    const Result<Mesh> mesh = load_mesh(folder.write("wrong.gltf", json.dump()));
    return mesh ? std::string("read") : mesh.error().substr(mesh.error().find("): ") + 3);
  };
  EXPECT_EQ(refused("mode", "SOMETHING"), "has the mode \"SOMETHING\"");
  EXPECT_EQ(refused("byteStride", 6), "has a stride of 6 bytes");
  EXPECT_EQ(refused("filter", "OCTAHEDRAL", 2), "has the filter \"OCTAHEDRAL\" on 4 bytes");
  EXPECT_EQ(refused("count", 24), "has 24 elements of 8 bytes, and 200 bytes");
  EXPECT_EQ(refused("count", 20'000'000).substr(0, 31), "cannot hold 20000000 elements i");
  EXPECT_NE(refused("byteLength", 40).find("cannot be unpacked: its stream is damaged"), std::string::npos);
}
#endif

/// Two triangles over a square metre on the floor.
void expect_square(const Mesh& mesh) {
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  Vec3 low = mesh.points[0], high = low;
  for (const Vec3 p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  expect_near(high - low, {1, 0, 1});
  expect_near(mesh.render.normals[0], {0, 1, 0});
}

TEST(MeshFormats, a_ply_has_its_colours_and_its_vertices_numbers) {
  const Mesh mesh = must(kept("sheet.ply"));
  expect_square(mesh);
  EXPECT_EQ(mesh.points, (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}));
  EXPECT_EQ(mesh.attributes.at("COLOR_0")[1], (Vec4{0, 1, 0, 1}));
}

TEST(MeshFormats, an_stl_s_corners_are_joined_and_that_is_said) {
  const Mesh mesh = must(kept("sheet.stl"));
  expect_square(mesh);
  EXPECT_EQ(mesh.mended, (std::vector<std::string>{"6 corners of an STL, which has no shared vertices, were joined where they meet"}));
}

TEST(MeshFormats, a_collada_and_an_fbx_are_in_metres_and_upright_with_their_materials) {
  for (const auto& [name, material] : {std::pair{"sheet.dae", "red"}, {"sheet.fbx", "blue"}}) {
    const Mesh mesh = must(kept(name));
    expect_square(mesh);
    ASSERT_TRUE(mesh.render.materials) << name;
    EXPECT_NE(mesh.render.materials->text.find(material), std::string::npos) << mesh.render.materials->text;
  }
}

TEST(MeshFormats, what_assimp_cannot_read_is_its_sentence_with_the_file_s_name) {
  const Folder folder;
  for (const char* name : {"a.ply", "a.stl", "a.dae", "a.fbx"}) {
    const Result<Mesh> mesh = load_mesh(folder.write(name, "Kaydara FBX Binary  \0 and no more"));
    ASSERT_FALSE(mesh) << name;
    EXPECT_NE(mesh.error().find(std::string(name) + ": assimp c"), std::string::npos) << mesh.error();
  }
}

}  // namespace
}  // namespace weft
