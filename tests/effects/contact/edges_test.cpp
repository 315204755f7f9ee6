// What the cook makes for contacts: edges, rest poses, and mesh colliders.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "engine/effects/contact/clusters.h"
#include "tests/support/cooked.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

Scene two_sheets() {
  Scene scene;
  for (const double thickness : {0.002, 0.005}) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 2}, 5, 7, Topology::diagonal, false};
    cloth.fabric.thickness = thickness;
  }
  scene.cloths[1].transform.translate = {0, 1, 0};
  scene.contacts.enabled = true;
  return scene;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

TEST(FabricContacts, every_edge_of_every_triangle_is_there_once_with_its_lower_particle_first) {
  const CookedFabric fabric = cooked(two_sheets());
  std::set<Pair> wanted;
  for (const Triangle& t : fabric.triangles)
    for (int k = 0; k < 3; ++k) wanted.insert(std::minmax(t[k], t[(k + 1) % 3]));
  // Sheets of 5 x 7 cells: 5 x 8 + 6 x 7 sides and 35 diagonals each.
  ASSERT_EQ(fabric.edges.size(), 2u * (40 + 42 + 35));
  EXPECT_TRUE(std::equal(fabric.edges.begin(), fabric.edges.end(), wanted.begin(), wanted.end(),
                         [](gpu::uvec2 edge, const Pair& pair) { return edge.x == pair.first && edge.y == pair.second; }));
}

TEST(FabricContacts, rest_is_where_a_particle_starts_with_the_thickness_of_its_cloth) {
  Scene scene = two_sheets();
  for (Cloth& cloth : scene.cloths) cloth.start.imperfection = 0;
  const CookedFabric fabric = cooked(scene);
  ASSERT_EQ(fabric.rest.size(), fabric.positions.size());
  for (std::size_t i = 0; i < fabric.rest.size(); ++i) {
    const gpu::vec4 &rest = fabric.rest[i], &x = fabric.positions[i];
    EXPECT_TRUE(rest.x == x.x && rest.y == x.y && rest.z == x.z);
    EXPECT_EQ(rest.w, i < fabric.cloths[1].first_particle ? 0.002f : 0.005f);
  }
}

TEST(FabricContacts, the_mean_edge_is_that_of_all_edges) {
  const CookedFabric fabric = cooked(two_sheets());
  const double x = 0.2, z = 2.0 / 7;
  EXPECT_NEAR(fabric.mean_edge, (40 * x + 42 * z + 35 * std::hypot(x, z)) / 117, 1e-7);   // of single precision
}

// Two sheets that lie in each other at rest, one torn along its middle: clusters must keep apart what does not hang together.
CookedFabric tangled() {
  Scene scene = two_sheets();
  scene.cloths[1].transform.translate = {};
  CookedFabric fabric = cooked(scene);
  fabric.triangles.erase(fabric.triangles.begin() + 30, fabric.triangles.begin() + 40);
  return fabric;
}

TEST(FabricContacts, every_triangle_edge_and_particle_is_in_one_cluster_whose_hull_has_it) {
  for (const CookedFabric& fabric : {cooked(two_sheets()), tangled()}) {
    const ClusterLists lists = cooking::make_clusters(fabric);
    std::multiset<std::set<std::uint32_t>> wanted, found;
    for (const Triangle& t : fabric.triangles) wanted.insert({t[0], t[1], t[2]});
    for (const gpu::uvec4& face : lists.faces) found.insert({face.x, face.y, face.z});
    EXPECT_EQ(found, wanted);
    std::set<std::uint32_t> searching;
    for (const gpu::uvec2& searcher : lists.searchers) searching.insert(searcher.x);
    EXPECT_EQ(lists.searchers.size(), fabric.positions.size());
    EXPECT_EQ(searching.size(), fabric.positions.size());
    EXPECT_EQ(lists.clusters.back().x, lists.faces.size());
    EXPECT_EQ(lists.clusters.back().z, lists.hulls.size());
    for (std::uint32_t k = 0; k + 1 < lists.clusters.size(); ++k) {
      const gpu::uvec4 &first = lists.clusters[k], &end = lists.clusters[k + 1];
      std::set<std::uint32_t> hull(lists.hulls.begin() + first.z, lists.hulls.begin() + end.z), faces;
      EXPECT_LE(end.x - first.x, WEFT_CLUSTER);
      for (std::uint32_t f = first.x; f < end.x; ++f) {
        EXPECT_EQ(lists.faces[f].w, k);
        faces.insert({lists.faces[f].x, lists.faces[f].y, lists.faces[f].z});
      }
      EXPECT_TRUE(std::ranges::includes(hull, faces));
      for (std::uint32_t e = first.y; e < end.y; ++e) {
        EXPECT_EQ(lists.edges[e].z, k);
        EXPECT_TRUE(hull.contains(lists.edges[e].x) && hull.contains(lists.edges[e].y));
      }
      for (const gpu::uvec2& searcher : lists.searchers) EXPECT_EQ(searcher.y == k, searcher.y == k && hull.contains(searcher.x));
      // In one piece.
      std::set<std::uint32_t> reached;
      if (end.x > first.x) reached.insert(lists.faces[first.x].x);
      for (std::size_t before = 0; reached.size() != before;) {
        before = reached.size();
        for (std::uint32_t f = first.x; f < end.x; ++f) {
          const std::uint32_t corners[] = {lists.faces[f].x, lists.faces[f].y, lists.faces[f].z};
          const bool touches = std::ranges::any_of(corners, [&](std::uint32_t i) { return reached.contains(i); });
          if (touches) reached.insert(std::begin(corners), std::end(corners));
        }
      }
      EXPECT_EQ(reached, faces) << "cluster " << k;
    }
  }
}

