// Scenes that load, assignments from the command line, files, and random damage to both.
#include <cmath>
#include <limits>

#include "tests/support/scene_texts.h"

using namespace weft;
using namespace weft::scene_test;

TEST(Scene, one_grid_is_a_scene_with_every_default) {
  const Result<Scene> scene = parse(kGrid);
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_EQ(scene->frames, 300u);
  EXPECT_EQ(scene->gravity, (Vec3{0, -9.81f, 0}));
  ASSERT_EQ(scene->cloths.size(), 1u);
  EXPECT_EQ(scene->cloths[0].fabric, *fabric_preset("cotton"));
  EXPECT_EQ(scene->cloths[0].grid->cells_x, 32u);
  EXPECT_TRUE(scene->cloths[0].tethers);
  EXPECT_EQ(scene->folder, Folder::path());
}

TEST(Scene, every_key_arrives) {
  const Result<Scene> loaded = parse(kFull);
  ASSERT_TRUE(loaded) << loaded.error();
  const Scene& scene = *loaded;
  EXPECT_EQ(scene.name, "full");
  EXPECT_EQ(scene.description, "all keys");
  EXPECT_EQ(scene.frames, 12u);
  EXPECT_EQ(scene.gravity, (Vec3{0, -1.5f, 0.25f}));
  EXPECT_EQ(scene.solver.rate, 50);
  EXPECT_EQ(scene.solver.substeps, 7u);
  EXPECT_EQ(scene.solver.iterations, 2u);
  EXPECT_EQ(scene.solver.averaging, Averaging::count);
  EXPECT_EQ(scene.solver.relaxation, 1);
  EXPECT_EQ(scene.solver.shifts, false);
  EXPECT_EQ(scene.solver.longest_advance, 0.05);
  EXPECT_EQ(scene.contacts, (Contacts{true, 0.5, 4096, 0.03, 0.002, 2, 3}));

  const Cloth& curtain = scene.cloths.at(0);
  EXPECT_EQ(curtain.name, "curtain");
  EXPECT_EQ(curtain.mesh, "sheet.glb");
  EXPECT_FALSE(curtain.grid);
  EXPECT_EQ(curtain.transform.translate, (Vec3{1, 2, 3}));
  EXPECT_EQ(curtain.transform.axis, (Vec3{0, 0, 1}));
  EXPECT_EQ(curtain.transform.degrees, 90);
  EXPECT_EQ(curtain.transform.scale, 0.5);
  EXPECT_EQ(curtain.start.pose, StartPose::folded);
  EXPECT_EQ(curtain.start.degrees, 120);
  EXPECT_EQ(curtain.start.radius, 0.25);
  EXPECT_EQ(curtain.start.velocity, (Vec3{0, -1, 2}));
  EXPECT_EQ(curtain.start.imperfection, 0.5);
  EXPECT_EQ(curtain.start.seed, 4294967295u);
  EXPECT_EQ(curtain.fabric, (Fabric{"denim", 0.3, std::numeric_limits<double>::infinity(), 5, 0, 0, 0.1, 0.004}));
  EXPECT_FALSE(curtain.bending);
  EXPECT_TRUE(curtain.tethers);
  EXPECT_EQ(curtain.tethers_per_vertex, 2u);
  EXPECT_EQ(curtain.tether_slack, 0.1);
  ASSERT_EQ(curtain.anchors.size(), 3u);
  EXPECT_EQ(curtain.anchors[0].top, 0.02);
  EXPECT_EQ(curtain.anchors[0].every, 8u);
  EXPECT_EQ(curtain.anchors[0].keys.at(1), (Key{1, {0, 1, 0}, {1, 0, 0}, 720}));
  EXPECT_EQ(curtain.anchors[1].box->high, (Vec3{1, 1, 1}));
  EXPECT_EQ(curtain.anchors[2].vertices, (std::vector<std::uint32_t>{0, 5}));
  EXPECT_EQ(curtain.appearance.albedo, "weave.png");
  EXPECT_EQ(curtain.appearance.occlusion, "weave.jpg");
  EXPECT_EQ(curtain.appearance.base_colour, (Vec3{1, 0, 0}));
  EXPECT_EQ(curtain.appearance.metallic, 0.25);
  EXPECT_EQ(curtain.appearance.repeat, (Vec2{4, 6}));

  const Cloth& sheet = scene.cloths.at(1);
  EXPECT_EQ(sheet.grid->size, (Vec2{2, 3}));
  EXPECT_EQ(sheet.grid->cells_x, 4u);
  EXPECT_EQ(sheet.grid->cells_y, 5u);
  EXPECT_EQ(sheet.grid->topology, Topology::centre);
  EXPECT_TRUE(sheet.grid->upright);
  EXPECT_EQ(sheet.fabric, *fabric_preset("silk"));
  EXPECT_EQ(sheet.bend_rest, BendRest::mesh);
  EXPECT_FALSE(sheet.tethers);
  EXPECT_EQ(sheet.anchors.at(0).corners, (std::vector<Corner>{Corner::low_high, Corner::high_high}));
  EXPECT_EQ(sheet.meets, (std::vector<std::string>{"curtain"}));
  EXPECT_FALSE(curtain.meets);

  EXPECT_EQ(scene.colliders.at(0).shape, ColliderShape::sphere);
  EXPECT_EQ(scene.colliders.at(0).radius, 0.25);
  EXPECT_EQ(scene.colliders.at(0).keys.at(0).time, 2);
  EXPECT_EQ(scene.colliders.at(1).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.colliders.at(2).shape, ColliderShape::capsule);
  EXPECT_EQ(scene.colliders.at(2).axis, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.colliders.at(2).length, 0.75);
  EXPECT_EQ(scene.colliders.at(2).radius_end, 0.25);
  EXPECT_EQ(scene.colliders.at(2).meets, (std::vector<std::string>{"cloth", "curtain"}));
  EXPECT_EQ(scene.colliders.at(3).shape, ColliderShape::box);
  EXPECT_EQ(scene.colliders.at(3).size, (Vec3{1, 2, 3}));
  EXPECT_EQ(scene.colliders.at(3).degrees, 45);
  EXPECT_EQ(scene.colliders.at(3).bone, (Bone{"cloth", ""}));
  EXPECT_TRUE(scene.colliders.at(3).resizes);
  EXPECT_EQ(scene.colliders.at(4).shape, ColliderShape::mesh);
  EXPECT_EQ(scene.colliders.at(4).mesh, "sheet.glb");
  EXPECT_EQ(scene.colliders.at(4).scale, 2);
  EXPECT_EQ(scene.colliders.at(4).thickness, 0.004);
  EXPECT_EQ(scene.camera.eye, (Vec3{0, 1, 5}));
  EXPECT_EQ(scene.camera.fov_degrees, 30);
  EXPECT_EQ(scene.light.direction, (Vec3{0, -2, 0}));
  EXPECT_EQ(scene.light.sky, 0.5);
}

