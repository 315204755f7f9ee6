#include "samples/weft/effect_rows.h"

#include <algorithm>
#include <string_view>

#include "compute/file.h"

namespace weft::command {

namespace {

// Springs are soft, so that they are stable in ten substeps a frame up to 200 x 200 cells. Bodies stand 2 cm below the sheet, which reaches
// them in four frames, and apart from each other: rows with colliders come together in pairs.
const EffectRow kRows[] = {
    {"bend", "bending about flat", {{"cloths[0].bending", "true"}}, {{"cloths[0].bending", "false"}}},
    {"dihedral", "bending about the mesh's own angles",
     {{"cloths[0].bending", "true"}, {"cloths[0].bend_rest", "mesh"}},
     {{"cloths[0].bending", "false"}, {"cloths[0].bend_rest", "flat"}}},
    {"tether", "tethers to two held corners",
     {{"cloths[0].tethers", "true"}, {"cloths[0].anchors", R"([{"corners":["low_low","high_low"]}])"}},
     {{"cloths[0].tethers", "false"}, {"cloths[0].anchors", "[]"}}},
    {"anchor", "an anchor that moves",
     {{"cloths[0].anchors", R"([{"corners":["low_high"],"keys":[{"time":0},{"time":10,"translate":[0,2,0]}]}])"}},
     {{"cloths[0].anchors", "[]"}}},
    {"level", "coarse levels", {{"solver.levels", "true"}}, {{"solver.levels", "false"}}},
    {"strand", "method strands, with its levels", {{"solver.method", "strands"}}, {{"solver.method", "jacobi"}}},
    {"gauss_seidel", "method gauss_seidel", {{"solver.method", "gauss_seidel"}}, {{"solver.method", "jacobi"}}},
    {"shift", "gauss_seidel on levels, with shifts of its links",
     {{"solver.method", "gauss_seidel"}, {"solver.levels", "true"}, {"solver.shifts", "true"}},
     {{"solver.method", "jacobi"}, {"solver.levels", "false"}}},
    {"bdf2", "second order in time", {{"solver.order", "2"}}, {{"solver.order", "1"}}},
    {"chebyshev", "method chebyshev, 2 substeps of 5 iterations",
     {{"solver.method", "chebyshev"}, {"solver.substeps", "2"}, {"solver.iterations", "5"}},
     {{"solver.method", "jacobi"}}},
    {"mass_spring", "method mass_spring",
     {{"solver.method", "mass_spring"}, {"cloths[0].springs", R"({"structural":{"stiffness":0.2},"shear":{"stiffness":0.1}})"}},
     {{"solver.method", "jacobi"}}},
    {"verlet", "method verlet",
     {{"solver.method", "verlet"}, {"cloths[0].springs", R"({"structural":{"stiffness":0.2},"shear":{"stiffness":0.1}})"}},
     {{"solver.method", "jacobi"}}},
    {"implicit", "method implicit, conjugate gradients", {{"solver.method", "implicit"}}, {{"solver.method", "jacobi"}}},
    {"implicit_level", "method implicit on levels",
     {{"solver.method", "implicit"}, {"solver.levels", "true"}},
     {{"solver.method", "jacobi"}}},
    {"implicit_jacobi", "method implicit, block Jacobi",
     {{"solver.method", "implicit"}, {"solver.linear", "jacobi"}},
     {{"solver.method", "jacobi"}}},
    {"collide", "a plane and a sphere",
     {{"colliders", R"([{"shape":"plane","centre":[0,-1,0]},{"shape":"sphere","radius":0.75,"centre":[0,-0.77,0]}])"}},
     {{"colliders", "[]"}}},
    {"support", "a ball that is small for the patch, of 52 x 52 cells here",
     {{"cloths[1].grid.cells", "[52,52]"}, {"colliders", R"([{"shape":"sphere","radius":0.02,"centre":[-0.3,-0.042,0.3]}])"}},
     {{"cloths[1].grid.cells", "[8,8]"}, {"colliders", "[]"}}},
    {"triangle", "a box, which triangles meet too",
     {{"colliders", R"([{"shape":"box","size":[0.2,0.2,0.2],"centre":[-0.3,-0.12,-0.3]}])"}},
     {{"colliders", "[]"}}},
    {"reaction", "what a plane and a sphere are given",
     {{"reactions", "true"},
      {"colliders", R"([{"shape":"plane","centre":[0,-1,0]},{"shape":"sphere","radius":0.75,"centre":[0,-0.77,0]}])"}},
     {{"reactions", "false"}, {"colliders", "[]"}}},
    // A plane a centimetre below the body's tip, across the bodies of other rows, stops the sheet: nothing else keeps it from hanging down
    // from the tip in a thousand folds, whose price is not the body's.
    {"mesh_collider", "a body of triangles on a plane, by contacts",
     {{"contacts.enabled", "true"},
      {"colliders", R"([{"shape":"mesh","mesh":"effects_body.obj","centre":[0.3,-0.12,0.3]},{"shape":"plane","centre":[0,-0.03,0]}])"}},
     {{"colliders", "[]"}, {"contacts.enabled", "false"}}},
    {"skin", "a skin of one joint, which carries two anchors",
     {{"cloths[0].skin", "{}"}, {"cloths[0].anchors", R"([{"corners":["high_low","high_high"]}])"}},
     {{"cloths[0].anchors", "[]"}}},
    {"skin_targets", "the same, which can also take targets of the host's",
     {{"cloths[0].skin", R"({"takes_targets": true})"}, {"cloths[0].anchors", R"([{"corners":["high_low","high_high"]}])"}},
     {{"cloths[0].anchors", "[]"}}},
    {"morph", "a morph target that moves two anchors of an octahedron in place of the patch",
     {{"cloths[1]", R"({"name": "ball", "mesh": "effects_morph.gltf", "fabric": {"stretch": 20, "shear": 1}, "bending": false,
       "tethers": false, "transform": {"translate": [0, 0.104, 0]}, "start": {"velocity": [0, -0.5, 0]},
       "skin": {}, "anchors": [{"vertices": [0, 1]}]})"}},
     {}},
    {"motion_constraint", "max distances and backstops",
     {{"cloths[0].motion_constraints", R"({"max_distance":0.02,"backstop_distance":0.01,"backstop_radius":10})"}},
     {}},
    {"inertia", "half of what a moving frame makes felt", {{"cloths[0].inertia", R"({"linear":0.5})"}}, {}},
    {"render_mesh", "a render mesh of six vertices", {{"cloths[0].render_mesh", "effects_body.obj"}}, {}},
    {"pins", "room for 16 pins", {{"pins", "16"}}, {{"pins", "0"}}},
    {"grab", "a hand that could grab", {{"grabs", "1"}}, {{"grabs", "0"}}},
    {"contact", "contacts, without untangling",
     {{"contacts.enabled", "true"}, {"contacts.untangle", "false"}},
     {{"contacts.enabled", "false"}}},
    {"untangle", "contacts with untangling",
     {{"contacts.enabled", "true"}, {"contacts.untangle", "true"}},
     {{"contacts.enabled", "false"}, {"contacts.untangle", "true"}}},
    {"air", "a wind", {{"air.wind", "[2,0,0]"}}, {}},
    {"air_lee", "the lee of two cloths", {{"air.wind", "[2,0,0]"}, {"air.lee", "true"}}, {}},
    {"pressure", "a gas in an octahedron in place of the patch",
     {{"cloths[1]", R"({"name": "ball", "mesh": "effects_body.obj", "fabric": {"stretch": 20, "shear": 1}, "bending": false,
       "tethers": false, "transform": {"translate": [0, 0.104, 0]}, "start": {"velocity": [0, -0.5, 0]},
       "pressure": {"rest_pressure": 20}})"}},
     {}},
    {"tear", "a sheet that can tear and be cut", {{"cloths[0].tear", R"({"strain":0.2})"}}, {}},
    {"air_stir", "gusts, turbulence and a jet",
     {{"air.gusts", R"([{"velocity":[0,0,1]}])"},
      {"air.turbulence", "0.5"},
      {"air.fields", R"([{"shape":"jet","centre":[-1,0,0],"velocity":[4,0,0],"radius":0.2}])"}},
     {}},
};

// The patch falls on the sheet, so that contacts have something to do. Its links are as soft as the springs above.
constexpr std::string_view kBase = R"({"name": "effects", "solver": {"method": "jacobi"}, "contacts": false, "cloths": [
    {"name": "sheet", "grid": {}, "bending": false, "tethers": false},
    {"name": "patch", "grid": {"size": [0.3, 0.3], "cells": [8, 8]}, "fabric": {"stretch": 20, "shear": 1},
     "bending": false, "tethers": false, "transform": {"translate": [0, 0.004, 0]}, "start": {"velocity": [0, -0.5, 0]}}]})";

