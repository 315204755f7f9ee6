// Scenes that a program made are checked as scene files are: by the same table, with the same sentences.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "engine/fabric.h"
#include "tests/support/must.h"

namespace weft {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scene sound() {
  Scene scene;
  scene.cloths.emplace_back().grid = Grid{};
  scene.cloths[0].anchors.emplace_back().corners = {Corner::low_high};
  scene.colliders.emplace_back();
  return scene;
}

struct Flaw {
  const char* sentence;
  std::function<void(Scene&)> make;
};

const Flaw kFlaws[] = {
    {"contacts: are off, and colliders[0] is a mesh, which cloth meets through contacts alone",
     [](Scene& s) {
       s.contacts.enabled = false;
       s.colliders[0].shape = ColliderShape::mesh;
       s.colliders[0].mesh = "body.obj";
     }},
    {"cloths: is empty: at least 1 is needed", [](Scene& s) { s.cloths.clear(); }},
    {"cloths: 1025 entries are more than 1024", [](Scene& s) { s.cloths.assign(1025, s.cloths[0]); }},
    {"cloths[0].fabric.stretch: -5 is not above 0 (N/m)", [](Scene& s) { s.cloths[0].fabric.stretch = -5; }},
    {"cloths[0].fabric.shear: infinite, not finite", [](Scene& s) { s.cloths[0].fabric.shear = -INFINITY; }},
    {"cloths[0].fabric.thickness: -1 is less than 0 (m)", [](Scene& s) { s.cloths[0].fabric.thickness = -1; }},
    {"cloths[0].fabric.damping: -1000000000 is less than 0 (1/s)", [](Scene& s) { s.cloths[0].fabric.damping = -1e9; }},
    {"cloths[0].fabric.bend: 0 is not above 0 (N m)", [](Scene& s) { s.cloths[0].fabric.bend = 0; }},
    {"cloths[0].grid.size[0]: -1 is not above 0 (m)", [](Scene& s) { s.cloths[0].grid->size.x = -1; }},
    {"cloths[0].grid.cells[0]: 4000000000 is more than 2048", [](Scene& s) { s.cloths[0].grid->cells_x = 4'000'000'000; }},
    {"cloths[0].grid.cells[1]: 0 is less than 1", [](Scene& s) { s.cloths[0].grid->cells_y = 0; }},
    {"cloths[0].grid.topology: 7 is not the number of \"diagonal\" or \"centre\"",
     [](Scene& s) { s.cloths[0].grid->topology = Topology(7); }},
    {"cloths[0].transform.scale: -1 is not above 0", [](Scene& s) { s.cloths[0].transform.scale = -1; }},
    {"cloths[0].transform.axis: is a vector of length 0: a direction needs one above 1e-12",
     [](Scene& s) { s.cloths[0].transform.axis = {}; }},
    {"cloths[0].transform.translate[1]: not a number, not finite", [](Scene& s) { s.cloths[0].transform.translate.y = kNan; }},
    {"cloths[0].start.pose: -1 is not the number of", [](Scene& s) { s.cloths[0].start.pose = StartPose(-1); }},
    {"cloths[0]: has both a grid and a mesh: give one of them", [](Scene& s) { s.cloths[0].mesh = "flag.obj"; }},
    {"cloths[0].tethers.per_vertex: 9 is more than 8", [](Scene& s) { s.cloths[0].tethers_per_vertex = 9; }},
    {"cloths[0].tethers.slack: -0.5 is less than 0", [](Scene& s) { s.cloths[0].tether_slack = -0.5; }},
    {"air.density: -1 is less than 0 (kg/m^3)", [](Scene& s) { s.air.emplace().density = -1; }},
    {"air.wind[1]: ", [](Scene& s) { s.air.emplace().wind.y = std::numeric_limits<float>::quiet_NaN(); }},
    {"air.fields[0].radius: 0 is less than 0.001 (m)", [](Scene& s) { s.air.emplace().fields.emplace_back().radius = 0; }},
    {"air.fields[0].shape: 9 is not the number of", [](Scene& s) { s.air.emplace().fields.emplace_back().shape = Air::Field::Shape(9); }},
    {"air.gusts[0].period: 0 is less than 0.01 (s)", [](Scene& s) { s.air.emplace().gusts.push_back({{1, 0, 0}, 0}); }},
    {"cloths[0].springs.shear.stiffness: -1 is less than 0 (N/m)", [](Scene& s) { s.cloths[0].springs.emplace().shear.stiffness = -1; }},
    {"cloths[0].anchors[0].every: 0 is less than 1", [](Scene& s) { s.cloths[0].anchors[0].every = 0; }},
    {"cloths[0].anchors[0].corners[0]: 4 is not the number of", [](Scene& s) { s.cloths[0].anchors[0].corners[0] = Corner(4); }},
    {"cloths[0].anchors[0]: chooses no vertex", [](Scene& s) { s.cloths[0].anchors[0].corners.clear(); }},
    {"cloths[0].anchors[0].vertices[0]: 1089 is not a vertex, the grid has 1089",
     [](Scene& s) { s.cloths[0].anchors[0].vertices = {1089}; }},
    {"cloths[0].anchors[0].keys[1].time: 1 is not after 2 (s), the time of the key before",
     [](Scene& s) {
       s.cloths[0].anchors[0].keys.resize(2);
       s.cloths[0].anchors[0].keys[0].time = 2, s.cloths[0].anchors[0].keys[1].time = 1;
     }},
    {"cloths[0].anchors[0].keys[0].axis: is a vector of length 2, not 1",
     [](Scene& s) { s.cloths[0].anchors[0].keys.resize(1), s.cloths[0].anchors[0].keys[0].axis = {0, 2, 0}; }},
    {"colliders[0].normal: is a vector of length 0", [](Scene& s) { s.colliders[0].normal = {}; }},
    {"colliders[0].radius: -1 is not above 0 (m)", [](Scene& s) { s.colliders[0].radius = -1; }},
    {"colliders[0].shape: 99 is not the number of", [](Scene& s) { s.colliders[0].shape = ColliderShape(99); }},
    {"colliders: 1025 entries are more than 1024", [](Scene& s) { s.colliders.assign(1025, s.colliders[0]); }},
    {"solver.iterations: 0 is less than 1", [](Scene& s) { s.solver.iterations = 0; }},
    {"solver.method: 12 is not the number of", [](Scene& s) { s.solver.method = Method(12); }},
    {"solver.rate: not a number, not finite", [](Scene& s) { s.solver.rate = NAN; }},
    {"contacts.capacity: 4294967295 is more than 67108864", [](Scene& s) { s.contacts.capacity = UINT32_MAX; }},
    {"gravity[1]: infinite, not finite", [](Scene& s) { s.gravity.y = -INFINITY; }},
    {"camera.target: is where the eye is", [](Scene& s) { s.camera.target = s.camera.eye; }},
    {"light.direction: is a vector of length 0", [](Scene& s) { s.light.direction = {}; }},
};

TEST(SceneCheck, a_sound_scene_passes_and_every_flaw_is_a_sentence_with_its_path) {
  EXPECT_TRUE(check(sound())) << check(sound()).error();
  for (const Flaw& flaw : kFlaws) {
    Scene scene = sound();
    flaw.make(scene);
    const auto good = check(scene);
    ASSERT_FALSE(good) << flaw.sentence;
    EXPECT_NE(good.error().find(flaw.sentence), std::string::npos) << good.error();
    EXPECT_EQ(good.kind(), ErrorKind::input);
  }
}

TEST(SceneCheck, all_flaws_are_named_at_once) {
  Scene scene = sound();
  scene.cloths[0].fabric.stretch = -5;
  scene.colliders[0].friction = -1;
  const std::string fault = check(scene).error();
  EXPECT_NE(fault.find("cloths[0].fabric.stretch: -5"), std::string::npos);
  EXPECT_NE(fault.find("\ncolliders[0].friction: -1"), std::string::npos);
}

TEST(SceneCheck, what_a_file_may_say_a_program_may) {
  Scene scene = sound();
  scene.cloths[0].fabric.stretch = INFINITY;
  scene.cloths[0].grid.reset();   // the program gives its mesh
  scene.cloths[0].anchors[0].corners.clear();
  scene.cloths[0].anchors[0].top = 0;
  scene.light.direction = {0, -100, 0};
  scene.colliders[0].normal = {0.6f, 0.80001f, 0};
  EXPECT_TRUE(check(scene)) << check(scene).error();
}

// A file of two kilobytes must not claim gigabytes: sizes are added up before anything is made.
TEST(SceneCheck, grids_that_are_too_large_together_are_refused_before_they_are_made) {
  std::string text = R"({"cloths":[)";
  for (int k = 0; k < 64; ++k) text += std::string(k > 0 ? "," : "") + R"({"grid":{"cells":[2048,2048]}})";
  const auto read = parse_scene(text + "]}", {});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(),
            "cloths: their grids have 268697664 vertices together, more than the 4200000 that a scene may have: take fewer cells");
  Scene scene = sound();
  scene.cloths[0].grid->cells_x = scene.cloths[0].grid->cells_y = UINT32_MAX;
  EXPECT_NE(check(scene).error().find("cells[0]: 4294967295 is more than 2048"), std::string::npos) << check(scene).error();
  EXPECT_EQ(make_meshes(scene).error(),
            "cloths: their grids have 1.844674407e+19 vertices together, more than the 4200000 that a scene may have: take fewer cells");
}

}  // namespace
}  // namespace weft