TEST(Scene, a_fabric_object_starts_from_its_preset) {
  const Result<Scene> scene = parse(cloth_with(R"("fabric": {"preset": "leather", "shear": 7})"));
  ASSERT_TRUE(scene) << scene.error();
  Fabric expected = *fabric_preset("leather");
  expected.shear = 7;
  EXPECT_EQ(scene->cloths[0].fabric, expected);
}

TEST(Scene, contacts_are_what_is_said_of_them_in_any_of_three_ways) {
  const auto contacts_of = [](const std::string& value, std::vector<Assignment> assignments = {}) {
    const Result<Scene> scene = parse(R"({"cloths": [{"grid": {}}])" + (value.empty() ? "" : ", \"contacts\": " + value) + "}",
                                      std::move(assignments));
    return scene ? scene->contacts : Contacts{false, -1, 0, 0, 0};
  };
  EXPECT_EQ(contacts_of(""), Contacts{});
  EXPECT_EQ(contacts_of("false"), (Contacts{false, 0.25, 0, 0, 0}));
  EXPECT_EQ(contacts_of("true"), (Contacts{true, 0.25, 0, 0, 0}));
  EXPECT_EQ(contacts_of("{}"), (Contacts{true, 0.25, 0, 0, 0}));
  EXPECT_EQ(contacts_of(R"({"enabled": false, "cell": 0.5})"), (Contacts{false, 0.25, 0, 0.5, 0}));
  EXPECT_EQ(contacts_of("", {{"contacts", "true"}}), (Contacts{true, 0.25, 0, 0, 0}));
  EXPECT_EQ(contacts_of("", {{"contacts.detection_margin", "0.01"}}), (Contacts{true, 0.25, 0, 0, 0.01}));
  EXPECT_EQ(contacts_of("false", {{"contacts.detection_margin", "0.01"}}), (Contacts{false, 0.25, 0, 0, 0.01}));
  EXPECT_EQ(contacts_of("true", {{"contacts", "false"}}), (Contacts{false, 0.25, 0, 0, 0}));
}

