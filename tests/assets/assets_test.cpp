// What assets/ ships: scenes that load without a complaint and whose files are there, and meshes that are what the script
// that makes them says.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/mesh.h"
#include "engine/scene.h"

#ifndef WEFT_ASSETS
#define WEFT_ASSETS "assets"
#endif

namespace weft {
namespace {

const std::filesystem::path kAssets = WEFT_ASSETS;

TEST(Assets, every_scene_loads_and_every_file_it_names_is_there) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kAssets / "scenes")) {
    if (entry.path().extension() != ".json") continue;
    ++scenes;
    const Result<Scene> scene = load_scene(entry.path());
    ASSERT_TRUE(scene) << entry.path() << ": " << scene.error();
    for (const Cloth& cloth : scene->cloths)
      for (const std::string& file : {cloth.mesh, cloth.appearance.albedo, cloth.appearance.normal, cloth.appearance.roughness,
                                      cloth.appearance.occlusion})
        EXPECT_TRUE(file.empty() || std::filesystem::is_regular_file(scene->folder / file)) << entry.path() << ": " << file;
  }
  EXPECT_GE(scenes, 5);
}

TEST(Assets, the_curtain_is_sewn_along_its_seam) {
  const Result<Mesh> mesh = load_mesh(kAssets / "generated/curtain.glb");
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->render.positions.size(), 2u * 49 * 73);
  EXPECT_EQ(mesh->points.size(), 97u * 73);
  EXPECT_EQ(mesh->triangles.size(), 2u * 96 * 72);
  EXPECT_TRUE(mesh->mended.empty());
  const auto rim = std::count_if(mesh->edges.begin(), mesh->edges.end(), [](const WingedEdge& edge) { return edge.triangle[1] == kNone; });
  EXPECT_EQ(rim, 2 * (96 + 72));   // an open seam would add twice 72
}

TEST(Assets, each_ring_of_the_curtain_holds_one_place_of_its_top_edge) {
  const Result<Scene> scene = load_scene(kAssets / "scenes/curtain.json");
  ASSERT_TRUE(scene) << scene.error();
  const Cloth& cloth = scene->cloths.front();
  Result<Mesh> mesh = load_mesh(scene->folder / cloth.mesh);
  ASSERT_TRUE(mesh) << mesh.error();
  transform_mesh(*mesh, cloth.transform);
  for (const Anchor& ring : cloth.anchors) {
    ASSERT_TRUE(ring.box);
    std::set<std::uint32_t> points;
    for (std::size_t v = 0; v < mesh->render.positions.size(); ++v) {
      const Vec3 p = mesh->render.positions[v];
      const Vec3 low = ring.box->low, high = ring.box->high;
      if (p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z)
        points.insert(mesh->point_of[v]);
    }
    EXPECT_EQ(points.size(), 1u) << "around x = " << ring.box->low.x << " m";
  }
}

TEST(Assets, the_table_is_one_closed_surface_with_hard_edges) {
  const Result<Mesh> mesh = load_mesh(kAssets / "generated/table.glb");
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_TRUE(mesh->mended.empty());
  for (const WingedEdge& edge : mesh->edges) EXPECT_TRUE(edge.triangle[0] != kNone && edge.triangle[1] != kNone);
  EXPECT_EQ(mesh->points.size() + mesh->triangles.size(), mesh->edges.size() + 2) << "Euler: a sphere, since legs are no handles";
  double volume = 0;   // above 0: its triangles face outwards
  for (const auto& [a, b, c] : mesh->triangles) volume += dot(mesh->points[a], cross(mesh->points[b], mesh->points[c])) / 6;
  EXPECT_NEAR(volume, 0.9 * 0.9 * 0.04 + 4 * 0.075 * 0.075 * 0.68, 1e-6);
  EXPECT_GT(mesh->render.positions.size(), mesh->points.size());
}

TEST(Assets, the_balloon_and_the_cushion_are_closed_and_face_outwards) {
  for (const auto& [name, low, high] : {std::tuple("balloon", 0.065, 0.06545), std::tuple("cushion", 0.002, 0.00204)}) {
    const Result<Mesh> mesh = load_mesh(kAssets / "generated" / (std::string(name) + ".glb"));
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_TRUE(mesh->mended.empty());
    for (const WingedEdge& edge : mesh->edges) EXPECT_TRUE(edge.triangle[0] != kNone && edge.triangle[1] != kNone);
    EXPECT_EQ(mesh->points.size() + mesh->triangles.size(), mesh->edges.size() + 2) << "Euler: a sphere";
    double volume = 0;
    for (const auto& [a, b, c] : mesh->triangles) volume += dot(mesh->points[a], cross(mesh->points[b], mesh->points[c])) / 6;
    EXPECT_TRUE(volume > low && volume < high) << name << ": " << volume << " m^3";
  }
}

TEST(Assets, the_sleeper_breathes_and_turns_and_faces_up) {
  const Result<Mesh> mesh = load_mesh(kAssets / "generated/sleeper.glb");
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_TRUE(mesh->mended.empty());
  for (const Vec3& normal : mesh->render.normals) EXPECT_GT(normal.y, 0.3f);
  ASSERT_TRUE(mesh->skin) << mesh->skin_fault;
  ASSERT_EQ(mesh->skin->morphs.size(), 2u);
  EXPECT_EQ(mesh->skin->morphs[0].name, "breath");
  EXPECT_LT(mesh->skin->morphs[0].points.size(), mesh->points.size() / 3) << "it moves the chest alone";
  EXPECT_NEAR(weights_at(*mesh->skin, 0, 1.4)[0], 1, 1e-6);
  EXPECT_EQ(weights_at(*mesh->skin, 0, duration_of(mesh->skin->animations[0])), (std::vector<float>{0, 0})) << "so that it can begin anew";
}

TEST(Assets, the_table_linen_is_sewn_along_its_seam) {
  const Result<Mesh> mesh = load_mesh(kAssets / "generated/table_linen.glb");
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_TRUE(mesh->mended.empty());
  EXPECT_EQ(mesh->render.positions.size(), 2u * 31 * 61);
  EXPECT_EQ(mesh->points.size(), 61u * 61);
  const auto rim = std::count_if(mesh->edges.begin(), mesh->edges.end(), [](const WingedEdge& edge) { return edge.triangle[1] == kNone; });
  EXPECT_EQ(rim, 4 * 60);
  for (const Vec3& normal : mesh->render.normals) EXPECT_EQ(normal.y, 1.0f);
}

TEST(Assets, the_tablecloth_is_whole_and_faces_up) {
  const Result<Mesh> mesh = load_mesh(kAssets / "generated/tablecloth.glb");
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->points.size(), 65u * 65);
  for (const Vec3& normal : mesh->render.normals) EXPECT_EQ(normal.y, 1.0f);
}

}  // namespace
}  // namespace weft
