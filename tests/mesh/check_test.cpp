// Meshes that a program made: nothing that is used as an index may lead out of its list.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "engine/fabric.h"
#include "tests/support/must.h"

namespace weft {
namespace {

struct Flaw {
  const char* sentence;
  std::function<void(Mesh&)> make;
};

const Flaw kFlaws[] = {
    {"it has no vertex", [](Mesh& m) { m = {}; }},
    {"it has no triangle", [](Mesh& m) { m.triangles.clear(), m.render.triangles.clear(), m.edges.clear(); }},
    {"render.normals has 8 entries, and render.positions has 9", [](Mesh& m) { m.render.normals.pop_back(); }},
    {"render.uvs has 0 entries", [](Mesh& m) { m.render.uvs.clear(); }},
    {"point_of has 8 entries", [](Mesh& m) { m.point_of.pop_back(); }},
    {"render.triangles has 7 entries, and triangles has 8", [](Mesh& m) { m.render.triangles.pop_back(); }},
    {"points[4]: (nan", [](Mesh& m) { m.points[4].x = NAN; }},
    {"render.positions[2]: (1e+20", [](Mesh& m) { m.render.positions[2].x = 1e20f; }},
    {"point_of[3]: 9 is not one of the 9 points", [](Mesh& m) { m.point_of[3] = 9; }},
    {"point_of_source[3]: 9 is not one of the 9 points", [](Mesh& m) { m.point_of_source[3] = 9; }},
    {"loose has 0 entries, and 1 of point_of_source are of no point", [](Mesh& m) { m.point_of_source[3] = kNone; }},
    {"loose[0]: (inf", [](Mesh& m) { m.point_of_source[3] = kNone, m.loose = {{INFINITY, 0, 0}}; }},
    {"points[9]: no render vertex belongs to it", [](Mesh& m) { m.points.push_back({}); }},
    {"triangles[5]: 4294967295 is not one of the 9 points", [](Mesh& m) { m.triangles[5][1] = kNone; }},
    {"render.triangles[0]: 100 is not one of the 9 vertices", [](Mesh& m) { m.render.triangles[0][2] = 100; }},
    {"render.triangles[0]: vertex 8 belongs to point 8, and triangles has", [](Mesh& m) { m.render.triangles[0][2] = 8; }},
    {"spare_vertices: 9 of 9 vertices leave none to draw", [](Mesh& m) { m.spare_vertices = 9; }},
    {"8 is not one of the 8 vertices", [](Mesh& m) { m.spare_vertices = 1; }},
    {"triangles[0]: has a point twice",
     [](Mesh& m) { m.triangles[0][2] = m.triangles[0][1], m.render.triangles[0][2] = m.render.triangles[0][1]; }},
    {"edges[0]: 0 and 99 are not two of the 9 points", [](Mesh& m) { m.edges[0].a = 0, m.edges[0].b = 99; }},
    {"edges[1]: is not after the one before", [](Mesh& m) { std::swap(m.edges[0], m.edges[1]); }},
    {"edges[2]: triangle 8", [](Mesh& m) { m.edges[2].triangle[0] = 8; }},
    {"edges[0]: has a triangle without the point across", [](Mesh& m) { m.edges[0].across[0] = kNone; }},
};

TEST(MeshCheck, a_sound_mesh_passes_and_every_flaw_is_a_sentence_that_cooking_says_too) {
  Scene scene;
  scene.cloths.emplace_back();
  const Mesh sound = make_grid({{1, 1}, 2, 2, Topology::diagonal, false});
  ASSERT_TRUE(check(sound)) << check(sound).error();
  ASSERT_TRUE(cook(scene, std::span(&sound, 1)));
  for (const Flaw& flaw : kFlaws) {
    Mesh mesh = sound;
    flaw.make(mesh);
    const auto good = check(mesh);
    ASSERT_FALSE(good) << flaw.sentence;
    EXPECT_NE(good.error().find(flaw.sentence), std::string::npos) << good.error();
    const auto fabric = cook(scene, std::span(&mesh, 1));
    ASSERT_FALSE(fabric) << flaw.sentence;
    EXPECT_EQ(fabric.error(), "cloths[0]: its mesh: " + good.error());
  }
}

}  // namespace
}  // namespace weft
