// Morph targets as glTF files have them, with the animations of their weights.
#include <gtest/gtest.h>

#include "engine/mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using test::Folder;
using test::Gltf;

// A square of two triangles that faces +z. The first target moves two vertices up and turns their normals to +y, the second moves another by
// a sparse accessor.
Gltf face() {
  Gltf gltf;
  auto& primitive = gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  primitive["indices"] = gltf.indices16({0, 1, 2, 0, 2, 3});
  primitive["attributes"]["NORMAL"] = gltf.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const std::size_t up = gltf.vec3({0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 4, 0}), turn = gltf.vec3({0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0});
  const std::size_t places = gltf.indices16({2}), moves = gltf.vec3({0, 0, 3});
  const auto view = [&](std::size_t accessor) { return gltf.json["accessors"][accessor]["bufferView"]; };
  gltf.json["accessors"].push_back(
      {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"},
       {"sparse", {{"count", 1}, {"indices", {{"bufferView", view(places)}, {"componentType", 5123}}}, {"values", {{"bufferView", view(moves)}}}}}});
  const std::size_t sparse = gltf.json["accessors"].size() - 1;
  primitive["targets"] = {{{"POSITION", up}, {"NORMAL", turn}}, {{"POSITION", sparse}}};
  gltf.json["meshes"][0]["weights"] = {0.5, 0};
  gltf.json["meshes"][0]["extras"] = {{"targetNames", {"smile", "frown"}}};
  return gltf;
}

