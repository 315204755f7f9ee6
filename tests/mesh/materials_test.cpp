// A cloth of several materials keeps them, with their textures, in what is written back.
#include <gtest/gtest.h>

#include "engine/cache.h"
#include "engine/export.h"
#include "engine/fabric.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

constexpr const char* kPng = "data:image/png;base64,iVBORw0KGgo=";

/// Three triangles: silk, no material, wool. Of the file's three materials the first is of no triangle.
Gltf patchwork() {
  Gltf gltf;
  const std::size_t position = gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 2, 0});
  for (const auto& [corners, material] : {std::pair{std::vector<std::uint16_t>{0, 1, 2}, 2}, {{0, 2, 3}, -1}, {{3, 2, 4}, 1}}) {
    const std::size_t indices = gltf.indices16(corners);
    auto& primitive = gltf.primitive(position);
    primitive["indices"] = indices;
    if (material >= 0) primitive["material"] = material;
  }
  gltf.json["materials"] = {{{"name", "unused"}, {"normalTexture", {{"index", 0}}}},
                            {{"name", "wool"}, {"extras", {{"sheep", 3}}}},
                            {{"name", "silk"},
                             {"extensions", {{"KHR_materials_sheen", {{"sheenColorTexture", {{"index", 1}}}}}}},
                             {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}}};
  gltf.json["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}};
  gltf.json["samplers"] = {{{"wrapS", 33071}}};
  gltf.json["images"] = {{{"uri", "nowhere.png"}}, {{"uri", kPng}}};
  return gltf;
}

nlohmann::json document(const std::filesystem::path& glb) {
  const std::string bytes = test::slurp(glb);
  return nlohmann::json::parse(bytes.substr(20, static_cast<unsigned char>(bytes[12]) + 256u * static_cast<unsigned char>(bytes[13])));
}

std::string name_of(const Mesh& mesh, std::size_t triangle) {
  const std::uint32_t number = mesh.render.material_of[triangle];
  return number == kNone ? "none" : nlohmann::json::parse(mesh.render.materials->text)["materials"][number].value("name", "plain");
}

TEST(MeshMaterials, come_back_with_their_textures_and_their_triangles) {
  const Folder folder;
  Mesh mesh = must(load_mesh(patchwork().write(folder)));
  EXPECT_TRUE(mesh.mended.empty()) << mesh.mended[0];
  ASSERT_EQ(mesh.render.material_of.size(), 3u);
  EXPECT_EQ(name_of(mesh, 0) + name_of(mesh, 1) + name_of(mesh, 2), "silknonewool");
  EXPECT_EQ(mesh.render.materials->images, (std::vector<std::string>{"\x89PNG\r\n\x1a\n"}));
  ASSERT_TRUE(check(mesh));
  must(write_glb(folder / "back.glb", mesh.render));
  const nlohmann::json back = document(folder / "back.glb");
  EXPECT_EQ(back["materials"].size(), 3u);   // the third for the triangle that had none
  EXPECT_EQ(back["extensionsUsed"], nlohmann::json({"KHR_materials_sheen"}));
  EXPECT_EQ(back["materials"][1]["extras"]["sheep"], 3);
  EXPECT_EQ(back["samplers"][0]["wrapS"], 33071);
  const Mesh again = must(load_mesh(folder / "back.glb"));
  EXPECT_EQ(again.render.materials->images, mesh.render.materials->images);
  std::string names;
  for (std::size_t t = 0; t < 3; ++t) names += name_of(again, t).substr(0, 4);
  EXPECT_NE(names.find("silk"), std::string::npos);
  EXPECT_NE(names.find("wool"), std::string::npos);
}

TEST(MeshMaterials, of_dropped_triangles_go_with_them) {
  Gltf gltf = patchwork();
  const std::size_t flat = gltf.indices16({0, 0, 1});
  gltf.json["meshes"][0]["primitives"][0]["indices"] = flat;
  const Folder folder;
  const Mesh mesh = must(load_mesh(gltf.write(folder)));
  ASSERT_EQ(mesh.render.material_of.size(), 2u);
  EXPECT_EQ(name_of(mesh, 0) + name_of(mesh, 1), "nonewool");
}