TEST(Scene, contacts_are_on_where_nothing_is_said_of_them_and_the_solver_goes_with_them) {
  const auto on = [](const std::string& rest) {
    const Result<Scene> scene = parse(R"({"cloths": [{"grid": {}}])" + rest + "}");
    EXPECT_TRUE(scene) << scene.error();
    return scene && contacts_on(*scene);
  };
  EXPECT_TRUE(on(""));
  EXPECT_FALSE(on(R"(, "contacts": false)"));
  EXPECT_TRUE(on(R"(, "contacts": {"iterations": 8})"));
  for (const char* method : {"jacobi", "strands", "gauss_seidel"})
    EXPECT_TRUE(on(std::string(R"(, "solver": {"method": ")") + method + "\"}")) << method;
  EXPECT_FALSE(on(R"(, "solver": {"method": "chebyshev", "substeps": 2, "iterations": 5})"));
  EXPECT_FALSE(on(R"(, "solver": {"order": 2})"));
  // Asked for, they are no less refused than before.
  EXPECT_FALSE(parse(R"({"cloths": [{"grid": {}}], "contacts": true, "solver": {"order": 2}})"));
  EXPECT_FALSE(parse(R"({"cloths": [{"grid": {}}], "contacts": {}, "solver": {"method": "chebyshev", "iterations": 5}})"));
}

TEST(Scene, a_mesh_collider_brings_contacts_also_when_it_is_written_and_read_again) {
  Result<Scene> scene = parse(R"({"cloths": [{"grid": {}}], "colliders": [{"shape": "sphere"}, {"shape": "mesh", "mesh": "sheet.glb"}]})");
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_TRUE(contacts_on(*scene));
  EXPECT_EQ(mesh_colliders(*scene), std::vector<std::uint32_t>{1});
  const Result<Scene> second = parse(scene_text(*scene));
  ASSERT_TRUE(second) << second.error();
  EXPECT_TRUE(contacts_on(*second));
  Scene without = *scene;
  without.contacts.enabled = false;
  EXPECT_TRUE(contacts_on(without)) << "nothing else keeps cloth out of it";
  without.colliders.pop_back();
  EXPECT_FALSE(contacts_on(without));
}

TEST(Scene, a_default_fabric_is_cotton) { EXPECT_EQ(Fabric{}, *fabric_preset("cotton")); }

TEST(Scene, presets_grow_heavier_and_stiffer_in_bending_from_silk_to_leather) {
  const char* names[] = {"silk", "cotton", "denim", "leather"};
  for (int i = 1; i < 4; ++i) {
    EXPECT_GT(fabric_preset(names[i])->area_density, fabric_preset(names[i - 1])->area_density);
    EXPECT_GT(fabric_preset(names[i])->bend, fabric_preset(names[i - 1])->bend);
    EXPECT_GT(fabric_preset(names[i])->shear, fabric_preset(names[i - 1])->shear);
  }
  EXPECT_FALSE(fabric_preset("chainmail"));
  EXPECT_FALSE(fabric_preset(""));
}

TEST(SceneAssignment, both_spellings_of_a_path_reach_the_same_value) {
  for (const char* path : {"cloths[0].grid.cells", "cloths.0.grid.cells"}) {
    const Result<Scene> scene = parse(kGrid, {{path, "[200,100]"}});
    ASSERT_TRUE(scene) << scene.error();
    EXPECT_EQ(scene->cloths[0].grid->cells_x, 200u);
    EXPECT_EQ(scene->cloths[0].grid->cells_y, 100u);
  }
}

