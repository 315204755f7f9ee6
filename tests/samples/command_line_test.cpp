// The program `weft`, run as its users run it: exit codes, sentences, and the files it leaves.
#include "tests/support/command_line.h"

#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>
#include <tuple>

#include "engine/reference/curve.h"

namespace weft {
namespace {

using nlohmann::json;

std::vector<std::string> names_of(const json& list) {
  std::vector<std::string> names;
  for (const json& entry : list) names.push_back(entry["name"]);
  return names;
}

bool any_mentions(const std::vector<std::string>& names, std::string_view part) {
  for (const std::string& name : names)
    if (name.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_F(CommandLine, bad_input_is_a_sentence_and_exit_code_2) {
  const std::string sheet = write("sheet.json", kSheet);
  const std::string brackets = write("brackets.json", std::string(10'000'000, '['));
  const std::string cut = write("cut.json", std::string(kSheet).substr(0, 40));
  const std::string wrong = write("wrong.json", R"({"frame": 3, "cloths": [{"grid": {}, "fabric": {"area_density": -1}}]})");
  const std::string glb = write("cut.glb", "glTF\x02");
  const std::string picture = write("map.json", R"({"cloths": [{"grid": {}, "appearance": {"albedo": "no.png"}}]})");
  const std::string unheld =
      write("unheld.json", R"({"cloths": [{"grid": {}, "anchors": [{"box": {"low": [9, 9, 9], "high": [9, 9, 9]}}]}]})");
  const std::vector<std::vector<std::string>> calls = {
      {}, {"bogus"}, {"run"}, {"run", sheet, "--bogus"}, {"run", sheet, "--frames", "ten"}, {"run", sheet, "--frames", "-1"},
      {"run", sheet, "--set", "frames"}, {"run", sheet, "--set", "frames=ten"}, {"run", sheet, "--set", "solver.substep=3"},
      {"run", sheet, "--every", "0"}, {"run", sheet, "--every", "2", "--no-picture"}, {"run", out("nothing.json")},
      {"run", out("nothing.glb")}, {"run", brackets}, {"check", brackets}, {"run", cut}, {"check", cut}, {"run", wrong}, {"check", wrong},
      {"time", wrong}, {"run", glb}, {"check", glb}, {"run", picture}, {"check", picture}, {"check", unheld},
      {"run", unheld, "--no-picture", "--out", out()}, {"run", folder.string()}};
  for (const std::vector<std::string>& call : calls) {
    std::string line;
    for (const std::string& word : call) line += word + ' ';
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 2) << line << '\n' << outcome.error;
    EXPECT_GT(outcome.error.size(), 10u) << line;
    EXPECT_EQ(outcome.out, "") << line;
  }
}

TEST_F(CommandLine, every_fault_of_a_scene_has_its_line) {
  const std::string wrong = write("wrong.json", R"({"frame": 3, "cloths": [{"grid": {}, "fabric": {"area_density": -1}}]})");
  EXPECT_EQ(weft({"check", wrong}).error,
            "cloths[0].fabric.area_density: -1 is not above 0 (kg/m^2)\n"
            "frame: there is no such key (did you mean \"frames\"?)\n");
}

TEST_F(CommandLine, a_mesh_of_a_format_that_is_not_read_is_told_which_are) {
  for (const char* name : {"cloth.abc", "cloth.USD", "cloth.3ds"})
    for (const char* command : {"check", "run"}) {
      const Outcome outcome = weft({command, write(name, "Kaydara FBX Binary")});
      EXPECT_EQ(outcome.exit, 2) << name;
      EXPECT_NE(outcome.error.find("; .gltf, .glb, .obj, .ply, .stl, .dae and .fbx can be read"), std::string::npos) << outcome.error;
    }
}

TEST_F(CommandLine, a_device_that_is_not_there_is_exit_code_1) {
  const Outcome outcome = weft({"run", write("sheet.json", kSheet), "--device", "nonesuch", "--out", out()});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_NE(outcome.error.find("nonesuch"), std::string::npos) << outcome.error;
}

TEST_F(CommandLine, run_leaves_a_picture_times_a_report_and_the_final_mesh) {
  const Outcome outcome = weft({"run", write("sheet.json", kSheet), "--frames", "5", "--every", "2", "--out", out()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  for (const char* name : {"sheet.png", "frame_0000.png", "frame_0002.png", "frame_0004.png", "final.ply"})
    EXPECT_GT(read(folder / "out" / name).size(), 500u) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out"), {}), 7) << "besides these, timings.csv and report.json";

  std::istringstream times(read(folder / "out/timings.csv"));
  std::string header, line;
  std::getline(times, header);
  EXPECT_EQ(header.rfind("frame,", 0), 0u) << header;
  int lines = 0;
  while (std::getline(times, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(header.begin(), header.end(), ',')) << line;
    ++lines;
  }
  EXPECT_EQ(lines, 5);

  const json report = json::parse(read(folder / "out/report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["particles"], 81);
  EXPECT_GT(report["edges"], 0);
  EXPECT_GT(report["bends"], 0);
  EXPECT_EQ(report["tethers"], 80);
  EXPECT_EQ(report["non_finite"], 0);
  EXPECT_EQ(report["hash"].get<std::string>().size(), 16u);
  EXPECT_NEAR(report["speed"], 9.81 * 5 / 60, 0.2) << "the free corner falls, and is already held back a little";
  EXPECT_EQ(report["timed"]["first"], 0);
  EXPECT_EQ(report["timed"]["frames"], 5);
  EXPECT_FALSE(report["device"].get<std::string>().empty());
  for (const char* key : {"mean", "rms", "max"}) EXPECT_GE(report["strain"][key], 0) << key;
  for (const char* key : {"ms_median", "ms_p95"}) EXPECT_GT(report["frame"][key], 0) << key;
  for (const json& pass : report["passes"])
    for (const char* key : {"name", "dispatches", "ms_median", "ms_p95"}) EXPECT_TRUE(pass.contains(key)) << pass;
  for (const json& buffer : report["buffers"]) EXPECT_GT(buffer["bytes"], 0) << buffer;
}

TEST_F(CommandLine, what_a_scene_does_not_call_for_is_not_in_its_report) {
  const std::string sheet = write("sheet.json", kSheet);
  const auto report_of = [&](std::vector<std::string> more) {
    std::vector<std::string> call = {"run", sheet, "--frames", "1", "--no-picture", "--out", out()};
    call.insert(call.end(), more.begin(), more.end());
    EXPECT_EQ(weft(call).exit, 0);
    return json::parse(read(folder / "out/report.json"), nullptr, false);
  };
  struct Feature {
    const char *assignment, *name;
  };
  const json all = report_of({});
  for (const Feature& feature : {Feature{"cloths[0].bending=false", "bend"}, Feature{"cloths[0].tethers=false", "tether"},
                                 Feature{"colliders=[]", "collide"}, Feature{"cloths[0].anchors=[]", "anchor"}}) {
    const json without = report_of({"--set", feature.assignment});
    EXPECT_TRUE(any_mentions(names_of(all["passes"]), feature.name)) << feature.name;
    EXPECT_TRUE(any_mentions(names_of(all["buffers"]), feature.name)) << feature.name;
    EXPECT_FALSE(any_mentions(names_of(without["passes"]), feature.name)) << feature.name;
    EXPECT_FALSE(any_mentions(names_of(without["buffers"]), feature.name)) << feature.name;
  }
}

TEST_F(CommandLine, check_counts_crossings_at_every_frame) {
  const auto report_of = [&](const std::vector<std::string>& call) {
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return json::parse(read(folder / "out/report.json"), nullptr, false);
  };
  const std::string hung = WEFT_SOURCE_DIR "/assets/scenes/hung.json", tablecloth = WEFT_SOURCE_DIR "/assets/scenes/tablecloth.json";
  const json unchecked = report_of({"run", hung, "--frames", "1", "--no-picture", "--out", out()});
  EXPECT_FALSE(unchecked.contains("intersections")) << "nobody asked";
  EXPECT_FALSE(unchecked.contains("contacts"));

  const json apart = report_of({"run", hung, "--frames", "10", "--check", "--no-picture", "--out", out()});
  EXPECT_EQ(apart["intersections"]["max"], 0);
  EXPECT_EQ(apart["intersections"]["final"], 0);
  EXPECT_NE(read(folder / "stdout").find("Cloth crosses cloth in no frame"), std::string::npos);

  const json crossed = report_of({"run", tablecloth, "--set", "contacts=false", "--check", "--no-picture", "--out", out()});
  EXPECT_GT(crossed["intersections"]["max"], 0) << "nothing keeps its folds apart";
  EXPECT_GE(crossed["intersections"]["max"], crossed["intersections"]["final"]);
  EXPECT_NE(read(folder / "stdout").find("in the worst frame"), std::string::npos);

  // An oblique sheet falls through one that is held, and is through at the end: no single frame would do.
  const auto falling = [&](const char* said) -> std::string {
    return write("falling.json", std::string(R"({"frames": 30, )") + said + R"("cloths": [
      {"grid": {"size": [0.3, 0.3], "cells": [4, 4]}, "anchors": [{"box": {"low": [-1, -1, -1], "high": [1, 1, 1]}}]},
      {"grid": {"size": [0.2, 0.2], "cells": [4, 4]}, "transform": {"translate": [0, 0.05, 0], "axis": [1, 0, 0], "degrees": 20}}]})");
  };
  const json through = report_of({"run", falling(R"("contacts": false, )"), "--check", "--no-picture", "--out", out()});
  EXPECT_GT(through["intersections"]["max"], 0);
  EXPECT_EQ(through["intersections"]["final"], 0);
  const json kept = report_of({"run", falling(""), "--check", "--no-picture", "--out", out()});
  EXPECT_EQ(kept["intersections"]["max"], 0) << "contacts are on where nothing is said of them";
}

TEST_F(CommandLine, cloth_that_starts_out_crossing_is_a_note_where_contacts_are_to_keep_it_apart) {
  const auto scene = [&](const char* more_cloth, const char* rest) {
    return write("scene.json", std::string(R"({"frames": 1, "cloths": [{"grid": {"size": [1, 1], "cells": [4, 4]}})") + more_cloth + "]" +
                                   rest + "}").string();
  };
  const char *upright = R"(, {"grid": {"cells": [3, 3], "upright": true}, "transform": {"translate": [0.06, 0.03, 0.07]}})",
             *wall = R"(, "colliders": [{"shape": "mesh", "mesh": "wall.obj"}])", *contacts = "", *none = R"(, "contacts": false)";
  write("wall.obj", "v 0.06 -0.3 -0.3\nv 0.06 0.3 -0.3\nv 0.06 -0.3 0.31\nf 1 2 3\n");
  const std::string said = "note: contacts: cloth starts out crossing or touching cloth or a mesh, in ";
  for (const auto& [more_cloth, rest] : {std::pair(upright, contacts), std::pair("", wall)}) {
    const std::string file = scene(more_cloth, rest);
    for (const auto& call : {std::vector<std::string>{"check", file}, {"run", file, "--no-picture", "--out", out()}}) {
      const Outcome outcome = weft(call);
      EXPECT_EQ(outcome.exit, 0) << outcome.error;
      EXPECT_NE(outcome.out.find(said), std::string::npos) << call[0] << ": " << outcome.out;
    }
  }
  for (const auto& [more_cloth, rest] : {std::pair("", contacts), std::pair(upright, none)}) {
    const Outcome outcome = weft({"check", scene(more_cloth, rest)});
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    EXPECT_EQ(outcome.out.find("note: contacts"), std::string::npos) << outcome.out;
  }
}

TEST_F(CommandLine, a_run_over_a_mesh_reports_its_contacts_and_exports_cloth_alone) {
  const std::string table = WEFT_SOURCE_DIR "/assets/scenes/table.json";
  const Outcome outcome = weft({"run", table, "--frames", "2", "--check", "--out", out()});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  const json report = json::parse(read(folder / "out/report.json"), nullptr, false);
  EXPECT_EQ(report["particles"], 61 * 61) << "of cloth";
  EXPECT_EQ(report["intersections"]["max"], 0);
  EXPECT_EQ(report["contacts"]["overflowed"], 0);
  EXPECT_GT(report["contacts"]["detections"], 0);
  for (const char* key : {"max", "truncated"}) EXPECT_TRUE(report["contacts"][key].is_number_unsigned()) << key;
  EXPECT_EQ(report["contacts"]["tracking_error"], 0);
  EXPECT_NE(read(folder / "stdout").find("Cloth crosses cloth or a mesh in no frame"), std::string::npos);
  EXPECT_NE(read(folder / "stdout").find("Contacts: up to "), std::string::npos);
  EXPECT_NE(read(folder / "out/final.ply").find("element vertex " + std::to_string(2 * 31 * 61) + "\n"), std::string::npos);
}

TEST_F(CommandLine, two_processes_end_in_the_same_bits) {
  const std::string sheet = write("sheet.json", kSheet);
  for (const char* solver : {R"(solver={})", R"(solver={"method": "implicit", "iterations": 9})",
                             R"(solver={"method": "implicit", "iterations": 9, "linear": "jacobi"})"}) {
    std::string hashes[2];
    for (std::string& hash : hashes) {
      ASSERT_EQ(weft({"run", sheet, "--frames", "20", "--no-picture", "--out", out(), "--set", solver}).exit, 0);
      hash = json::parse(read(folder / "out/report.json"), nullptr, false)["hash"];
    }
    EXPECT_EQ(hashes[0], hashes[1]) << solver;
  }
}

TEST_F(CommandLine, implicit_leaves_a_table_in_which_nothing_is_lost_and_both_processors_err_alike) {
  const Outcome outcome = weft({"implicit", "--quick", "--out", out()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("Not finite: 0\n"), std::string::npos) << outcome.out;
  std::istringstream table(read(folder / "out/implicit.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "particles,solver,iterations,processor,frames_per_second,residual,rms_distance_m,stopped,non_finite");
  int rows = 0;
  for (double errors[2]; std::getline(table, line); ++rows) {
    for (char& c : line) c = c == ',' ? ' ' : c == ' ' ? '_' : c;
    std::istringstream fields(line);
    std::string particles, linear, iterations, processor;
    double speed = 0;
    fields >> particles >> linear >> iterations >> processor >> speed >> errors[rows % 2];
    ASSERT_TRUE(fields) << line;
    EXPECT_GT(speed, 0) << line;
    // Floats: what velocities are rounded to when they are read back (implicit_step) is a ten-thousandth of the right side.
    if (rows % 2 == 1) { EXPECT_NEAR(errors[1], errors[0], 1e-2 * errors[0] + 1e-3) << line; }
  }
  EXPECT_EQ(rows, 24);
}

TEST_F(CommandLine, a_bare_mesh_runs_and_can_be_changed) {
  const std::string mesh = write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4\nf 1 4 3\n");
  const Outcome outcome = weft({"run", mesh, "--frames", "2", "--no-picture", "--out", out(), "--set", "cloths[0].fabric=denim"});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_EQ(weft({"run", mesh, "--set", "cloths[0].fabric=chainmail"}).exit, 2);
}

TEST_F(CommandLine, time_leaves_a_trace_that_names_every_pass) {
  const Outcome outcome = weft({"time", write("sheet.json", kSheet), "--frames", "3", "--warm-up", "1", "--out", out()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const json trace = json::parse(read(folder / "out/trace.json"), nullptr, false);
  const json report = json::parse(read(folder / "out/report.json"), nullptr, false);
  ASSERT_TRUE(trace["traceEvents"].is_array());
  std::vector<std::string> rows;
  for (const json& event : trace["traceEvents"]) {
    if (event["name"] == "thread_name") rows.push_back(event["args"]["name"]);
    EXPECT_TRUE(event["ph"] != "X" || event["dur"] >= 0) << event;
  }
  for (const std::string& pass : names_of(report["passes"])) {
    EXPECT_NE(std::find(rows.begin(), rows.end(), pass), rows.end()) << pass;
    EXPECT_NE(outcome.out.find(pass), std::string::npos) << outcome.out;
  }
}

TEST_F(CommandLine, contacts_tells_what_a_search_costs_at_several_sizes_and_cells) {
  const std::string hung = WEFT_SOURCE_DIR "/assets/scenes/hung.json";
  const Outcome outcome = weft({"contacts", hung, "--quick", "--frames", "4", "--out", out()});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  for (const char* word : {"detect_", "a search grows with n^", "the automatic choice takes "})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 2 + 2 + 2 + 7 + 2) << outcome.out;
  for (const char* name : {"contacts.csv", "cells.csv", "cells.svg", "cells.png"})
    EXPECT_FALSE(read(folder / "out" / name).empty()) << name;

  const Outcome refused = weft({"contacts", write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "--out", out()});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.error.find("sizes are compared on grids only"), std::string::npos) << refused.error;
}

TEST_F(CommandLine, contacts_tells_the_price_of_a_scene_as_it_is) {
  const std::string sheet = write("sheet.json", kSheet);
  const Outcome outcome = weft({"contacts", sheet, "--price", "--frames", "5", "--out", out()});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  for (const char* word : {"5 frames in turns", "without contacts", "with contacts", "with over without"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out;
  const std::string table = read(folder / "out" / "price.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3) << table;
  EXPECT_NE(table.find("\ntrue,5,"), std::string::npos) << table;
}

TEST_F(CommandLine, drape_tells_how_far_cloth_stands_out_from_what_holds_it_beside_what_is_published) {
  const std::string held = write("held.json", R"({"frames": 2, "contacts": false, "cloths": [
      {"name": "silk, grey", "grid": {"size": [0.3, 0.3], "cells": [12, 12]}, "fabric": "silk",
       "anchors": [{"box": {"low": [-0.09, -1, -0.09], "high": [0.09, 1, 0.09]}}]},
      {"name": "own", "grid": {"size": [0.3, 0.3], "cells": [12, 12]}, "fabric": {"bend": 0.1}, "transform": {"translate": [1, 0, 0]},
       "anchors": [{"box": {"low": [0.91, -1, -0.09], "high": [1.09, 1, 0.09]}}]}]})");
  const Outcome outcome = weft({"drape", held, "--out", out()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  // It has hardly fallen yet.
  EXPECT_NE(outcome.out.find("20 to 40 %, it is stiffer: light woven silks"), std::string::npos) << outcome.out;
  for (const char* name : {"drape.csv", "drape.svg", "drape.png"}) EXPECT_FALSE(read(folder / "out" / name).empty()) << name;
  const std::string table = read(folder / "out" / "drape.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3) << table;
  EXPECT_NE(table.find("\n\"silk, grey\",silk,0.06,4e-06,20,"), std::string::npos) << table;

  // Held nowhere, held everywhere, and upright.
  for (const char* set : {"cloths[0].anchors=[]", R"(cloths[0].anchors=[{"box":{"low":[-9,-9,-9],"high":[9,9,9]}}])",
                          "cloths[0].grid.upright=true"}) {
    const Outcome refused = weft({"drape", held, "--set", set, "--out", out()});
    EXPECT_EQ(refused.exit, 2) << set;
    EXPECT_NE(refused.error.find("cloth 'silk, grey' does not start flat with a part of it held and a part free"), std::string::npos)
        << refused.error;
  }
  const Outcome weightless = weft({"drape", held, "--set", "gravity=[0,0,0]", "--out", out()});
  EXPECT_EQ(weightless.exit, 0) << weightless.error;
}

TEST_F(CommandLine, effects_tells_what_each_adds_to_the_barest_cloth_and_which_do_not_go_together) {
  const Outcome outcome = weft({"effects", "--quick", "--out", out()});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  for (const char* part : {"the barest cloth ", "\nair ", "\nbend + dihedral ", "strand + gauss_seidel          there is none: solver.method: is "})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << '\n' << outcome.out;
  std::istringstream table(read(folder / "out/effects.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "first,second,passes,dispatches,bytes,instructions,ms_without,ms_with,refused");
  int lines = 0, refused = 0;
  for (; std::getline(table, line); ++lines) refused += line.back() == '"';
  EXPECT_EQ(lines, std::count(outcome.out.begin(), outcome.out.end(), '\n') - 3) << outcome.out;
  EXPECT_GT(lines - refused, 30);
  EXPECT_GT(refused, 3);
  const std::string page = read(folder / "out/effects.md");
  EXPECT_NE(page.find("| air | a wind | 4 |"), std::string::npos) << page;
  EXPECT_NE(page.find("- contact + untangle: contacts.untangle: is false and true at once\n"), std::string::npos) << page;
  EXPECT_EQ(weft({"effects", "--quick", "--size", "9"}).exit, 2);
  EXPECT_EQ(weft({"effects", "--size", "2"}).exit, 2);
}

TEST_F(CommandLine, harden_tells_what_held_and_fails_when_something_did_not) {
  const std::string sheet = write("sheet.json", kSheet);
  const Outcome held = weft({"harden", sheet, "--quick", "--frames", "20", "--out", out()});
  EXPECT_EQ(held.exit, 0) << held.out << held.error;
  const json report = json::parse(read(folder / "out/harden.json"), nullptr, false);
  ASSERT_EQ(report["rows"].size(), 16u)
      << "as it is, two starts, twice two rates, twice two masses, away, large, a hitch, a teleport, a jolt";
  for (const json& row : report["rows"]) {
    EXPECT_EQ(row["non_finite"], 0) << row;
    EXPECT_EQ(row["pins_off_m"], 0) << row;
    EXPECT_NE(held.out.find(row["name"].get<std::string>()), std::string::npos) << row["name"];
  }
  const Outcome again = weft({"harden", sheet, "--quick", "--frames", "20", "--seed", "2", "--out", out()});
  EXPECT_EQ(again.exit, 0) << again.out << again.error;
  const json drawn = json::parse(read(folder / "out/harden.json"), nullptr, false);
  EXPECT_NE(drawn["rows"][0]["strain"], report["rows"][0]["strain"]) << "another start";
  const Outcome moved = weft({"harden", sheet, "--quick", "--frames", "20", "--band", "0", "--out", out()});
  EXPECT_EQ(moved.exit, 1);
  EXPECT_NE(moved.out.find("NOT HELD: sag"), std::string::npos) << moved.out;
  const Outcome hasty = weft({"harden", sheet, "--quick", "--frames", "11", "--out", out()});
  EXPECT_EQ(hasty.exit, 2);
  EXPECT_NE(hasty.error.find("a run of 11 frames has no room for the long one halfway; this scene takes at least 12"), std::string::npos)
      << hasty.error;
  const std::string crossed = write("crossed.json", R"({"contacts": true, "cloths": [
    {"grid": {"cells": [2, 2]}, "anchors": [{"corners": ["low_low", "low_high", "high_low", "high_high"]}]},
    {"grid": {"cells": [2, 2], "upright": true}, "transform": {"translate": [0.1, 0.1, 0]},
     "anchors": [{"corners": ["low_low", "low_high", "high_low", "high_high"]}]}]})");
  const Outcome crossing = weft({"harden", crossed, "--quick", "--frames", "12", "--out", out()});
  EXPECT_EQ(crossing.exit, 1) << "that no perturbation is worse is no comfort";
  EXPECT_NE(crossing.out.find("The scene crosses by itself"), std::string::npos) << crossing.out;
  EXPECT_NE(crossing.out.find("\n0 of 16 held"), std::string::npos) << crossing.out;
  const std::string scenes = WEFT_SOURCE_DIR "/assets/scenes/hard",
                    readme = write("README.md", "before\n<!-- weft harden: begin -->\nstale\n<!-- weft harden: end -->\nafter\n");
  EXPECT_EQ(weft({"harden", scenes, "--only", "incline", "--readme", readme, "--out", out()}).exit, 0);
  const std::string text = read(readme);
  EXPECT_NE(text.find("| 9 | incline that holds | slid, of a slide without friction |"), std::string::npos) << text;
  EXPECT_EQ(text.find("stale"), std::string::npos);
  EXPECT_TRUE(text.starts_with("before\n") && text.ends_with("\nafter\n")) << text;
  EXPECT_EQ(weft({"harden", scenes, "--frames", "3", "--out", out()}).exit, 2) << "cases run as they are";
  EXPECT_EQ(weft({"harden", sheet, "--readme", readme, "--out", out()}).exit, 2);
}

TEST_F(CommandLine, info_lists_a_device) {
  const Outcome outcome = weft({"info"});
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_EQ(outcome.out.rfind("0: ", 0), 0u) << outcome.out;
}

TEST_F(CommandLine, an_interrupt_ends_the_frame_writes_what_there_is_and_exits_with_130) {
  const pid_t child = spawn({"run", write("sheet.json", kSheet), "--frames", "1000000", "--no-picture", "--out", out()});
  // The line that names the device is printed right before the first frame.
  for (int tries = 0; tries < 300 && read(folder / "stdout").empty(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(child, SIGINT);
  const Outcome outcome = wait(child);
  EXPECT_EQ(outcome.exit, 130);
  EXPECT_NE(outcome.error.find("Interrupted after"), std::string::npos) << outcome.error;
  const json report = json::parse(read(folder / "out/report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["interrupted"], true);
  EXPECT_LT(report["frames"], 1000000);
}

// The sheet without its floor, for which there is no reference.
constexpr const char* kHung =
    R"({"name": "sheet", "contacts": false, "cloths": [{"grid": {"cells": [6, 6], "upright": true}, "anchors": [{"corners": ["low_high"]}]}]})";

TEST_F(CommandLine, sides_of_a_mesh_are_refused_by_a_sentence) {
  const Outcome mesh = weft({"accuracy", std::string(WEFT_ASSETS) + "/generated/cape.glb", "--sides", "9", "--out", out()});
  EXPECT_EQ(mesh.exit, 2);
  EXPECT_NE(mesh.error.find("has no grid, and a mesh is as fine as it is"), std::string::npos) << mesh.error;
}

TEST_F(CommandLine, a_budget_chooses_by_the_curve_that_was_saved_for_the_device) {
  ASSERT_EQ(setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1), 0);
  const std::string sheet = write("sheet.json", kHung);
  const std::vector<std::string> call = {"run", sheet, "--frames", "1", "--no-picture", "--out", out(),
                                         "--set", "solver.method=auto", "--set", "solver.budget_ms=5"};
  const Outcome built_in = weft(call);
  EXPECT_EQ(built_in.exit, 0) << built_in.error;
  EXPECT_NE(built_in.out.find("by the curve of hung on llvmpipe"), std::string::npos) << built_in.out;

  ASSERT_EQ(weft({"accuracy", sheet, "--quick", "--frames", "4", "--reference-cells", "0", "--sides", "5,5", "--save", "--out", out()}).exit, 0);
  std::ifstream file(folder / "out/curve.csv");
  const auto curve = parse_curve(std::string(std::istreambuf_iterator<char>(file), {}));
  ASSERT_TRUE(curve) << curve.error();
  ASSERT_FALSE(curve->points.empty());
  std::set<std::tuple<std::string, std::uint32_t, std::uint32_t>> settings;
  for (const CurvePoint& point : curve->points) {
    EXPECT_EQ(point.cells, 4u) << "and not the scene's own 6";
    EXPECT_GT(point.dispatches, point.substeps) << point.row;
    EXPECT_TRUE(settings.insert({point.row, point.substeps, point.iterations}).second) << "one side named twice is one";
  }
  const Outcome saved = weft(call);
  EXPECT_NE(saved.out.find("by the curve of sheet on "), std::string::npos) << saved.out;
  for (const auto& entry : fs::directory_iterator(folder / "cache/weft"))
    if (entry.path().extension() == ".csv") std::ofstream(entry.path()) << "no curve";
  EXPECT_EQ(weft(call).exit, 2);
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace weft