TEST(FabricContacts, clusters_of_a_sheet_are_no_smaller_than_they_need_be) {
  Scene scene = two_sheets();
  for (Cloth& cloth : scene.cloths) cloth.grid->cells_x = cloth.grid->cells_y = 64;
  const ClusterLists lists = cooking::make_clusters(cooked(scene));
  const std::uint32_t a_sheet = std::bit_ceil((2 * 64 * 64 + WEFT_CLUSTER - 1) / WEFT_CLUSTER);   // halved until they fit
  EXPECT_EQ(lists.clusters.size() - 1, 2 * a_sheet);
}

// Of a sheet of 32 x 32 cells without the triangles that `torn` names, and bent at rest to a radius, if that is not 0.
ClusterLists sheet_clusters(double thickness, double radius, bool (*torn)(double x, double z)) {
  Scene scene = two_sheets();
  scene.cloths.resize(1);
  scene.cloths[0].grid = Grid{{1, 1}, 32, 32, Topology::diagonal, false};
  scene.cloths[0].fabric.thickness = thickness;
  CookedFabric fabric = cooked(scene);
  std::erase_if(fabric.triangles, [&](const Triangle& t) {
    double x = 0, z = 0;
    for (const std::uint32_t i : t) x += fabric.rest[i].x / 3, z += fabric.rest[i].z / 3;
    return torn(x, z);
  });
  for (gpu::vec4& x : fabric.rest)
    if (radius > 0) x = {float(radius * std::sin(x.x / radius)), float(radius * std::cos(x.x / radius)), x.z, x.w};
  return cooking::make_clusters(fabric);
}

std::size_t with_surroundings(const ClusterLists& lists) {
  return static_cast<std::size_t>(std::ranges::count_if(lists.surroundings, [](const gpu::uvec4& s) { return s.z > s.x; }));
}

TEST(FabricContacts, clusters_of_a_flat_sheet_know_those_about_them_unless_a_hole_or_a_slit_is_near) {
  const auto whole = [](double, double) { return false; };
  const ClusterLists lists = sheet_clusters(0.002, 0, whole);
  ASSERT_EQ(lists.surroundings.size(), lists.clusters.size() - 1);
  EXPECT_EQ(with_surroundings(lists), lists.surroundings.size());
  for (std::uint32_t k = 0; k < lists.surroundings.size(); ++k) {
    const gpu::uvec4& own = lists.surroundings[k];
    std::set<std::uint32_t> touching, listed(lists.around.begin() + own.x, lists.around.begin() + own.y);
    const auto corners = [&](std::uint32_t cluster) {
      std::set<std::uint32_t> all;
      for (const gpu::uvec4& face : lists.faces)
        if (face.w == cluster) all.insert({face.x, face.y, face.z});
      return all;
    };
    const std::set<std::uint32_t> mine = corners(k);
    for (std::uint32_t other = 0; other < lists.surroundings.size(); ++other)
      if (std::ranges::any_of(corners(other), [&](std::uint32_t i) { return mine.contains(i); })) touching.insert(other);
    EXPECT_EQ(listed, touching) << k;
    EXPECT_LE(own.y, own.z);
    // A tenth more than the thickness over the height of a triangle.
    EXPECT_NEAR(std::bit_cast<float>(own.w), 1.1 * 0.002 / (std::sqrt(0.5) / 32), 1e-5);
  }
  EXPECT_EQ(with_surroundings(sheet_clusters(0.03, 0, whole)), 0u) << "thicker than its triangles";
  EXPECT_EQ(with_surroundings(sheet_clusters(0.002, 0.5, whole)), 0u) << "not flat at rest";
  const ClusterLists holed = sheet_clusters(0.002, 0, [](double x, double z) { return std::max(std::abs(x), std::abs(z)) < 0.04; });
  EXPECT_GT(with_surroundings(holed), holed.surroundings.size() / 2);
  EXPECT_LT(with_surroundings(holed), holed.surroundings.size() - 8) << "a hole is in the way";
}