TEST(SceneAssignment, objects_that_the_file_leaves_out_are_made) {
  const Result<Scene> scene = parse(kGrid, {{"solver.substeps", "20"}, {"frames", "7"}, {"cloths[0].grid.cells[1]", "3"}});
  // cells itself is not in the file, so there is no list to index.
  ASSERT_FALSE(scene);
  EXPECT_TRUE(mentions(scene.error(), "cloths[0].grid.cells")) << scene.error();
  const Result<Scene> second = parse(kGrid, {{"solver.substeps", "20"}, {"frames", "7"}});
  ASSERT_TRUE(second) << second.error();
  EXPECT_EQ(second->solver.substeps, 20u);
  EXPECT_EQ(second->frames, 7u);
}

TEST(SceneAssignment, a_value_that_is_not_json_is_text) {
  const Result<Scene> scene = parse(kGrid, {{"cloths.0.fabric", "denim"}, {"name", "two words"}});
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_EQ(scene->cloths[0].fabric, *fabric_preset("denim"));
  EXPECT_EQ(scene->name, "two words");
}

TEST(SceneAssignment, short_forms_grow_into_objects) {
  const Result<Scene> scene = parse(cloth_with(R"("fabric": "silk", "tethers": true)"),
                                    {{"cloths[0].fabric.bend", "0.001"}, {"cloths[0].tethers.slack", "0.5"}});
  ASSERT_TRUE(scene) << scene.error();
  Fabric expected = *fabric_preset("silk");
  expected.bend = 0.001;
  EXPECT_EQ(scene->cloths[0].fabric, expected);
  EXPECT_EQ(scene->cloths[0].tether_slack, 0.5);
}

TEST(SceneAssignment, what_is_wrong_with_one_is_told_like_what_is_wrong_with_a_file) {
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"solver.substep", "20"}}), "solver.substep: there is no such key (did you mean \"substeps\"?)"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"frames", "NaN"}}), "frames: \"NaN\" is text, not a whole number"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"cloths[0].fabric.bend", "1e999"}}), "cloths[0].fabric.bend: \"1e999\" is text, not a number"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"cloths[3].name", "x"}}), "cloths[3]: is not there, the length of the list is 1"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"cloths[99999999999999999999]", "x"}}), "is no index into it"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"cloths.first", "x"}}), "cloths: is a list, and \"first\" is no index into it"));
  EXPECT_TRUE(mentions(fault_of(kFull, {{"frames.x", "1"}}), "frames: is a number and holds no \"x\""));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"frames", std::string(10'000, '[')}}), "is text, not a whole number"));
  for (const char* path : {"", ".", "a.", ".a", "a..b", "a[", "a[]", "a]", "[", "cloths[0]name", "cloths[0", "a.[0]"})
    EXPECT_TRUE(mentions(fault_of(kGrid, {{path, "1"}}), "is not a path such as")) << path;
  EXPECT_TRUE(mentions(fault_of(kGrid, {{std::string(2000, 'a'), "1"}}), "is longer than 1000"));
  EXPECT_TRUE(mentions(fault_of(kGrid, {{"name", "\xff\xfe"}, {"frames", "\xff"}}), "frames: "));
}

TEST(SceneFile, what_cannot_be_read_is_a_sentence) {
  const auto fault = [](const std::filesystem::path& file) {
    const Result<Scene> scene = load_scene(file);
    return scene ? std::string("no fault") : scene.error();
  };
  EXPECT_TRUE(mentions(fault(Folder::path() / "no.json"), "no.json: there is no such file"));
  EXPECT_TRUE(mentions(fault(Folder::path() / "directory.glb"), "directory.glb: is not a file"));
  EXPECT_TRUE(mentions(fault("/dev/null"), "/dev/null: is not a file"));
  EXPECT_TRUE(mentions(fault(std::string(5000, 'x')), "there is no such file"));
  EXPECT_TRUE(mentions(fault(""), "there is no such file"));
}

TEST(SceneFile, its_folder_is_where_its_files_are_and_its_name_is_the_files) {
  std::ofstream(Folder::path() / "hung.json") << R"({"cloths": [{"mesh": "sheet.glb"}]})";
  const Result<Scene> scene = load_scene(Folder::path() / "hung.json");
  ASSERT_TRUE(scene) << scene.error();
  EXPECT_EQ(scene->folder, Folder::path());
  EXPECT_EQ(scene->name, "hung");
}

TEST(SceneText, a_written_scene_reads_back_the_same) {
  for (const char* text : {kGrid, kFull}) {
    const Result<Scene> first = parse(text);
    ASSERT_TRUE(first) << first.error();
    const std::string written = scene_text(*first);
    const Result<Scene> second = parse(written);
    ASSERT_TRUE(second) << second.error();
    EXPECT_EQ(scene_text(*second), written);
    EXPECT_EQ(second->cloths[0].fabric, first->cloths[0].fabric);
    EXPECT_EQ(second->cloths[0].anchors.size(), first->cloths[0].anchors.size());
    Contacts said = first->contacts;   // what a scene leaves open is written as it was decided
    said.enabled = contacts_on(*first);
    EXPECT_EQ(second->contacts, said);
    EXPECT_EQ(second->light.colour, first->light.colour);
  }
}

TEST(SceneText, a_default_scene_can_be_written_and_read) {
  const Scene scene = default_scene(Folder::path() / "sheet.glb", {-1, 0, -1}, {1, 2, 1});
  const Result<Scene> read = parse(scene_text(scene), {{"cloths[0].fabric", "denim"}});
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->cloths[0].fabric, *fabric_preset("denim"));
  EXPECT_EQ(read->camera.eye, scene.camera.eye);
  EXPECT_EQ(read->colliders[0].centre, scene.colliders[0].centre);
}

