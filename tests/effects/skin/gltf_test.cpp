// Skins, animations and attributes as glTF files have them.
#include <gtest/gtest.h>

#include "engine/mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

// A square of two triangles, its left side on node 1, its right on node 2 below it, 1 m to the right, which an animation lifts.
Gltf character() {
  Gltf gltf;
  auto& primitive = gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  primitive["indices"] = gltf.indices16({0, 1, 2, 0, 2, 3});
  primitive["attributes"]["JOINTS_0"] = gltf.accessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 5121, "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] = gltf.accessor<std::uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 204, 51, 0, 0}, 5121, "VEC4", 4);
  gltf.json["accessors"].back()["normalized"] = true;
  primitive["attributes"]["COLOR_0"] = gltf.accessor<std::uint16_t>({65535, 0, 0, 0, 65535, 0, 0, 0, 0, 0, 0, 0}, 5123, "VEC3", 3);
  gltf.json["accessors"].back()["normalized"] = true;
  primitive["attributes"]["_REACH"] = gltf.accessor<float>({1, 2, 3, 4}, 5126, "SCALAR", 1);
  const std::size_t inverse = gltf.accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                                   5126, "MAT4", 16);
  gltf.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  gltf.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {9, 9, 9}}},
                        {{"name", "hip"}, {"children", {2}}},
                        {{"name", "hand"}, {"translation", {1, 0, 0}}}};
  gltf.json["scenes"] = {{{"nodes", {0, 1}}}};
  const std::size_t times = gltf.accessor<float>({0, 2}, 5126, "SCALAR", 1), up = gltf.vec3({1, 0, 0, 1, 4, 0});
  gltf.json["animations"] = {{{"name", "wave"},
                              {"samplers", {{{"input", times}, {"output", up}, {"interpolation", "LINEAR"}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  return gltf;
}

Mesh loaded(Gltf gltf) {
  const Folder folder;
  return must(load_mesh(gltf.write(folder)));
}

TEST(SkinOfGltf, carries_points_by_weights_of_any_type) {
  const Mesh mesh = loaded(character());
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  must(check(mesh));
  const Skin& skin = *mesh.skin;
  EXPECT_EQ(skin.joints[0].name, "hip");
  EXPECT_EQ(skin.joints[1].name, "hand");
  EXPECT_EQ(skin.weights[0], (std::array<float, 4>{1, 0, 0, 0}));
  EXPECT_FLOAT_EQ(skin.weights[3][0], 0.8f);
  ASSERT_EQ(skin.animations.size(), 1u);
  EXPECT_EQ(skin.animations[0].name, "wave");
  EXPECT_EQ(duration_of(skin.animations[0]), 2);
  for (const Affine& joint : joints_at(skin, kNone, 0)) EXPECT_EQ(joint, Affine{}) << "at rest";
  EXPECT_EQ(joints_at(skin, 0, 1)[0], Affine{});
  EXPECT_EQ((joints_at(skin, 0, 1)[1] * Vec3{1, 1, 0}), (Vec3{1, 3, 0}));
  EXPECT_EQ(mesh.attributes.at("COLOR_0")[1], (Vec4{0, 1, 0, 1}));
  EXPECT_EQ(mesh.attributes.at("_REACH")[2].x, 3);
  EXPECT_TRUE(mesh.mended.empty()) << mesh.mended[0];
}

// Scaled, turned and moved with the mesh.
TEST(SkinOfGltf, goes_with_the_mesh_s_transform) {
  Mesh mesh = loaded(character());
  transform_mesh(mesh, {.translate = {0, 0, 7}, .axis = {0, 0, 1}, .degrees = 90, .scale = 2});
  const Vec3 x = joints_at(*mesh.skin, 0, 1)[1] * Vec3{-2, 2, 7};   // (1, 1, 0) of the file, which goes up by 2 there
  EXPECT_NEAR(x.x, -6, 1e-5);
  EXPECT_NEAR(x.y, 2, 1e-5);
  EXPECT_NEAR(x.z, 7, 1e-5);
}

// What has no skin, beside what has one, goes with its node.
TEST(SkinOfGltf, a_mesh_without_a_skin_is_carried_by_its_node) {
  Gltf gltf = character();
  gltf.json["nodes"][2]["mesh"] = 0;
  const Mesh mesh = loaded(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  ASSERT_EQ(mesh.skin->joints.size(), 3u);
  const std::uint32_t point = mesh.point_of_source[7];   // (0, 1, 0) of the second, 1 m to the right: where the first's third vertex is, too
  EXPECT_EQ(mesh.points[point], (Vec3{1, 1, 0}));
  const std::uint32_t alone = mesh.point_of_source[5];
  EXPECT_EQ(mesh.points[alone], (Vec3{2, 0, 0}));
  EXPECT_EQ((joints_at(*mesh.skin, 0, 1)[mesh.skin->joints_of[alone][0]] * mesh.points[alone]), (Vec3{2, 2, 0}));
}

TEST(SkinOfGltf, eight_influences_become_the_four_largest) {
  Gltf gltf = character();
  auto& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
  std::vector<float> first{0.1f, 0.1f, 0.1f, 0.1f, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, second{0.6f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  attributes["JOINTS_1"] = gltf.accessor<std::uint8_t>({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] = gltf.vec4(first);
  attributes["WEIGHTS_1"] = gltf.vec4(second);
  const Mesh mesh = loaded(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  EXPECT_EQ(mesh.skin->joints_of[0][0], 1);
  EXPECT_FLOAT_EQ(mesh.skin->weights[0][0], 0.6f / 0.9f);
  EXPECT_FLOAT_EQ(mesh.skin->weights[0][3], 0.1f / 0.9f);
}

// The mesh is read without it, and says why; a scene that asks for the skin is refused with the same sentence.
TEST(SkinOfGltf, one_that_cannot_be_is_left_out_with_a_sentence) {
  const auto fault = [](auto&& spoil) {
    Gltf gltf = character();
    spoil(gltf);
    const Mesh mesh = loaded(gltf);
    EXPECT_FALSE(mesh.skin);
    EXPECT_EQ(mesh.mended, (std::vector<std::string>{"its skin was left out: " + mesh.skin_fault}));
    return mesh.skin_fault;
  };
  const auto attributes = [](Gltf& gltf) -> nlohmann::json& { return gltf.json["meshes"][0]["primitives"][0]["attributes"]; };
  EXPECT_EQ(fault([](Gltf& g) { g.json["skins"] = nlohmann::json::array(); }), "a node's \"skin\" points to 0 of 0");
  EXPECT_EQ(fault([](Gltf& g) { g.json["skins"][0]["joints"] = {1, 7}; }), "skin 0 has the joint 7, and there are 3 nodes");
  EXPECT_EQ(fault([](Gltf& g) { g.json["skins"][0]["joints"] = nlohmann::json::array(); }), "skin 0 has no joints");
  EXPECT_EQ(fault([](Gltf& g) { g.json["skins"][0]["joints"] = {1, 2, 0}; }), "skin 0 has 3 joints and 2 inverse bind matrices");
  EXPECT_EQ(fault([&](Gltf& g) { attributes(g).erase("WEIGHTS_0"); }), "\"WEIGHTS_0\" points to nothing of a list of 9");
  const std::vector<std::uint8_t> nines(16, 9);
  EXPECT_EQ(fault([&](Gltf& g) { attributes(g)["JOINTS_0"] = g.accessor<std::uint8_t>(nines, 5121, "VEC4", 4); }),
            "vertex 0 has joint 9 of 2");
  EXPECT_EQ(fault([&](Gltf& g) { attributes(g)["WEIGHTS_0"] = g.vec4(std::vector<float>(16, 0.3f)); }), "skin.weights[0]: their sum is 1.2, not 1");
  EXPECT_EQ(fault([](Gltf& g) { g.json["animations"][0]["channels"] = nlohmann::json::array(); }), "animation 0 has no channels");
  EXPECT_EQ(fault([](Gltf& g) { g.json["animations"][0]["channels"][0]["target"]["node"] = 5; }), "animation 0 moves node 5 of 3");
  EXPECT_EQ(fault([](Gltf& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = "BOUNCE"; }), "animation 0 has the interpolation \"BOUNCE\"");
  EXPECT_EQ(fault([](Gltf& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }),
            "skin.animations[0].channels[0]: has 2 values, and its times need 6");
}

}  // namespace
}  // namespace weft
