// Which vertices of a simulation a cache has, and in which order.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/cache.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using test::Folder;

// Three quads in a row. No face has the first vertex; the last two lie at one place; the fourth looks different in the last faces.
constexpr const char* kStrip =
    "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\nv 3 1 0\nvt 0 0\nvt 1 0\n"
    "f 2/1 3/1 7/1 6/1\nf 3/1 4/1 8/1 7/1\nf 4/2 5/1 10/1\nf 4/2 9/1 8/1\n";

struct Cooked {
  Scene scene = without_contacts();
  std::vector<Mesh> meshes;
  CookedFabric fabric;

  explicit Cooked(Scene described) : scene(std::move(described)), meshes(must(make_meshes(scene))), fabric(must(cook(scene, meshes))) {}
  CachedShape shape(CacheFormat format) const { return cached_shape(fabric, meshes, {}, format); }
};

/// As read_vertex_positions would have them: each vertex where its number says.
std::vector<Vec3> numbered(const CookedFabric& fabric) {
  std::vector<Vec3> list;
  for (std::uint32_t v = 0; v < drawn_vertices(fabric); ++v) list.push_back({static_cast<float>(v), 0, 0});
  return list;
}

Scene scene_of(const Folder& folder, const std::string& mesh) {
  Scene scene = without_contacts();
  scene.folder = folder / "";
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = mesh;
  cloth.tethers = false;
  return scene;
}

TEST(CacheShape, of_a_point_cache_has_the_files_own_vertices_in_their_order) {
  const Folder folder;
  folder.write("strip.obj", kStrip);
  const Cooked cooked(scene_of(folder, "strip.obj"));
  const CachedShape shape = cooked.shape(CacheFormat::pc2);
  EXPECT_EQ(shape.mesh.positions, (std::vector<Vec3>{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0},
                                                       {3, 1, 0}, {3, 1, 0}}));
  EXPECT_EQ(shape.vertices, (std::vector<std::uint32_t>{kNone, 0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_TRUE(shape.mesh.triangles.empty() && shape.mesh.normals.empty());
  const std::vector<Vec3> moved = cached_positions(shape, numbered(cooked.fabric));
  EXPECT_EQ(moved.front(), (Vec3{9, 9, 9})) << "it stays where it is";
  EXPECT_EQ(moved.back(), (Vec3{8, 0, 0}));
}

// As some programs write it: a vertex for every corner of every face.
TEST(CacheShape, of_a_point_cache_has_a_vertex_for_every_one_that_was_joined) {
  const Folder folder;
  folder.write("corners.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n");
  const Cooked cooked(scene_of(folder, "corners.obj"));
  EXPECT_EQ(cooked.shape(CacheFormat::mdd).vertices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST(CacheShape, of_the_others_has_what_is_drawn) {
  const Folder folder;
  folder.write("strip.obj", kStrip);
  const Cooked cooked(scene_of(folder, "strip.obj"));
  const RenderMesh& render = cooked.meshes[0].render;
  ASSERT_EQ(render.positions.size(), 10u) << "one corner looks different in its second face";
  for (const CacheFormat format : {CacheFormat::glb, CacheFormat::usda, CacheFormat::ply, CacheFormat::obj}) {
    const CachedShape shape = cooked.shape(format);
    EXPECT_EQ(shape.mesh.positions, render.positions);
    EXPECT_EQ(shape.mesh.normals, render.normals);
    EXPECT_EQ(shape.mesh.uvs, render.uvs);
    EXPECT_EQ(shape.mesh.triangles, render.triangles);
    EXPECT_EQ(shape.has_strain, format == CacheFormat::ply);
    EXPECT_EQ(cached_positions(shape, numbered(cooked.fabric)), numbered(cooked.fabric));
  }
}

TEST(CacheShape, of_several_cloths_is_one_mesh_without_the_mesh_colliders) {
  const Folder folder;
  folder.write("strip.obj", kStrip);
  Scene scene = scene_of(folder, "strip.obj");
  scene.contacts.enabled = true;
  Cloth& second = scene.cloths.emplace_back();
  second.grid = Grid{.cells_x = 1, .cells_y = 1};
  second.transform.translate = {0, 5, 0};
  Collider& body = scene.colliders.emplace_back();
  body.shape = ColliderShape::mesh;
  body.mesh = "strip.obj";
  const Cooked cooked(scene);
  const CachedShape points = cooked.shape(CacheFormat::mdd), drawn = cooked.shape(CacheFormat::glb);
  EXPECT_EQ(points.vertices, (std::vector<std::uint32_t>{kNone, 0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13}));
  EXPECT_EQ(drawn.vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(std::ranges::min(drawn.mesh.triangles.back()), 10u);
  EXPECT_EQ(drawn.mesh.positions[10].y, 5);
}

TEST(CacheShape, of_a_cloth_that_carries_a_render_mesh_is_this) {
  const Folder folder;
  folder.write("strip.obj", kStrip);
  Scene scene = without_contacts();
  scene.folder = folder / "";
  Cloth& coarse = scene.cloths.emplace_back();
  coarse.grid = Grid{.cells_x = 2, .cells_y = 2, .upright = true};
  coarse.render_mesh = "strip.obj";
  Cloth& other = scene.cloths.emplace_back();
  other.grid = Grid{.cells_x = 1, .cells_y = 1};
  const Cooked cooked(scene);
  const CachedShape points = cooked.shape(CacheFormat::pc2), drawn = cooked.shape(CacheFormat::usda);
  EXPECT_EQ(points.vertices, (std::vector<std::uint32_t>{kNone, 13, 14, 15, 16, 17, 18, 19, 20, 21, 9, 10, 11, 12}));
  EXPECT_EQ(drawn.vertices, (std::vector<std::uint32_t>{13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 9, 10, 11, 12}));
  EXPECT_FALSE(drawn.has_strain);
}

}  // namespace
}  // namespace weft