TEST(MeshMaterials, that_are_not_as_they_must_be_are_left_out_with_a_sentence) {
  const auto left_out = [](const char* pointer, const nlohmann::json& value) {
    const Folder folder;
    Gltf gltf = patchwork();
    gltf.json[nlohmann::json::json_pointer(pointer)] = value;
    const Mesh mesh = must(load_mesh(gltf.write(folder)));
    EXPECT_FALSE(mesh.render.materials);
    EXPECT_TRUE(mesh.render.material_of.empty());
    return mesh.mended.empty() ? std::string() : mesh.mended[0];
  };
  const std::string out = "its materials were left out: ";
  EXPECT_EQ(left_out("/meshes/0/primitives/0/material", 9), out + "a primitive's \"material\" is not one of the 3");
  EXPECT_EQ(left_out("/textures/1/source", 5), out + "a number among its \"images\" is 5, and there are 2");
  EXPECT_EQ(left_out("/textures/1/sampler", 5), out + "\"sampler\" points to 5 of a list of 1");
  EXPECT_EQ(left_out("/images/1/uri", "data:image/png;base64,R0lGODlh"), out + "an image is neither PNG, JPEG, WebP nor KTX2");
  EXPECT_NE(left_out("/materials/2/extensions/KHR_materials_sheen/sheenColorTexture/texCoord", -1).find(out), std::string::npos);
  EXPECT_NE(left_out("/materials", nlohmann::json::object()).find(out), std::string::npos);
  EXPECT_NE(left_out("/materials/2/extensions/KHR_materials_sheen/sheenColorTexture/extensions",
                     {{"KHR_texture_transform", {{"offset", {0, 0, 0}}}}}).find(out), std::string::npos);
  EXPECT_NE(left_out("/images/1/uri", "nowhere.png").find("nowhere.png does not exist"), std::string::npos);
  EXPECT_NE(left_out("/images/1/uri", "../outside.png").find("lies outside the folder"), std::string::npos);
}

TEST(MeshMaterials, of_several_cloths_are_in_one_cache) {
  const Folder folder;
  const std::filesystem::path file = patchwork().write(folder);
  const std::filesystem::path copy = folder.write("copy.gltf", test::slurp(file));
  Scene scene;
  for (int k = 0; k < 4; ++k) {
    Cloth& cloth = scene.cloths.emplace_back();
    if (k != 1) cloth.mesh = (k == 2 ? copy : file).string();   // the second has none, the last those of the first
    else cloth.grid = Grid{.cells_x = 1, .cells_y = 1};
    cloth.name = "cloth" + std::to_string(k);
  }
  const std::vector<Mesh> meshes = must(make_meshes(scene));
  EXPECT_EQ(meshes[0].render.materials, meshes[3].render.materials);
  EXPECT_NE(meshes[0].render.materials, meshes[2].render.materials);
  const CachedShape shape = cached_shape(must(cook(scene, meshes)), meshes, {}, CacheFormat::glb);
  const std::uint32_t silk = shape.mesh.material_of[0], wool = shape.mesh.material_of[2];
  EXPECT_EQ(shape.mesh.material_of, (std::vector<std::uint32_t>{silk, kNone, wool, kNone, kNone, silk + 2, kNone, wool + 2, silk, kNone, wool}));
  EXPECT_NE(silk, wool);
  auto writer = must(CacheWriter::create(folder / "all.glb", shape.mesh, {.frames = 1}));
  must(writer->add({.positions = shape.mesh.positions, .normals = shape.mesh.normals}));
  must(writer->finish());
  const nlohmann::json written = document(folder / "all.glb");
  EXPECT_EQ(written["materials"].size(), 5u);
  EXPECT_EQ(written["textures"][1]["source"], 1);
  EXPECT_EQ(written["textures"][1]["sampler"], 1);
  EXPECT_EQ(written["meshes"][0]["primitives"].size(), 5u);
  EXPECT_EQ(must(load_mesh(folder / "all.glb")).render.materials->images.size(), 2u);
}

}  // namespace
}  // namespace weft
