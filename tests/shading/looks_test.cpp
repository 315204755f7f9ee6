// Pictures of a mesh with the materials of its file, and what is said of those that they do not have.
#include <gtest/gtest.h>

#include "engine/mesh/materials.h"
#include "engine/shading/looks.h"
#include "engine/shading/shading.h"
#include "engine/simulation.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"
#include "tests/support/on_device.h"

namespace weft {
namespace {

std::string png_of(const std::vector<std::uint8_t>& rgba, std::uint32_t width) {
  const test::Folder folder;
  must(write_png(folder / "texels.png", {width, static_cast<std::uint32_t>(rgba.size() / 4 / width), rgba}));
  return test::slurp(folder / "texels.png");
}

class MeshLooks : public compute::OnDevice {
 protected:
  void TearDown() override {
    shading.reset();   // before its device
    OnDevice::TearDown();
  }
  // An upright sheet that faces the camera, of three materials from left to right and a fourth part without one.
  void make(std::shared_ptr<const Materials> materials) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 1}, 16, 16, Topology::diagonal, true};
    cloth.anchors.emplace_back().top = 0.001;
    cloth.appearance.base_colour = {0.02f, 0.7f, 0.02f};
    cloth.appearance.mesh_materials = true;
    scene.camera = {.eye = {0, 0, 3}, .target = {0, 0, 0}};
    mesh = make_grid(*cloth.grid);
    for (const Triangle& triangle : mesh.render.triangles) {
      const float u = mesh.render.uvs[triangle[0]].x;
      mesh.render.material_of.push_back(u < 0.25f ? 0 : u < 0.5f ? 1 : u < 0.75f ? 2 : kNone);
    }
    mesh.render.materials = std::move(materials);
  }
  void draw() {
    auto simulation = must(Simulation::create(device(), scene, {mesh}));
    const auto cloths = shaded_cloths(scene, simulation->fabric(), simulation->meshes());
    shading = must(Shading::create(*device_, scene, cloths, {160, 120}));
    image = must(shading->draw({.positions = simulation->positions(), .normals = simulation->normals(), .colliders = {}}));
  }
  // Of the middle of the k-th quarter of the sheet, from the left, up from its own middle by so many heights.
  std::array<int, 3> colour(int k, double up = 0) const {
    const double across = 120 / (2 * 3 * std::tan(0.5 * scene.camera.fov_degrees * std::numbers::pi / 180));   // pixels a metre
    const auto x = static_cast<std::size_t>(80 + across * (-0.375 + 0.25 * k)), y = static_cast<std::size_t>(60 - across * up);
    const std::uint8_t* texel = &image.rgba[4 * (y * image.width + x)];
    return {texel[0], texel[1], texel[2]};
  }
  static bool is_mostly(const std::array<int, 3>& colour, std::size_t channel) {
    for (std::size_t c = 0; c < 3; ++c)
      if (c != channel && 2 * colour[c] > colour[channel]) return false;
    return true;
  }

  Scene scene;
  Mesh mesh;
  std::unique_ptr<Shading> shading;
  Image image;
};

std::shared_ptr<Materials> three_materials() {
  auto materials = std::make_shared<Materials>();
  materials->count = 3;
  // Red by its factor; blue by a texture; holes below the middle of the sheet (where v is large).
  materials->text = R"({"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.7,0.02,0.02,1],"metallicFactor":0}},
    {"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0},"emissiveFactor":[0,1,0]},
    {"pbrMetallicRoughness":{"baseColorTexture":{"index":1},"metallicFactor":0},"alphaMode":"MASK","normalTexture":{"index":2}}],
    "textures":[{"source":0},{"source":1},{"source":2}],"images":[{"bufferView":0},{"bufferView":1},{"bufferView":2}]})";
  materials->images = {png_of({10, 10, 200, 255}, 1), png_of({200, 10, 10, 255, 200, 10, 10, 0}, 1), "RIFF0000WEBP"};
  return materials;
}

TEST_F(MeshLooks, are_those_of_the_file) {
  make(three_materials());
  draw();
  EXPECT_TRUE(is_mostly(colour(0), 0));
  EXPECT_TRUE(is_mostly(colour(1), 2));
  EXPECT_TRUE(is_mostly(colour(2, 0.3), 0));
  EXPECT_FALSE(is_mostly(colour(2, -0.3), 0)) << "a hole";
  EXPECT_TRUE(is_mostly(colour(3), 1));
  ASSERT_EQ(shading->notes().size(), 2u);
  EXPECT_EQ(shading->notes()[0], "cloth \"cloth\", material 1: the light that it gives off is left out");
  EXPECT_TRUE(shading->notes()[1].starts_with("cloth \"cloth\", material 2: a texture is left out, an embedded picture is not a whole PNG or JPEG"))
      << shading->notes()[1];

  auto cloths = std::vector{ShadedCloth{&mesh.render, &scene.cloths[0].appearance}};
  EXPECT_TRUE(shading->follow(cloths));
  mesh.render.material_of[0] = 1;
  EXPECT_EQ(shading->follow(cloths).error(), "the cloths' triangles have other materials than they had");
  mesh.render.material_of[0] = 7;
  EXPECT_EQ(shading->follow(cloths).error(), "cloth 0: render.material_of: 7 is not one of the 3 materials");
}

