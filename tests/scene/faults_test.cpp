// Scenes that are refused: every fault with its path, its value and the limit it broke.
#include "tests/support/scene_texts.h"

using namespace weft;
using namespace weft::scene_test;

namespace {

struct Broken {
  std::string text, sentence;
};

void expect_refused(std::initializer_list<Broken> scenes) {
  for (const Broken& scene : scenes) {
    const std::string fault = fault_of(scene.text);
    EXPECT_TRUE(mentions(fault, scene.sentence)) << "said:     " << fault << "\nexpected: " << scene.sentence;
  }
}

std::string many(const std::string& entry, int count) {
  std::string all = entry;
  for (int i = 1; i < count; ++i) all += ", " + entry;
  return "[" + all + "]";
}

}  // namespace

TEST(BrokenScene, what_is_not_json_is_told_with_line_and_column) {
  expect_refused({
      Broken{"", "scene: is empty"}, Broken{" \n\t ", "scene: is empty"}, Broken{"[]", "scene: a list of 0, not an object"},
      Broken{"3", "scene: 3, not an object"}, Broken{"null", "scene: null, not an object"},
      Broken{"{", "line 1, column 2: the text ends too early"}, Broken{R"({"cloths": [{"gri)", "the text ends too early"},
      Broken{"{\n  \"frames\": 3,\n}", "line 3, column 1: this is not JSON"},
      Broken{R"({"frames": NaN})", "line 1, column 12: this is not JSON"},
      Broken{R"({"frames": Infinity})", "line 1, column 12: this is not JSON"}, Broken{R"({"frames": -Infinity})", "this is not JSON"},
      Broken{R"({"gravity": [0, 1e999, 0]})", "line 1, column 17: the number 1e999 is beyond what a double holds"},
      Broken{"{} // a comment", "line 1, column 4: this is not JSON"}, Broken{"/* */ {}", "this is not JSON"},
      Broken{"{'frames': 3}", "this is not JSON"}, Broken{"{} {}", "this is not JSON"}, Broken{"{\"name\": \"\xff\"}", "this is not JSON"},
      Broken{"{\"name\": \"a\nb\"}", "this is not JSON"}, Broken{std::string("{\"name\0\": 1}", 12), "this is not JSON"},
      Broken{R"({"frames": 1, "frames": 2})", "the key \"frames\" stands twice in one object"}, Broken{"PNG\x89", "this is not JSON"},
      Broken{"{}", "cloths: is missing: at least 1 is needed"}, Broken{R"({"cloths": []})", "cloths: is empty: at least 1 is needed"},
      Broken{R"({"cloths": {}})", "cloths: an object of 0, not a list"}, Broken{R"({"cloths": [3]})", "cloths[0]: 3, not an object"},
      Broken{R"({"cloths": [null]})", "cloths[0]: null, not an object"}});
}

