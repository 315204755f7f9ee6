// Memory that runs out at every allocation in turn, in all that needs no device: scenes, meshes, cooking, files. Each is a sentence, and
// what has all the same been done is what would have been done.
#include <gtest/gtest.h>

#include "engine/export.h"
#include "engine/fabric.h"
#include "engine/reference/choice.h"
#include "engine/snapshot.h"
#include "engine/solve/plan.h"
#include "tests/support/cooked.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"
#include "tests/support/scarce_memory.h"
#include "tests/support/scene_texts.h"
#include "tests/support/without_contacts.h"

#ifdef WEFT_SANITIZED
#include <sanitizer/lsan_interface.h>
#endif

namespace weft {
namespace {

using test::at_every_allocation;

struct None {};
constexpr auto none = [] { return None(); };

// What a function without anything to change gives: with too little memory an error, or the same as ever.
template <class Work, class Same>
void expect_same_or_sentence(long most, Work&& work, Same&& same) {
  const auto expected = must(work());
  using Value = std::remove_cvref_t<decltype(expected)>;
  at_every_allocation(
      most, [] { return std::optional<Value>(); },
      [&](std::optional<Value>& made) -> Result<void> {
        auto done = work();
        if (!done) return done.take_error();
        made = std::move(*done);
        return {};
      },
      [&](const std::optional<Value>& made, bool done) { if (done) { EXPECT_TRUE(same(*made, expected)); } });
}

template <class T>
Result<void> plain(Result<T> result) {
  return result ? Result<void>() : Result<void>(result.take_error());
}

template <class Work>
void expect_sentence(long most, Work&& work) {
  at_every_allocation(most, none, [&](None) { return work(); }, [](None, bool) {});
}

constexpr auto same_scene = [](const Scene& a, const Scene& b) { return scene_text(a) == scene_text(b) && a.name == b.name; };
constexpr auto same_mesh = [](const Mesh& a, const Mesh& b) {
  return a.render.positions == b.render.positions && a.triangles == b.triangles && a.point_of_source == b.point_of_source &&
         a.mended == b.mended;
};

TEST(Memory, that_runs_out_while_a_scene_is_read_is_a_sentence) {
  const test::Folder folder;
  const auto file = folder.write("one.json", R"({"cloths": [{"grid": {"cells": [2, 3]}, "anchors": [{"corners": ["low_high"]}]}]})");
  expect_same_or_sentence(200, [&] { return load_scene(file); }, same_scene);
  const std::vector<Assignment> changes = {{"cloths[0].fabric.bend", "0.5"}, {"contacts.iterations", "3"}};
  expect_same_or_sentence(150, [&] { return parse_scene(scene_test::kFull, scene_test::Folder::path(), changes); }, same_scene);
}

TEST(Memory, that_runs_out_while_a_scene_is_refused_is_a_sentence) {
  const auto refused = [](const char* text) {
    return [text]() -> Result<std::string> {
      auto scene = parse_scene(text, {});
      if (scene) return std::string();
      Error why = scene.take_error();
      if (why.kind == ErrorKind::memory) return why;
      return std::move(why.message);
    };
  };
  for (const char* text : {R"({"cloths": [{"grid": {"cells": [0, "a"]}, "anchor": 1}], "gravity": 1e400})", "{\"a\": 1, \"a\": 2}", "[",
                           "[1]", R"({"cloths": [{"grid": {"cells": [0, "a"]}, "anchor": 1}], "frames": "no\u0001"})"})
    expect_same_or_sentence(200, refused(text), std::equal_to<>());
}

TEST(Memory, that_runs_out_while_a_scene_is_checked_is_a_sentence) {
  Scene scene = must(scene_test::parse(scene_test::kFull));
  expect_sentence(200, [&] { return check(scene); });
  scene.cloths[0].fabric.bend = -1;
  scene.colliders[0].radius = -1;
  expect_same_or_sentence(
      200,
      [&]() -> Result<std::string> {
        auto checked = check(scene);
        Error why = checked.take_error();
        if (why.kind == ErrorKind::memory) return why;
        return std::move(why.message);
      },
      std::equal_to<>());
}

TEST(Memory, that_runs_out_while_settings_are_chosen_is_a_sentence) {
  const Scene scene = must(parse_scene(R"({"cloths": [{"grid": {}}], "solver": {"method": "auto", "budget_ms": 3}})", {}));
  const Curve curve = builtin_curve();
  std::string note;
  expect_same_or_sentence(100, [&] { return with_choice(scene, 1089, curve, note); }, same_scene);
  const std::string csv = curve_csv(curve);
  expect_same_or_sentence(100, [&] { return parse_curve(csv); },
                          [](const Curve& a, const Curve& b) { return curve_csv(a) == curve_csv(b); });
}

test::Gltf painted_sheet() {
  test::Gltf gltf;
  const std::size_t positions = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 5, 5, 5});
  const std::size_t uvs = gltf.vec2({0, 0, 1, 0, 0, 1, 1, 1, 0, 0}), indices = gltf.indices16({0, 1, 2, 1, 3, 2, 1, 3, 2});
  auto& primitive = gltf.primitive(positions);
  primitive["indices"] = indices;
  primitive["attributes"]["TEXCOORD_0"] = uvs;
  gltf.json["nodes"][0]["rotation"] = {0, 0, 0, 2};
  gltf.json["nodes"][0]["children"] = {1};
  gltf.json["nodes"].push_back({{"translation", {0, 0, 1}}, {"mesh", 0}});
  primitive["material"] = 0;
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 0}}}}}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["images"] = {{{"uri", "data:image/png;base64,iVBORw=="}}};
  return gltf;
}