TEST_F(MeshLooks, are_the_scenes_own_where_it_does_not_ask_for_the_files) {
  make(three_materials());
  scene.cloths[0].appearance.mesh_materials = false;
  draw();
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(is_mostly(colour(k), 1)) << k;
  EXPECT_TRUE(shading->notes().empty());
}

// Shadows and occlusion have the holes, too: a floor in the light below them is brighter than below whole cloth.
TEST_F(MeshLooks, let_light_through_their_holes) {
  auto materials = std::make_shared<Materials>();
  materials->count = 1;
  materials->text = R"({"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"alphaMode":"BLEND"}],
    "textures":[{"source":0}],"images":[{"bufferView":0}]})";
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{2, 2}, 8, 8};
  cloth.anchors.emplace_back().box = Anchor::Box{{-9, -9, -9}, {9, 9, 9}};
  cloth.appearance.mesh_materials = true;
  cloth.transform.translate = {0, 1, 0};
  scene.colliders.emplace_back().shape = ColliderShape::plane;
  scene.light.direction = {0, -1, 0};
  scene.camera = {.eye = {0, 0.6f, 3}, .target = {0, 0, 0}};
  mesh = make_grid(*cloth.grid);
  transform_mesh(mesh, cloth.transform);
  mesh.render.material_of.assign(mesh.render.triangles.size(), 0);
  const auto floor_below = [&](std::uint8_t alpha) {
    materials->images = {png_of({200, 200, 200, alpha}, 1)};
    mesh.render.materials = materials;
    auto simulation = must(Simulation::create(device(), scene, {mesh}));
    const auto cloths = shaded_cloths(scene, simulation->fabric(), simulation->meshes());
    shading = must(Shading::create(*device_, scene, cloths, {160, 120}));
    image = must(shading->draw({.positions = simulation->positions(), .normals = simulation->normals(), .colliders = simulation->colliders()}));
    return image.rgba[4 * (60 * image.width + 80)];
  };
  const int shaded = floor_below(255), lit = floor_below(0);
  EXPECT_GT(lit, shaded + 40);
  ASSERT_EQ(shading->notes().size(), 1u);
  EXPECT_EQ(shading->notes()[0], "cloth \"cloth\", material 0: is transparent: drawn is what has an alpha of a half or more, opaque");
}

TEST(Looks, of_a_text_that_is_anything_are_plain) {
  std::vector<std::string> notes;
  Materials materials{.count = 2, .text = {}, .images = {"x"}};
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  for (const std::string& text : {std::string(), std::string("null"), std::string("[1,2]"), deep, std::string(R"({"materials":3})"),
                                  std::string(R"({"materials":[[],{"pbrMetallicRoughness":[],"alphaMode":1,"emissiveFactor":"x"}]})"),
                                  std::string(R"({"materials":[{"normalTexture":{"index":-1,"scale":"x"}}],"textures":{"0":1}})"),
                                  std::string(R"({"materials":[{"normalTexture":{"index":0}}],"textures":[{"source":0}],"images":[{"bufferView":1}]})"),
                                  std::string(R"({"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[-1e300,7,null]}}]})")}) {
    materials.text = text;
    const auto looks = shading::looks_of("m", materials, notes);
    ASSERT_EQ(looks.size(), 2u);
    for (const shading::Look& look : looks) {
      for (const shading::Source& source : look.maps) EXPECT_EQ(source.embedded, nullptr) << text.substr(0, 80);
      EXPECT_TRUE(look.base_colour.x >= 0 && look.base_colour.y <= 1 && look.base_colour.z == 1 && look.cutoff == 0);
    }
  }
}

TEST(Looks, have_the_figures_of_the_file) {
  std::vector<std::string> notes;
  Materials materials{.count = 1, .text = {}, .images = {"a", "b"}};
  materials.text = R"({"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0,1],"roughnessFactor":0.5,"metallicFactor":0.25,
    "metallicRoughnessTexture":{"index":1}},"normalTexture":{"index":0,"scale":0.5},"occlusionTexture":{"index":1,"strength":0.25},
    "alphaMode":"MASK","alphaCutoff":0.75}],"textures":[{"source":0},{"source":1}],"images":[{"bufferView":1},{"bufferView":0}]})";
  const auto looks = shading::looks_of("m", materials, notes);
  ASSERT_EQ(looks.size(), 1u);
  const shading::Look& look = looks[0];
  EXPECT_TRUE(look.base_colour == (Vec3{0.5f, 0.25f, 0}) && look.roughness == 0.5 && look.metallic == 0.25 && look.cutoff == 0.75);
  EXPECT_EQ(look.maps[0].embedded, nullptr);
  EXPECT_TRUE(look.maps[1].embedded == &materials.images[1] && look.maps[1].strength == 0.5);
  EXPECT_TRUE(look.maps[2].embedded == &materials.images[0] && look.maps[2].map == shading::Map::surface);
  EXPECT_TRUE(look.maps[3].embedded == &materials.images[0] && look.maps[3].strength == 0.25);
  EXPECT_TRUE(notes.empty());
}

}  // namespace
}  // namespace weft