TEST(BrokenScene, wrong_keys_types_and_figures_are_told_with_path_value_and_limit) {
  expect_refused({
      Broken{R"({"frame": 3})", "frame: there is no such key (did you mean \"frames\"?)"},
      Broken{R"({"quux": 3})", "quux: there is no such key"}, Broken{R"({"": 3})", "there is no such key"},
      Broken{R"({"solver": {"substep": 3}})", "solver.substep: there is no such key (did you mean \"substeps\"?)"},
      Broken{cloth_with(R"("fabrick": "silk")"), "cloths[0].fabrick: there is no such key (did you mean \"fabric\"?)"},
      Broken{cloth_with(R"("anchors": [{"top": 1, "key": []}])"),
             "cloths[0].anchors[0].key: there is no such key (did you mean \"keys\"?)"},
      Broken{R"({"name": 3})", "name: 3, not text"}, Broken{R"({"$schema": 3})", "$schema: 3, not text"},
      Broken{"{\"name\": \"" + std::string(2000, 'x') + "\"}", "name: is 2000 bytes long, more than 1000"},
      Broken{R"({"frames": "ten"})", "frames: \"ten\" is text, not a whole number"},
      Broken{R"({"frames": 1.5})", "frames: 1.5, not a whole number"},
      Broken{R"({"frames": -1})", "frames: -1 is less than 0"},
      Broken{R"({"frames": 99999999999999999999})", "frames: 1e+20 is more than 1000000"},
      Broken{R"({"frames": true})", "frames: true, not a whole number"},
      Broken{R"({"gravity": 9.81})", "gravity: 9.81, not a list of 3 numbers"},
      Broken{R"({"gravity": [0, 0]})", "gravity: a list of 2, not a list of 3 numbers"},
      Broken{R"({"gravity": [0, "down", 0]})", "gravity[1]: \"down\" is text, not a number"},
      Broken{R"({"gravity": [0, -1e30, 0]})", "gravity[1]: -1e+30 is less than -1000 (m/s^2)"},
      Broken{R"({"gravity": [0, null, 0]})", "gravity[1]: null, not a number"},
      Broken{R"({"solver": {"rate": 0}})", "solver.rate: 0 is not above 0 (Hz)"},
      Broken{R"({"solver": {"iterations": 0}})", "solver.iterations: 0 is less than 1"},
      Broken{R"({"solver": {"iterations": 1001}})", "solver.iterations: 1001 is more than 1000"},
      Broken{R"({"solver": {"relaxation": 1.5}})",
             "solver.relaxation: 1.5 is not below 1.33333, up to which 1 iteration a substep are stable"},
      Broken{R"({"solver": {"averaging": "mass_spilt"}})", "(did you mean \"mass_split\"?)"},
      Broken{R"({"solver": {"relaxation": 1.6, "iterations": 2}})",
             "solver.relaxation: 1.6 is not below 1.57735, up to which 2 iterations a substep"},
      Broken{R"({"solver": {"relaxation": 2}})", "solver.relaxation: 2 is not below 2"},
      Broken{R"({"solver": {"method": "jacobi", "shifts": true}})", "solver.method: \"jacobi\" has no shifts here, and solver.shifts is true"},
      Broken{R"({"solver": {"method": "chebyshev"}})", "solver.method: \"chebyshev\" accelerates iterations, and solver.iterations is 1"},
      Broken{R"({"solver": {"method": "chebyshev", "iterations": 2}, "contacts": true})",
             "solver.method: \"chebyshev\" does not go with contacts"},
      Broken{R"({"solver": {"method": "chebyshev", "iterations": 2}, "cloths": [{"grid": {}, "anchors": [{"top": 0}]}]})",
             "set cloths[0].tethers to false"},
      Broken{R"({"solver": {"order": 2, "relaxation": 1.2}})", "solver.relaxation: 1.2 is not below 1.16364"},
      Broken{R"({"solver": {"order": 3}})", "solver.order: 3 is more than 2"},
      Broken{R"({"solver": {"rho": 1}})", "solver.rho: 1 is not below 1"},
      Broken{R"({"solver": {"method": "jakobi"}})", "(did you mean \"jacobi\"?)"},
      Broken{R"({"solver": {"method": "mass_spring", "iterations": 2}})",
             "solver.method: \"mass_spring\" evaluates its forces once a substep, and solver.iterations is 2"},
      Broken{R"({"solver": {"method": "verlet"}, "cloths": [{"grid": {}, "springs": {"bend": {"stiffness": 1}}}]})",
             "cloths[0].springs.bend is there"},
      Broken{R"({"solver": {"method": "mass_spring"}, "cloths": [{"grid": {}, "fabric": {"stretch": "rigid"}}]})",
             "cloths[0].fabric is \"rigid\""},
      Broken{cloth_with(R"("bend_rest": "curved")"), "cloths[0].bend_rest: \"curved\" is not \"flat\" or \"mesh\""},
      Broken{cloth_with(R"("bending": false, "bend_rest": "mesh")"),
             "cloths[0].bend_rest: \"mesh\" is the shape that a cloth bends about, and this one does not"},
      Broken{R"({"solver": {"method": "chebyshev", "iterations": 2}, "cloths": [{"grid": {}, "bend_rest": "mesh"}]})",
             "cloths[0].bend_rest is \"mesh\""},
      Broken{R"({"solver": {"method": "mass_spring"}, "cloths": [{"grid": {}, "bend_rest": "mesh"}]})",
             "\"mass_spring\" bends cloth about a flat shape"},
      Broken{R"({"solver": {"longest_advance": 0}})", "solver.longest_advance: 0 is not above 0 (s)"},
      Broken{R"({"solver": []})", "solver: a list of 0, not an object"},
      Broken{R"({"camera": {"eye": [1, 1, 1], "target": [1, 1, 1]}})", "camera.target: is where the eye is"},
      Broken{R"({"camera": {"fov_degrees": 180}})", "camera.fov_degrees: 180 is more than 170 (degrees)"},
      Broken{R"({"light": {"direction": [0, 0, 0]}})", "light.direction: is a vector of length 0"},
      Broken{R"({"light": {"sun": -1}})", "light.sun: -1 is less than 0"}});
}