TEST(SceneFile, cut_short_anywhere_it_is_refused) {
  const std::string_view full = kFull;
  for (std::size_t size = 0; size + 1 < full.size(); ++size) ASSERT_FALSE(parse(full.substr(0, size))) << size;
}

TEST(SceneFile, random_mutations_never_crash) {
  std::mt19937 random(20);
  const std::string full = kFull;
  const std::string_view pieces[] = {"{", "}", "[", "]", ",", ":", "\"", "-", "1e999", "null", "true", "\\u0000", "\xff", "1e-320", "\"x\"",
                                     "9999999999999"};
  for (int round = 0; round < 2000; ++round) {
    std::string text = full;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0: text[at] = static_cast<char>(random()); break;
        case 1: text.erase(at, 1 + random() % 20); break;
        case 2: text.insert(at, pieces[random() % std::size(pieces)]); break;
        default: text.insert(at, text.substr(random() % text.size(), random() % 50)); break;
      }
    }
    const Result<Scene> scene = parse(text);
    ASSERT_TRUE(scene || !scene.error().empty());
  }
}

TEST(SceneFile, random_values_in_the_right_places_never_crash) {
  std::mt19937 random(21);
  const char* paths[] = {"frames", "gravity", "gravity[1]", "solver", "solver.rate", "cloths", "cloths[0]", "cloths[0].mesh",
                         "cloths[0].fabric", "cloths[0].fabric.stretch", "cloths[0].anchors", "cloths[0].anchors[0].keys",
                         "cloths[0].anchors[0].keys[1]", "cloths[0].anchors[1].box", "cloths[0].anchors[2].vertices",
                         "cloths[1].grid", "cloths[1].grid.cells", "cloths[0].appearance.albedo", "colliders", "colliders[0]",
                         "camera", "light.direction", "cloths[0].tethers", "contacts", "contacts.capacity"};
  const char* values[] = {"null", "true", "[]", "{}", "\"\"", "-1", "0", "1e308", "-0.0", "18446744073709551615", "-9223372036854775808",
                          "[1,2,3]", "[[],{}]", "{\"a\":1}", "1e-308", "\"rigid\"", "[null,null,null]", "4294967296",
                          "[1e308,1e308,1e308]"};
  for (int round = 0; round < 2000; ++round) {
    const Result<Scene> scene = parse(kFull, {{paths[random() % std::size(paths)], values[random() % std::size(values)]},
                                              {paths[random() % std::size(paths)], values[random() % std::size(values)]}});
    ASSERT_TRUE(scene || !scene.error().empty());
  }
}