// Of anchors, colliders and the like; no vector.
bool is_list(const std::string& value) { return value.starts_with("[{"); }

}  // namespace

std::span<const EffectRow> effect_rows() { return kRows; }

Result<std::vector<Assignment>> both_of(const EffectRow& first, const EffectRow& second) {
  std::vector<Assignment> both = first.on;
  for (const Assignment& more : second.on) {
    const auto there = std::find_if(both.begin(), both.end(), [&](const Assignment& given) { return given.path == more.path; });
    if (there == both.end()) {
      both.push_back(more);
    } else if (is_list(there->value) && is_list(more.value)) {
      there->value.back() = ',';
      there->value += more.value.substr(1);
    } else if (there->value != more.value) {
      return fail(more.path, ": is ", there->value, " and ", more.value, " at once");
    }
  }
  return both;
}

Result<Scene> base_scene(std::uint32_t cells, const std::filesystem::path& folder, std::span<const Assignment> assignments) {
  const std::string count = std::to_string(cells);
  std::vector<Assignment> all{{"cloths[0].grid.cells", "[" + count + "," + count + "]"}};
  all.insert(all.end(), assignments.begin(), assignments.end());
  return parse_scene(kBase, folder, all);
}

Result<void> write_body(const std::filesystem::path& folder) {
  constexpr std::string_view kOctahedron =
      "v 0.1 0 0\nv -0.1 0 0\nv 0 0.1 0\nv 0 -0.1 0\nv 0 0 0.1\nv 0 0 -0.1\n"
      "f 1 3 5\nf 5 3 2\nf 2 3 6\nf 6 3 1\nf 5 4 1\nf 2 4 5\nf 6 4 2\nf 1 4 6\n";
  // The same, with a morph target that draws it out along x, whose weight goes from 0 to 1 within a tenth of a second.
  constexpr std::string_view kMorphed =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":2}]}],"weights":[0]}],)"
      R"("animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":3,"output":4}]}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":24},)"
      R"({"buffer":0,"byteOffset":96,"byteLength":72},{"buffer":0,"byteOffset":168,"byteLength":16}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[-0.1,-0.1,-0.1],"max":[0.1,0.1,0.1]},)"
      R"({"bufferView":1,"componentType":5121,"count":24,"type":"SCALAR"},)"
      R"({"bufferView":2,"componentType":5126,"count":6,"type":"VEC3","min":[-0.02,0,0],"max":[0.02,0.01,0]},)"
      R"({"bufferView":3,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[0.1]},)"
      R"({"bufferView":3,"byteOffset":8,"componentType":5126,"count":2,"type":"SCALAR"}],)"
      R"("buffers":[{"byteLength":184,"uri":"data:application/octet-stream;base64,)"
      "zczMPQAAAAAAAAAAzczMvQAAAAAAAAAAAAAAAM3MzD0AAAAAAAAAAM3MzL0AAAAAAAAAAAAAAADNzMw9AAAAAAAAAADNzMy9AAIEBAIBAQIFBQIABAMAAQ"
      "MEBQMBAAMFCtejPArXIzwAAAAACtejvArXIzwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAM3MzD0A"
      "AAAAAACAPw=="
      R"("}]})";
  if (auto written = write_file(folder / kBodyFile, std::as_bytes(std::span(kOctahedron))); !written) return written;
  return write_file(folder / kMorphFile, std::as_bytes(std::span(kMorphed)));
}

}  // namespace weft::command