TEST(BrokenScene, wrong_cloths_are_told_with_path_value_and_limit) {
  expect_refused({
      Broken{R"({"cloths": [{}]})", "cloths[0]: has neither a grid nor a mesh"},
      Broken{R"({"cloths": [{"grid": {}, "mesh": "sheet.glb"}]})", "cloths[0]: has both a grid and a mesh"},
      Broken{R"({"cloths": [{"mesh": "curtain.glb"}]})", "cloths[0].mesh: \"curtain.glb\" is not there (looked for "},
      Broken{R"({"cloths": [{"mesh": "notes.txt"}]})", "does not end in \".gltf\", \".glb\", \".obj\", \".ply\", \".stl\", \".dae\" or \".fbx\""},
      Broken{R"({"cloths": [{"mesh": "directory.glb"}]})", "cloths[0].mesh: \"directory.glb\" is not a file"},
      Broken{R"({"cloths": [{"mesh": ""}]})", "cloths[0].mesh: names no file"},
      Broken{R"({"cloths": [{"mesh": 3}]})", "cloths[0].mesh: 3, not the name of a file"},
      Broken{R"({"cloths": [{"mesh": "a\u0000.glb"}]})", "has a control character in it"},
      Broken{"{\"cloths\": [{\"mesh\": \"" + std::string(5000, 'x') + ".glb\"}]}", "is not there"},
      Broken{R"({"cloths": [{"grid": {"cells": [0, 4]}}]})", "cloths[0].grid.cells[0]: 0 is less than 1"},
      Broken{R"({"cloths": [{"grid": {"cells": [4, 4000]}}]})", "cloths[0].grid.cells[1]: 4000 is more than 2048"},
      Broken{R"({"cloths": [{"grid": {"cells": 4}}]})", "cloths[0].grid.cells: 4, not a list of 2 whole numbers"},
      Broken{R"({"cloths": [{"grid": {"size": [1, -1]}}]})", "cloths[0].grid.size[1]: -1 is not above 0 (m)"},
      Broken{R"({"cloths": [{"grid": {"size": [1e-300, 1]}}]})", "cloths[0].grid.size[0]: 1e-300 is too small to tell from 0"},
      Broken{R"({"cloths": [{"grid": {"topology": "center"}}]})", "(did you mean \"centre\"?)"},
      Broken{R"({"cloths": [{"grid": {"upright": 1}}]})", "cloths[0].grid.upright: 1, not true or false"},
      Broken{cloth_with(R"("transform": {"scale": 0})"), "cloths[0].transform.scale: 0 is not above 0"},
      Broken{cloth_with(R"("transform": {"axis": [0, 0, 0]})"), "cloths[0].transform.axis: is a vector of length 0"},
      Broken{cloth_with(R"("fabric": "wool")"),
             "cloths[0].fabric: \"wool\" is not a fabric: \"silk\", \"cotton\", \"denim\" or \"leather\""},
      Broken{cloth_with(R"("fabric": "coton")"), "(did you mean \"cotton\"?)"},
      Broken{cloth_with(R"("fabric": {"preset": "wool"})"), "cloths[0].fabric.preset: \"wool\" is not a fabric"},
      Broken{cloth_with(R"("fabric": {"preset": 3})"), "cloths[0].fabric.preset: 3, not text"},
      Broken{cloth_with(R"("fabric": 3)"), "cloths[0].fabric: 3, not a preset's name or an object"},
      Broken{cloth_with(R"("fabric": {"area_density": -1})"), "cloths[0].fabric.area_density: -1 is not above 0 (kg/m^2)"},
      Broken{cloth_with(R"("fabric": {"stretch": 0})"), "cloths[0].fabric.stretch: 0 is not above 0 (N/m)"},
      Broken{cloth_with(R"("fabric": {"shear": "stiff"})"), "cloths[0].fabric.shear: \"stiff\" is text, not a number or \"rigid\""},
      Broken{cloth_with(R"("fabric": {"bend": 0})"), "cloths[0].fabric.bend: 0 is not above 0 (N m); for a cloth"},
      Broken{cloth_with(R"("fabric": {"bend": "rigid"})"), "cloths[0].fabric.bend: \"rigid\" is text, not a number"},
      Broken{cloth_with(R"("fabric": {"friction": -0.1})"), "cloths[0].fabric.friction: -0.1 is less than 0"},
      Broken{cloth_with(R"("bending": "yes")"), "cloths[0].bending: \"yes\" is text, not true or false"},
      Broken{R"({"contacts": "on"})", "contacts: \"on\" is text, not true, false or an object"},
      Broken{R"({"contacts": {"enabled": 1}})", "contacts.enabled: 1, not true or false"},
      Broken{R"({"contacts": {"recover": -1}})", "contacts.recover: -1 is less than 0 (m/s)"},
      Broken{R"({"contacts": {"kinematic_lag_limit": -1}})", "contacts.kinematic_lag_limit: -1 is less than 0"},
      Broken{R"({"contacts": {"capacity": 67108865}})", "contacts.capacity: 67108865 is more than 67108864"},
      Broken{R"({"contacts": {"capacity": 0.5}})", "contacts.capacity: 0.5, not a whole number"},
      Broken{R"({"contacts": {"cell": 1001}})", "contacts.cell: 1001 is more than 1000 (m)"},
      Broken{R"({"contacts": {"detection_margin": -0.1}})", "contacts.detection_margin: -0.1 is less than 0 (m)"},
      Broken{R"({"contacts": {"distance": 1}})", "contacts.distance: there is no such key"},
      Broken{cloth_with(R"("tethers": 4)"), "cloths[0].tethers: 4, not true, false or an object"},
      Broken{cloth_with(R"("tethers": {"per_vertex": 9})"), "cloths[0].tethers.per_vertex: 9 is more than 8"},
      Broken{cloth_with(R"("tethers": {"slack": 1.1})"), "cloths[0].tethers.slack: 1.1 is more than 1"},
      Broken{cloth_with(R"("appearance": {"albedo": "silk.png"})"), "cloths[0].appearance.albedo: \"silk.png\" is not there"},
      Broken{cloth_with(R"("appearance": {"normal": "notes.txt"})"), "does not end in \".png\", \".jpg\" or \".jpeg\""},
      Broken{cloth_with(R"("appearance": {"base_colour": [2, 0, 0]})"), "cloths[0].appearance.base_colour[0]: 2 is more than 1"},
      Broken{cloth_with(R"("appearance": {"repeat": [0, 1]})"), "cloths[0].appearance.repeat[0]: 0 is not above 0"},
      Broken{"{\"cloths\": " + many(R"({"grid": {}})", 1025) + "}", "cloths: 1025 entries are more than 1024"}});
}