TEST(Memory, that_runs_out_while_a_mesh_is_read_is_a_sentence) {
  const test::Folder folder;
  const auto obj = folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0.2 0 0.2\nv 0 0 1\nv 9 9 9\nvt 0 0\nvn 0 1 0\n"
                                             "f 1/1/1 5/1/1 4/1/1 3/1/1 2/1/1\nf 1 4 3\nf 1 4 3\nl 1 2\n");
  expect_same_or_sentence(200, [&] { return load_mesh(obj); }, same_mesh);
  const auto gltf = painted_sheet().write(folder);
  expect_same_or_sentence(300, [&] { return load_mesh(gltf); }, same_mesh);
}

TEST(Memory, that_runs_out_while_a_mesh_is_checked_or_welded_is_a_sentence) {
  const Mesh mesh = make_grid({{1, 1}, 3, 2, Topology::centre, true});
  expect_sentence(100, [&] { return check(mesh); });
  at_every_allocation(
      200, [&] { return mesh.render; }, [](RenderMesh& render) { return plain(weld_mesh(std::move(render))); }, [](auto&, bool) {});
}

TEST(Memory, that_runs_out_while_cloth_is_cooked_is_a_sentence) {
  const auto same = [](const CookedFabric& a, const CookedFabric& b) {
    return std::ranges::equal(std::as_bytes(std::span(a.positions)), std::as_bytes(std::span(b.positions))) && a.notes == b.notes &&
           a.links.size() == b.links.size() && a.tether_count == b.tether_count && a.bends.size() == b.bends.size();
  };
  Scene scene;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 3, 4, Topology::diagonal, true};
  cloth.anchors.emplace_back().corners = {Corner::low_high};
  cloth.start.pose = StartPose::folded;
  for (const Method method : {Method::jacobi, Method::gauss_seidel, Method::implicit}) {
    scene.solver.method = method;
    const auto meshes = must(make_meshes(scene));
    expect_same_or_sentence(60, [&] { return cook(scene, meshes); }, same);
  }
  expect_same_or_sentence(100, [&] { return make_meshes(scene); },
                          [](const auto& a, const auto& b) { return a.size() == b.size() && same_mesh(a[0], b[0]); });
}

TEST(Memory, that_runs_out_while_passes_are_planned_and_specialised_is_a_sentence) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{{1, 1}, 2, 2};
  const CookedFabric fabric = cooked(scene);
  const Cooked subject = cooked_of(scene, fabric);
#ifdef WEFT_SANITIZED
  const __lsan::ScopedDisabler optimizer_s_leaks;   // SPIRV-Tools is built without exceptions
#endif
  expect_sentence(30, [&]() -> Result<void> {
    try {
      compute::Specializer specializer;
      return plain(make_plan(needs_of(subject, 64, true), specializer));
    } catch (...) {   // as Simulation::create does
      return caught("the plan");
    }
  });
}

// A file is whole or not there.
TEST(Memory, that_runs_out_while_a_file_is_written_is_a_sentence_and_leaves_no_half_of_it) {
  const test::Folder folder;
  const Mesh mesh = make_grid({{1, 1}, 3, 2, Topology::centre, true});
  const auto file = folder / "file";
  Snapshot snapshot;
  snapshot.note = {std::byte{'h'}, std::byte{'i'}};
  snapshot.contents = {{"positions of a longer name", std::vector<std::byte>(48, std::byte{42})}};
  snapshot.colliders.resize(2);
  const auto written_whole = [&](auto&& write) {
    must(write());
    const std::string whole = test::slurp(file);
    at_every_allocation(
        200, [&] { std::filesystem::remove(file); return None(); }, [&](None) { return write(); },
        [&](None, bool done) {
          EXPECT_EQ(std::filesystem::exists(file), done);
          if (done) { EXPECT_EQ(test::slurp(file), whole); }
          for (const auto& entry : std::filesystem::directory_iterator(file.parent_path())) EXPECT_EQ(entry.path(), file);
        });
  };
  const RenderMesh& render = mesh.render;
  written_whole([&] { return write_glb(file, render); });
  written_whole([&] { return write_ply(file, render.positions, render.normals, {}, render.triangles); });
  written_whole([&] { return save_snapshot(file, snapshot); });
  must(save_snapshot(file, snapshot));
  expect_same_or_sentence(100, [&] { return load_snapshot(file); },
                          [](const Snapshot& a, const Snapshot& b) { return snapshot_bytes(a) == snapshot_bytes(b); });
}

}  // namespace
}  // namespace weft