// A cluster that is pushed moves all corners of its triangles, also those that belong to another one.
TEST(FabricContacts, a_particle_is_a_member_of_its_own_cluster_first_and_of_all_whose_hulls_have_it) {
  const ClusterLists lists = cooking::make_clusters(cooked(two_sheets()));
  const std::vector<std::uint32_t>& list = lists.memberships;
  std::size_t others = 0;
  for (const auto& [i, own] : lists.searchers) {
    const std::vector<std::uint32_t> members(list.begin() + list[i], list.begin() + list[i + 1]);
    ASSERT_FALSE(members.empty());
    EXPECT_EQ(members[0], own);
    std::multiset<std::uint32_t> wanted;
    for (std::uint32_t k = 0; k + 1 < lists.clusters.size(); ++k)
      if (std::count(lists.hulls.begin() + lists.clusters[k].z, lists.hulls.begin() + lists.clusters[k + 1].z, i) > 0) wanted.insert(k);
    EXPECT_EQ(std::multiset<std::uint32_t>(members.begin(), members.end()), wanted) << i;
    others += members.size() - 1;
  }
  EXPECT_GT(others, 0u);
}

TEST(FabricContacts, particles_without_a_triangle_have_clusters_too) {
  CookedFabric fabric = cooked(two_sheets());
  fabric.triangles.clear();
  fabric.edges.clear();
  const ClusterLists lists = cooking::make_clusters(fabric);
  EXPECT_EQ(lists.clusters.size() - 1, (fabric.positions.size() + WEFT_CLUSTER - 1) / WEFT_CLUSTER);
  EXPECT_EQ(lists.hulls.size(), fabric.positions.size());
}

TEST(FabricContacts, without_contacts_there_is_nothing_but_the_number_of_triangles) {
  Scene scene = two_sheets();
  scene.contacts.enabled = false;
  const CookedFabric fabric = cooked(scene);
  EXPECT_TRUE(fabric.edges.empty());
  EXPECT_TRUE(fabric.rest.empty());
  EXPECT_EQ(fabric.mean_edge, 0);
  EXPECT_EQ(fabric.cloth_triangles, 2u * 70);
}

// A tetrahedron with hard edges: each of its faces has normals of its own.
constexpr const char* kTetrahedron = R"(v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
vn 0 0 -1
vn 0 -1 0
vn -1 0 0
vn 0.57735 0.57735 0.57735
f 1//1 3//1 2//1
f 1//2 2//2 4//2
f 1//3 4//3 3//3
f 2//4 3//4 4//4
)";

// The two sheets, and the tetrahedron twice as large a metre up, turned and between two other colliders.
Scene with_tetrahedron(const test::Folder& folder) {
  folder.write("tetrahedron.obj", kTetrahedron);
  Scene scene = two_sheets();
  scene.folder = folder / "";
  scene.contacts.enabled.reset();
  scene.colliders.resize(3);
  Collider& collider = scene.colliders[1];
  collider.shape = ColliderShape::mesh;
  collider.mesh = "tetrahedron.obj";
  collider.scale = 2;
  collider.centre = {0, 1, 0};
  collider.axis = {0, 1, 0};
  collider.degrees = 90;
  collider.friction = 0.7;
  collider.thickness = 0.01;
  return scene;
}