TEST(BrokenScene, wrong_anchors_are_told_with_path_value_and_limit) {
  expect_refused({
      Broken{cloth_with(R"("anchors": [{}])"), "cloths[0].anchors[0]: chooses no vertex: give vertices, corners, top, box or map"},
      Broken{cloth_with(R"("anchors": [{"vertices": []}])"), "cloths[0].anchors[0]: chooses no vertex"},
      Broken{cloth_with(R"("anchors": [{"corners": []}])"), "cloths[0].anchors[0]: chooses no vertex"},
      Broken{cloth_with(R"("anchors": [{"every": 2}])"), "cloths[0].anchors[0]: chooses no vertex"},
      Broken{cloth_with(R"("anchors": [{"vertices": [0, 1089]}])"),
             "cloths[0].anchors[0].vertices[1]: 1089 is not a vertex, the grid has 1089"},
      Broken{cloth_with(R"("anchors": [{"vertices": [-1]}])"), "cloths[0].anchors[0].vertices[0]: -1 is less than 0"},
      Broken{cloth_with(R"("anchors": [{"vertices": [0.5]}])"), "cloths[0].anchors[0].vertices[0]: 0.5, not a whole number"},
      Broken{cloth_with(R"("anchors": [{"vertices": 3}])"), "cloths[0].anchors[0].vertices: 3, not a list"},
      Broken{cloth_with(R"("anchors": [{"corners": ["top"]}])"), "cloths[0].anchors[0].corners[0]: \"top\" is not \"low_low\""},
      Broken{cloth_with(R"("anchors": [{"corners": "low_low"}])"), "cloths[0].anchors[0].corners: \"low_low\" is text, not a list"},
      Broken{R"({"cloths": [{"mesh": "sheet.glb", "anchors": [{"corners": ["low_low"]}]}]})",
             "cloths[0].anchors[0].corners: name the corners of a grid"},
      Broken{cloth_with(R"("anchors": [{"top": -1}])"), "cloths[0].anchors[0].top: -1 is less than 0 (m)"},
      Broken{cloth_with(R"("anchors": [{"top": 1, "every": 0}])"), "cloths[0].anchors[0].every: 0 is less than 1"},
      Broken{cloth_with(R"("anchors": [{"box": {"low": [0, 0, 0]}}])"), "cloths[0].anchors[0].box: has no \"high\""},
      Broken{cloth_with(R"("anchors": [{"box": {"low": [0, 2, 0], "high": [1, 1, 1]}}])"),
             "cloths[0].anchors[0].box.low[1]: 2 is more than 1, its high (m)"},
      Broken{cloth_with(R"("anchors": [{"top": 1, "keys": [{"time": 1}, {"time": 1}]}])"),
             "cloths[0].anchors[0].keys[1].time: 1 is not after 1 (s)"},
      Broken{cloth_with(R"("anchors": [{"top": 1, "keys": [{"time": -1}]}])"), "cloths[0].anchors[0].keys[0].time: -1 is less than 0 (s)"},
      Broken{cloth_with(R"("anchors": [{"top": 1, "keys": [{"axis": [0, 0, 0]}]}])"),
             "cloths[0].anchors[0].keys[0].axis: is a vector of length 0"},
      Broken{cloth_with(R"("anchors": {"top": 1})"), "cloths[0].anchors: an object of 1, not a list"}});
}