void animate(Gltf& gltf, const std::vector<float>& times, const std::vector<float>& weights, const char* between) {
  const std::size_t input = gltf.accessor<float>(times, 5126, "SCALAR", 1), output = gltf.accessor<float>(weights, 5126, "SCALAR", 1);
  gltf.json["animations"] = {{{"name", "talk"},
                              {"samplers", {{{"input", input}, {"output", output}, {"interpolation", between}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
}

Mesh loaded_face(Gltf gltf) {
  const Folder folder;
  return must(load_mesh(gltf.write(folder)));
}

TEST(SkinMorphOfGltf, has_deltas_names_and_weights_and_sparse_accessors_are_read) {
  const Mesh mesh = loaded_face(face());
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  must(check(mesh));
  EXPECT_TRUE(mesh.mended.empty()) << mesh.mended[0];
  ASSERT_EQ(mesh.skin->joints.size(), 1u) << "of its node";
  ASSERT_EQ(mesh.skin->morphs.size(), 2u);
  const Skin::Morph &smile = mesh.skin->morphs[0], &frown = mesh.skin->morphs[1];
  EXPECT_EQ(smile.name, "smile");
  EXPECT_EQ(smile.points, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(smile.deltas, (std::vector<Vec3>{{0, 2, 0}, {0, 4, 0}}));
  EXPECT_EQ(smile.normal_deltas, (std::vector<Vec3>{{0, 1, -1}, {0, 0, 0}}));
  EXPECT_EQ(frown.points, (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(frown.deltas, (std::vector<Vec3>{{0, 0, 3}}));
  EXPECT_TRUE(frown.normal_deltas.empty());
  EXPECT_EQ(weights_at(*mesh.skin, kNone, 0), (std::vector<float>{0.5f, 0}));
  EXPECT_EQ(mesh.points[1], (Vec3{1, 0, 0})) << "it has its base shape";
}

// A node turns, scales and mirrors the deltas of what it shows, and its own weights go before those of the mesh. Shown twice, a mesh has its
// targets twice.
TEST(SkinMorphOfGltf, goes_with_its_node_and_with_the_mesh_s_transform) {
  Gltf gltf = face();
  gltf.json["nodes"] = {{{"mesh", 0}, {"scale", {-2, 3, 1}}, {"weights", {0, 0.25}}}, {{"mesh", 0}, {"translation", {0, 9, 0}}}};
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  Mesh mesh = loaded_face(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  ASSERT_EQ(mesh.skin->morphs.size(), 4u);
  EXPECT_EQ(weights_at(*mesh.skin, kNone, 0), (std::vector<float>{0, 0.25f, 0.5f, 0}));
  const Skin::Morph &first = mesh.skin->morphs[0], &second = mesh.skin->morphs[2];
  EXPECT_EQ(first.deltas, (std::vector<Vec3>{{0, 6, 0}, {0, 12, 0}}));
  EXPECT_EQ(mesh.points[first.points[0]], (Vec3{-2, 0, 0}));
  EXPECT_NEAR(first.normal_deltas[0].y, 1 / 3.0, 1e-6) << "as normals turn, and by their length";
  EXPECT_NEAR(first.normal_deltas[0].z, -1, 1e-6);
  EXPECT_EQ(second.deltas, (std::vector<Vec3>{{0, 2, 0}, {0, 4, 0}}));
  EXPECT_EQ(mesh.points[second.points[0]], (Vec3{1, 9, 0}));
  transform_mesh(mesh, {.translate = {0, 0, 7}, .axis = {0, 0, 1}, .degrees = 90, .scale = 2});
  EXPECT_NEAR(mesh.skin->morphs[2].deltas[0].x, -4, 1e-5);
  EXPECT_NEAR(mesh.skin->morphs[2].normal_deltas[0].x, -1, 1e-5);
  must(check(mesh));
}

TEST(SkinMorphOfGltf, of_a_file_without_nodes_is_read_too) {
  Gltf gltf = face();
  for (const char* key : {"nodes", "scenes", "scene"}) gltf.json.erase(key);
  const Mesh mesh = loaded_face(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  EXPECT_EQ(mesh.skin->morphs.size(), 2u);
}

// Extras may be anything, and weights that are of no targets are nobody's.
TEST(SkinMorphOfGltf, extras_are_no_matter_and_nor_are_weights_without_targets) {
  for (const nlohmann::json& extras : {nlohmann::json(5), nlohmann::json{{"targetNames", "no list"}}, nlohmann::json{{"targetNames", {1}}}}) {
    Gltf gltf = face();
    gltf.json["meshes"][0]["extras"] = extras;
    const Mesh mesh = loaded_face(gltf);
    ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
    EXPECT_EQ(mesh.skin->morphs[0].name, "");
  }
  Gltf gltf = face();
  gltf.json["meshes"].push_back(gltf.json["meshes"][0]);
  gltf.json["meshes"][1]["primitives"][0].erase("targets");
  gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}, {"translation", {5, 0, 0}}}};
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  const Mesh mesh = loaded_face(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  EXPECT_EQ(mesh.skin->morphs.size(), 2u);
}

// Vertices that only differ in their normals are one point, whose first vertex decides; copies that agree in all are joined.
TEST(SkinMorphOfGltf, follows_vertices_that_become_one_point) {
  Gltf gltf;
  auto& primitive = gltf.primitive(gltf.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}));   // a vertex for every corner
  primitive["targets"] = {{{"POSITION", gltf.vec3({1, 0, 0, 2, 0, 0, 3, 0, 0, 1, 0, 0, 3, 0, 0, 4, 0, 0})}}};
  const Mesh mesh = loaded_face(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  ASSERT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.skin->morphs[0].deltas, (std::vector<Vec3>{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}));
}

TEST(SkinMorphOfGltf, weights_are_animated_by_steps_lines_and_cubics) {
  Gltf gltf = face();
  animate(gltf, {0, 2}, {0, 1, 1, 0}, "LINEAR");
  Mesh mesh = loaded_face(gltf);
  ASSERT_TRUE(mesh.skin) << mesh.skin_fault;
  EXPECT_EQ(duration_of(mesh.skin->animations[0]), 2);
  EXPECT_EQ(weights_at(*mesh.skin, 0, 0.5), (std::vector<float>{0.25f, 0.75f}));
  EXPECT_EQ(weights_at(*mesh.skin, 0, 5), (std::vector<float>{1, 0}));
  EXPECT_EQ(joints_at(*mesh.skin, 0, 0.5)[0], Affine{}) << "its node stays";
  animate(gltf, {0, 2}, {0, 1, 1, 0}, "STEP");
  mesh = loaded_face(gltf);
  EXPECT_EQ(weights_at(*mesh.skin, 0, 1.9), (std::vector<float>{0, 1}));
  // Times 1 and 3; of each the in-tangents, the weights, the out-tangents. With the tangents of t^2 - 2t + 1 the first is that parabola.
  animate(gltf, {1, 3}, {9, 9, 0, 1, 0, 0, 4, 0, 4, 1, 9, 9}, "CUBICSPLINE");
  mesh = loaded_face(gltf);
  EXPECT_NEAR(weights_at(*mesh.skin, 0, 2)[0], 1, 1e-6);
  EXPECT_NEAR(weights_at(*mesh.skin, 0, 2)[1], 1, 1e-6);
  // As integers that stand for fractions.
  gltf = face();
  animate(gltf, {0, 1}, {0, 0, 0, 0}, "LINEAR");
  gltf.json["animations"][0]["samplers"][0]["output"] = gltf.accessor<std::uint8_t>({0, 255, 255, 51}, 5121, "SCALAR", 1);
  gltf.json["accessors"].back()["normalized"] = true;
  EXPECT_EQ(weights_at(*loaded_face(gltf).skin, 0, 1), (std::vector<float>{1, 0.2f}));
}

// The mesh is read without skin and targets, and says why.
TEST(SkinMorphOfGltf, that_cannot_be_is_left_out_with_a_sentence) {
  const auto fault = [](auto&& spoil) {
    Gltf gltf = face();
    animate(gltf, {0, 2}, {0, 1, 1, 0}, "LINEAR");
    spoil(gltf);
    const Mesh mesh = loaded_face(gltf);
    EXPECT_FALSE(mesh.skin);
    EXPECT_EQ(mesh.mended.at(0), "its skin was left out: " + mesh.skin_fault);
    return mesh.skin_fault;
  };
  const auto target = [](Gltf& gltf, std::size_t m) -> nlohmann::json& { return gltf.json["meshes"][0]["primitives"][0]["targets"][m]; };
  const auto sparse = [&](Gltf& gltf) -> nlohmann::json& { return gltf.json["accessors"][target(gltf, 1)["POSITION"].get<std::size_t>()]["sparse"]; };
  EXPECT_EQ(fault([](Gltf& g) { g.json["meshes"][0]["weights"] = {1}; }), "a mesh has 2 morph targets and 1 weights");
  EXPECT_EQ(fault([](Gltf& g) { g.json["meshes"][0]["weights"][1] = "x"; }), "the weight of morph target 1 is \"x\", not a number");
  EXPECT_EQ(fault([&](Gltf& g) { target(g, 0)["POSITION"] = g.vec3({0, 0, 0}); }),
            "a primitive has 4 positions but 1 of POSITION in morph target 0");
  EXPECT_EQ(fault([&](Gltf& g) { target(g, 0)["NORMAL"] = g.vec3({0, 0, 0}); }), "a primitive has 4 positions but 1 of NORMAL in morph target 0");
  EXPECT_EQ(fault([&](Gltf& g) { target(g, 0)["POSITION"] = g.vec3({0, 0, 0, 0, NAN, 0, 0, 0, 0, 0, 0, 0}); }),
            "morph target 0 has a POSITION that is not finite, or of 1e+10 or more");
  EXPECT_EQ(fault([&](Gltf& g) { target(g, 0)["POSITION"] = 99; }).substr(0, 30), "\"POSITION\" points to 99 of a l");
  EXPECT_EQ(fault([&](Gltf& g) { sparse(g)["indices"]["bufferView"] = 77; }).substr(0, 22), "\"bufferView\" points to");
  EXPECT_EQ(fault([&](Gltf& g) { sparse(g)["count"] = 9; }),
            "the accessor of \"POSITION\" reaches past the end of its buffer view: 9 elements in 2 bytes");
  EXPECT_EQ(fault([&](Gltf& g) { sparse(g).erase("values"); }), "the accessor of \"POSITION\" has no \"bufferView\", and so nothing that can be read");
  EXPECT_EQ(fault([&](Gltf& g) { g.json["accessors"][target(g, 1)["POSITION"].get<std::size_t>()]["count"] = 2; }),
            "the sparse accessor of \"POSITION\" changes element 2 of 2, or not after the one before");
  EXPECT_EQ(fault([](Gltf& g) { animate(g, {0, 2}, {0, 1, 1}, "LINEAR"); }), "animation 0 has 3 weights, and 2 times of 2 morph targets need 4");
  EXPECT_EQ(fault([](Gltf& g) { animate(g, {0, 2}, {0, 1, 1, 0}, "CUBICSPLINE"); }),
            "animation 0 has 4 weights, and 2 times of 2 morph targets need 12");
  EXPECT_EQ(fault([](Gltf& g) { animate(g, {0, 2}, {0, 1, NAN, 0}, "LINEAR"); }), "skin.animations[0].channels[0]: has a value that is not finite");
  EXPECT_EQ(fault([&](Gltf& g) {
              auto& primitives = g.json["meshes"][0]["primitives"];
              primitives.push_back(primitives[0]);
              primitives[1]["targets"].erase(1);
            }),
            "the primitives of a mesh have 2 and 1 morph targets");
  EXPECT_EQ(fault([&](Gltf& g) {
              nlohmann::json& targets = g.json["meshes"][0]["primitives"][0]["targets"];
              while (targets.size() <= kMostMorphs) targets.push_back(targets[1]);
            }),
            "it has 1025 morph targets or more; at most 1024 are allowed");
}

// What a program makes is checked the same way.
TEST(SkinMorphs, that_cannot_be_are_refused) {
  const auto fault = [](auto&& spoil) {
    Mesh mesh = make_grid({{1, 1}, 2, 2, Topology::diagonal, false});
    mesh.skin.emplace().morphs = {{"up", 0, {0, 4}, {{0, 1, 0}, {0, 2, 0}}, {}}};
    mesh.skin->animations.push_back({"it", {{0, Skin::Moves::weight, Skin::Interpolation::linear, {0, 1}, {{}, {1, 0, 0, 0}}}}});
    EXPECT_TRUE(check(mesh)) << "without joints";
    spoil(*mesh.skin);
    const auto good = check(mesh);
    return good ? std::string() : good.error();
  };
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].points[1] = 9; }), "skin.morphs[0]: point 9 is not one of the 9, or not after the one before");
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].points[1] = 0; }), "skin.morphs[0]: point 0 is not one of the 9, or not after the one before");
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].deltas.pop_back(); }), "skin.morphs[0]: moves 2 points, and has 1 deltas and 0 of normals");
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].normal_deltas.resize(1); }), "skin.morphs[0]: moves 2 points, and has 2 deltas and 1 of normals");
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].deltas[1].x = NAN; }), "skin.morphs[0]: the delta of point 4 is not finite, or of 1e+10 m or more");
  EXPECT_EQ(fault([](Skin& s) { s.morphs[0].weight = INFINITY; }), "skin.morphs[0]: its weight is not finite");
  EXPECT_EQ(fault([](Skin& s) { s.animations[0].channels[0].node = 1; }), "skin.animations[0].channels[0]: morph target 1 is not one of the 1");
  EXPECT_EQ(fault([](Skin& s) { s.morphs.resize(2000); }), "skin.morphs: 2000 are more than 1024");
  EXPECT_EQ(fault([](Skin& s) { s.weights.resize(9); }), "skin: has weights of 9 and joints of 0 points, and there are 0");
  EXPECT_EQ(fault([](Skin& s) { s.morphs.clear(); }), "skin.joints: 0 are not 1 to 65535");
}

}  // namespace
}  // namespace weft