TEST(FabricContacts, a_mesh_collider_follows_the_cloths_and_nothing_moves_or_holds_it) {
  const test::Folder folder;
  const CookedFabric fabric = cooked(with_tetrahedron(folder));
  ASSERT_EQ(fabric.collider_meshes.size(), 1u);
  const ColliderMesh& mesh = fabric.collider_meshes[0];
  EXPECT_EQ(mesh.collider, 1u);
  EXPECT_EQ(mesh.first_particle, 2u * 48);
  EXPECT_EQ(mesh.particles, 4u);
  EXPECT_EQ(mesh.first_triangle, fabric.cloth_triangles);
  EXPECT_EQ(mesh.triangles, 4u);
  EXPECT_EQ(mesh.first_vertex, cloth_vertices(fabric));
  EXPECT_EQ(mesh.vertices, 12u);
  const std::size_t all = mesh.first_particle + mesh.particles;
  EXPECT_EQ(fabric.positions.size(), all);
  EXPECT_EQ(fabric.triangles.size(), mesh.first_triangle + mesh.triangles);
  EXPECT_EQ(fabric.surface_rows.size(), mesh.first_vertex + mesh.vertices);
  // One entry a particle, also where it has no row of its own to fill.
  for (const std::size_t size : {fabric.velocities.size(), fabric.split_weights.size(), fabric.iterate_weights.size(), fabric.rest.size(),
                                 fabric.stretch.rows.size(), fabric.bend.rows.size()})
    EXPECT_EQ(size, all);
  if (fabric.stretch.stride > 0) {
    EXPECT_EQ(fabric.stretch.pairs.size(), all * fabric.stretch.stride);
  }
  for (std::uint32_t i = mesh.first_particle; i < all; ++i) {
    EXPECT_EQ(fabric.positions[i].w, 0);
    EXPECT_EQ(fabric.iterate_weights[i], 0);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(fabric.velocities[i].w), 2u);
    EXPECT_EQ(fabric.stretch.rows[i].y, 0u);
    EXPECT_EQ(fabric.rest[i].w, 0.01f);
  }
  for (const StretchLink& link : fabric.links) EXPECT_LT(std::max(link.a, link.b), mesh.first_particle);
  for (const gpu::Bend& bend : fabric.bends) EXPECT_LT(*std::max_element(bend.particle, bend.particle + 4), mesh.first_particle);
  ASSERT_EQ(fabric.materials.size(), 3u);
  EXPECT_EQ(fabric.materials[2].damping_factor, 1);
  EXPECT_EQ(fabric.materials[2].friction, 0.7f);
  EXPECT_EQ(fabric.materials[2].thickness, 0.01f);
}

TEST(FabricContacts, a_mesh_collider_adds_its_edges_but_not_to_the_mean_edge) {
  const test::Folder folder;
  Scene scene = with_tetrahedron(folder);
  const CookedFabric with = cooked(scene);
  scene.colliders.clear();
  scene.contacts.enabled = true;
  const CookedFabric without = cooked(scene);
  EXPECT_EQ(with.edges.size(), without.edges.size() + 6);
  EXPECT_EQ(with.mean_edge, without.mean_edge);
}

TEST(FabricContacts, a_mesh_collider_is_scaled_turned_and_then_moved) {
  const test::Folder folder;
  Scene scene = with_tetrahedron(folder);
  const auto distance_to = [](const CookedFabric& fabric, Vec3 place) {
    float nearest = INFINITY;
    for (const gpu::vec4& p : std::span(fabric.positions).subspan(fabric.collider_meshes[0].first_particle))
      nearest = std::min(nearest, length(Vec3{p.x, p.y, p.z} - place));
    return nearest;
  };
  // A quarter turn about +y takes +x to -z and +z to +x.
  for (const Vec3 corner : {Vec3{0, 1, 0}, Vec3{0, 1, -2}, Vec3{0, 3, 0}, Vec3{2, 1, 0}})
    EXPECT_LT(distance_to(cooked(scene), corner), 1e-6f);
  scene.colliders[1].keys = {{0, {0, 0, 5}, {0, 1, 0}, 90}};
  for (const Vec3 corner : {Vec3{0, 1, 5}, Vec3{-2, 1, 5}, Vec3{0, 3, 5}, Vec3{0, 1, 3}})
    EXPECT_LT(distance_to(cooked(scene), corner), 1e-6f);
}

TEST(FabricContacts, hard_edges_of_a_mesh_collider_stay_hard) {
  const test::Folder folder;
  const CookedFabric fabric = cooked(with_tetrahedron(folder));
  for (std::uint32_t v = cloth_vertices(fabric); v < fabric.surface_rows.size(); ++v)
    EXPECT_EQ(fabric.surface_rows[v].z, 1u);   // a face's own corner
}

TEST(FabricContacts, a_mesh_collider_that_cannot_be_read_or_was_not_given_is_a_sentence) {
  const test::Folder folder;
  Scene scene = with_tetrahedron(folder);
  auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes) << meshes.error();
  meshes->pop_back();
  EXPECT_EQ(cook(scene, *meshes).error(), "the scene has 2 cloths, 1 mesh colliders and 0 render meshes but 2 meshes were given");
  folder.write("tetrahedron.obj", "no mesh at all");
  const auto broken = make_meshes(scene);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().find("colliders[1].mesh: "), 0u) << broken.error();
}

}  // namespace
}  // namespace weft