TEST(BrokenScene, wrong_colliders_are_told_with_path_value_and_limit) {
  expect_refused({
      Broken{R"({"colliders": [{"shape": "sphere", "radius": 0}]})", "colliders[0].radius: 0 is not above 0 (m)"},
      Broken{R"({"colliders": [{"shape": "sphere", "radius": -2}]})", "colliders[0].radius: -2 is not above 0 (m)"},
      Broken{R"({"colliders": [{"shape": "cube"}]})",
             "colliders[0].shape: \"cube\" is not \"plane\", \"sphere\", \"capsule\", \"box\" or \"mesh\""},
      Broken{R"({"colliders": [{"shape": "mesh"}]})", "colliders[0]: has no \"mesh\": the file that it is made of"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "no.glb"}]})", "colliders[0].mesh: \"no.glb\" is not there"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "notes.txt"}]})", "colliders[0].mesh: \"notes.txt\" does not end in"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "sheet.glb", "scale": 0}]})", "colliders[0].scale: 0 is not above 0"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "sheet.glb", "thickness": 2}]})", "colliders[0].thickness: 2 is more than 1 (m)"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "sheet.glb", "size": [1, 1, 1]}]})", "colliders[0].size: a mesh has no size"},
      Broken{R"({"colliders": [{"shape": "box", "mesh": "sheet.glb"}]})", "colliders[0].mesh: a box has no mesh"},
      Broken{R"({"contacts": false, "colliders": [{}, {"shape": "mesh", "mesh": "sheet.glb"}]})",
             "contacts: are off, and colliders[1] is a mesh"},
      Broken{R"({"colliders": [{"shape": "plane", "normal": [0, 0, 0]}]})", "colliders[0].normal: is a vector of length 0"},
      Broken{R"({"colliders": [{"shape": "plane", "radius": 1}]})", "colliders[0].radius: a plane has no radius"},
      Broken{R"({"colliders": [{"shape": "sphere", "normal": [0, 1, 0]}]})", "colliders[0].normal: a sphere has no normal"},
      Broken{R"({"colliders": [{"shape": "sphere", "length": 1}]})", "colliders[0].length: a sphere has no length"},
      Broken{R"({"colliders": [{"shape": "capsule", "size": [1, 1, 1]}]})", "colliders[0].size: a capsule has no size"},
      Broken{R"({"colliders": [{"shape": "capsule", "length": 0}]})", "colliders[0].length: 0 is not above 0 (m)"},
      Broken{R"({"colliders": [{"shape": "box", "radius": 1}]})", "colliders[0].radius: a box has no radius"},
      Broken{R"({"colliders": [{"shape": "box", "size": [1, 0, 1]}]})", "colliders[0].size[1]: 0 is not above 0 (m)"},
      Broken{R"({"colliders": [{"shape": "box", "axis": [0, 0, 0]}]})", "colliders[0].axis: is a vector of length 0"},
      Broken{R"({"colliders": [{"friction": -1}]})", "colliders[0].friction: -1 is less than 0"},
      Broken{R"({"colliders": [{"keys": [{"time": 2}, {"time": 1}]}]})", "colliders[0].keys[1].time: 1 is not after 2 (s)"},
      Broken{R"({"colliders": [{"shape": "capsule", "radius_end": 0}]})", "colliders[0].radius_end: 0 is not above 0 (m)"},
      Broken{R"({"colliders": [{"shape": "sphere", "radius_end": 1}]})", "colliders[0].radius_end: a sphere has no radius_end"},
      Broken{R"({"colliders": [{"shape": "plane", "resizes": true}]})", "colliders[0].resizes: a plane has no resizes"},
      Broken{R"({"colliders": [{"shape": "mesh", "mesh": "sheet.glb", "bone": {}}]})", "colliders[0].bone: a mesh has no bone"},
      Broken{R"({"colliders": [{"meets": "skirt"}]})", "colliders[0].meets: \"skirt\" is text, not a list"},
      Broken{R"({"colliders": [{"meets": [3]}]})", "colliders[0].meets[0]: 3, not text"},
      Broken{R"({"cloths": [{"grid": {}, "name": "skirt"}], "colliders": [{"meets": ["skirt", "skrit"]}]})",
             "colliders[0].meets[1]: there is no cloth \"skrit\" (did you mean \"skirt\"?)"},
      Broken{R"({"cloths": [{"grid": {}, "name": "skirt", "meets": ["cape"]}]})", "cloths[0].meets[0]: there is no cloth \"cape\""},
      Broken{R"({"cloths": [{"grid": {}}], "colliders": [{"bone": {"cloth": "cape"}}]})", "colliders[0].bone.cloth: there is no cloth \"cape\""},
      Broken{R"({"cloths": [{"grid": {}}], "colliders": [{"bone": {"cloth": "cloth"}}]})",
             "colliders[0].bone.cloth: the cloth \"cloth\" has no skin"},
      Broken{R"({"cloths": [{"grid": {}, "skin": {}}], "colliders": [{"bone": {"cloth": "cloth"}, "keys": [{"time": 0}]}]})",
             "colliders[0].keys: move what a bone moves already"},
      Broken{"{\"colliders\": " + many("{}", 1025) + "}", "colliders: 1025 entries are more than 1024"}});
}

TEST(Scene, all_faults_are_named_one_a_line) {
  const std::string faults = fault_of(R"({"frame": 3, "gravity": [0, "x", 0], "cloths": [{"fabric": {"area_density": -1}}], "camera": 7})");
  EXPECT_EQ(faults,
            "gravity[1]: \"x\" is text, not a number\n"
            "cloths[0].fabric.area_density: -1 is not above 0 (kg/m^2)\n"
            "cloths[0]: has neither a grid nor a mesh: give one of them\n"
            "camera: 7, not an object\n"
            "frame: there is no such key (did you mean \"frames\"?)");
}

TEST(Scene, faults_beyond_two_hundred_are_counted) {
  std::string text = "{";
  for (int i = 0; i < 1000; ++i) text += "\"wrong" + std::to_string(i) + "\": 1, ";
  const std::string faults = fault_of(text + "\"cloths\": [{\"grid\": {}}]}");
  EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 200);
  EXPECT_TRUE(mentions(faults, "scene: has 800 more faults that are not shown")) << faults.substr(faults.size() - 100);
}

TEST(Scene, ten_megabytes_of_brackets_are_a_sentence) {
  for (const char bracket : {'[', '{'}) {
    const std::string fault = fault_of(std::string(10'000'000, bracket));
    EXPECT_EQ(fault, "line 1, column 65: lists and objects nest deeper than 64 levels, the most a scene may have");
  }
  EXPECT_TRUE(mentions(fault_of(std::string(10'000'000, ']')), "this is not JSON"));
  EXPECT_TRUE(mentions(fault_of("\"" + std::string(10'000'000, '[')), "the text ends too early"));
}

TEST(Scene, nesting_inside_a_string_does_not_count) {
  EXPECT_EQ(fault_of(R"({"cloths": [{"grid": {}}], "name": ")" + std::string(500, '[') + R"(\"[["})"), "no fault");
}

TEST(Scene, more_than_64_mebibytes_are_refused) {
  EXPECT_TRUE(mentions(fault_of(std::string((64u << 20) + 1, ' ')), "67108865 bytes are more than 67108864"));
}
