// What the program `weft` does with its surroundings: it writes over nothing that it reads, finds out first whether it can write, and
// keeps to what a terminal, a shell and the places for caches ask of it.
#include <fcntl.h>
#include <sys/stat.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/image.h"
#include "tests/support/command_line.h"

namespace weft {
namespace {

class Outputs : public CommandLine {
 protected:
  std::string write_picture(const char* name) {
    EXPECT_TRUE(write_png(folder / name, Image{2, 2, std::vector<std::uint8_t>(16, 200)}));
    return read(folder / name);
  }

  void expect_refusal(const std::vector<std::string>& call, const std::string& name, const std::string& as) {
    const std::string before = read(folder / "own" / name);
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 2) << call[0] << ' ' << name << ": " << outcome.error;
    EXPECT_EQ(outcome.error, (folder / "own" / name).string() + " is read as " + as + " and would be overwritten: choose another --out\n");
    EXPECT_EQ(outcome.out, "") << call[0] << ' ' << name;
    EXPECT_EQ(read(folder / "own" / name), before) << call[0] << ' ' << name;
  }
};

TEST_F(Outputs, a_texture_is_not_overwritten_by_the_picture_of_its_cloth) {
  fs::create_directories(folder / "own");
  const std::string scene = write("own/flag.json", R"({"name": "flag", "frames": 1, "contacts": false, "cloths": [{"grid": {"cells": [4, 4]},
      "appearance": {"albedo": "flag.png"}}]})");
  const std::string picture = write_picture("own/flag.png");
  const std::string own = (folder / "own").string();
  expect_refusal({"run", scene, "--out", own}, "flag.png", "cloths[0].appearance.albedo");
  const Outcome elsewhere = weft({"run", scene, "--out", out()});
  EXPECT_EQ(elsewhere.exit, 0) << elsewhere.error;
  EXPECT_EQ(weft({"run", scene, "--out", own, "--no-picture"}).exit, 0) << "which draws nothing over it";
  EXPECT_EQ(read(folder / "own/flag.png"), picture);
}

// The same file by another path: through a linked folder, a linked file, a second name.
TEST_F(Outputs, no_link_leads_around_it) {
  fs::create_directories(folder / "own");
  fs::create_directories(folder / "maps");
  write_picture("maps/cloth.png");
  fs::create_symlink("../maps/cloth.png", folder / "own/flag.png");
  const std::string scene = write("flag.json", R"({"name": "flag", "frames": 1, "contacts": false, "cloths": [{"grid": {"cells": [4, 4]},
      "appearance": {"roughness": "maps/cloth.png"}}]})");
  const std::string own = (folder / "own").string();
  expect_refusal({"run", scene, "--out", own}, "flag.png", "cloths[0].appearance.roughness");
  fs::remove(folder / "own/flag.png");
  fs::create_hard_link(folder / "maps/cloth.png", folder / "own/flag.png");
  expect_refusal({"run", scene, "--out", own}, "flag.png", "cloths[0].appearance.roughness");
  fs::remove(folder / "own/flag.png");
  fs::create_hard_link(folder / "maps/cloth.png", folder / "own/frame_0002.png");
  expect_refusal({"run", scene, "--frames", "5", "--every", "2", "--out", own}, "frame_0002.png", "cloths[0].appearance.roughness");
  fs::create_directory_symlink("own", folder / "alias");
  const Outcome alias = weft({"run", scene, "--frames", "5", "--every", "2", "--out", out("alias")});
  EXPECT_EQ(alias.exit, 2) << alias.error;
}

TEST_F(Outputs, no_command_writes_over_what_it_reads) {
  fs::create_directories(folder / "own");
  const std::string own = (folder / "own").string();
  const auto scene_at = [&](const char* name) { return write((std::string("own/") + name).c_str(), kSheet).string(); };
  expect_refusal({"run", scene_at("report.json"), "--out", own}, "report.json", "the scene");
  expect_refusal({"run", scene_at("sheet.snapshot"), "--checkpoint", "1", "--out", own}, "sheet.snapshot", "the scene");
  expect_refusal({"time", scene_at("trace.json"), "--out", own}, "trace.json", "the scene");
  expect_refusal({"accuracy", scene_at("curve.csv"), "--quick", "--fresh", "--out", own}, "curve.csv", "the scene");
  expect_refusal({"accuracy", scene_at("budget_3.png"), "--quick", "--out", own}, "budget_3.png", "the scene");
  expect_refusal({"contacts", scene_at("cells.csv"), "--quick", "--out", own}, "cells.csv", "the scene");
  expect_refusal({"harden", scene_at("harden.json"), "--quick", "--out", own}, "harden.json", "the scene");

  write("own/sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4\nf 1 4 3\n");
  fs::create_symlink("sheet.obj", folder / "own/final.ply");
  const std::string mesh = write("mesh.json", R"({"cloths": [{"grid": {}}], "colliders": [{"shape": "mesh", "mesh": "own/sheet.obj"}]})");
  expect_refusal({"run", mesh, "--out", own}, "final.ply", "colliders[0].mesh");
  const Outcome bare = weft({"run", (folder / "own/sheet.obj").string(), "--out", own});
  EXPECT_EQ(bare.exit, 2) << bare.error;
  fs::remove(folder / "own/final.ply");
  write("own/final.ply", "0123");
  write("sheet.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4, "uri": "own/final%2eply"}]})");
  const std::string gltf = write("gltf.json", R"({"cloths": [{"mesh": "sheet.gltf"}]})");
  expect_refusal({"run", gltf, "--out", own}, "final.ply", "a buffer of cloths[0].mesh");
  write("sheet.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": "own/final.ply"}]})");
  expect_refusal({"run", gltf, "--out", own}, "final.ply", "an image of cloths[0].mesh");
  const std::string text = R"({"asset": {"version": "2.0"}, "images": [{"uri": "own/final.ply"}]} )";   // 68 bytes, of a GLB
  write("sheet.GLB", std::string("glTF\2\0\0\0", 8) + std::string("\x58\0\0\0", 4) + std::string("\x44\0\0\0JSON", 8) + text);
  expect_refusal({"run", write("glb.json", R"({"cloths": [{"mesh": "sheet.GLB"}]})"), "--out", own}, "final.ply", "an image of cloths[0].mesh");

  const std::string suite = WEFT_SOURCE_DIR "/assets/scenes/hard";
  write("own/hard_cases.csv", "<!-- weft harden: begin -->\n<!-- weft harden: end -->");
  expect_refusal({"harden", suite, "--only", "incline", "--readme", (folder / "own/hard_cases.csv").string(), "--out", own},
                 "hard_cases.csv", "the file of --readme");
}

TEST_F(Outputs, a_place_that_cannot_be_written_is_told_before_anything_runs) {
  const std::string sheet = write("sheet.json", kSheet), hung = WEFT_SOURCE_DIR "/assets/scenes/hung.json";
  const std::vector<std::pair<std::vector<std::string>, std::string>> commands = {
      {{"run", sheet, "--frames", "1000000"}, "final.ply"}, {{"run", sheet, "--frames", "1000000"}, "sheet.png"},
      {{"run", sheet, "--frames", "1000000", "--every", "7"}, "frame_0049.png"}, {{"time", sheet, "--frames", "1000000"}, "trace.json"},
      {{"accuracy", sheet, "--frames", "100000"}, "curve.png"}, {{"contacts", hung, "--frames", "1000000"}, "cells.svg"},
      {{"harden", sheet}, "harden.json"}, {{"effects"}, "effects.md"}, {{"implicit"}, "implicit.csv"}};
  for (auto [call, name] : commands) {
    call.insert(call.end(), {"--out", out()});
    fs::create_directories(folder / "out" / name);
    const Outcome folder_there = weft(call);
    EXPECT_EQ(folder_there.exit, 1) << call[0];
    EXPECT_EQ(folder_there.error, out() + "/" + name + " cannot be written: it is a folder\n") << call[0];
    EXPECT_EQ(folder_there.out, "") << call[0];
    fs::remove_all(folder / "out");
    disk_bytes = 2048;
    const Outcome full = weft(call);
    EXPECT_EQ(full.exit, 1) << call[0];
    EXPECT_NE(full.error.find(" cannot be written: File too large\n"), std::string::npos) << call[0] << ": " << full.error;
    EXPECT_EQ(full.out, "") << call[0];
    EXPECT_TRUE(fs::is_empty(folder / "out")) << call[0];
    disk_bytes = 0;
    fs::remove_all(folder / "out");
  }
  const std::string readonly = "/proc/self";   // a folder in which not even root can make a file
  const Outcome refused = weft({"run", sheet, "--frames", "1000000", "--out", readonly});
  EXPECT_EQ(refused.exit, 1);
  EXPECT_NE(refused.error.find("/proc/self/final.ply cannot be written: "), std::string::npos) << refused.error;
}

// A pipeline cache and a curve that are links to something else: the links go, and what they lead to stays.
TEST_F(Outputs, a_cache_that_is_a_link_overwrites_nothing) {
  const std::string letter = write("letter", "dear reader");
  const std::string sheet = write("sheet.json", kSheet);
  fs::create_directories(folder / "cache/weft");
  environment = {"XDG_CACHE_HOME=" + (folder / "cache").string()};
  fs::create_symlink(letter, folder / "cache/weft/pipelines");
  const Outcome outcome = weft({"run", sheet, "--frames", "1", "--no-picture", "--out", out()});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_EQ(read(letter), "dear reader");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder / "cache/weft/pipelines"))) << "the next run has a cache";
}

TEST_F(Outputs, a_cache_that_is_no_absolute_path_is_ignored) {
  const std::string sheet = write("sheet.json", kSheet);
  fs::create_directories(folder / "home");
  const std::string driver = "MESA_SHADER_CACHE_DISABLE=true";   // Mesa has a cache of its own there
  environment = {driver, "XDG_CACHE_HOME=weft_relative_cache", "HOME=" + (folder / "home").string()};
  EXPECT_EQ(weft({"run", sheet, "--frames", "1", "--no-picture", "--out", out()}).exit, 0);
  EXPECT_FALSE(fs::exists("weft_relative_cache"));
  EXPECT_TRUE(fs::exists(folder / "home/.cache/weft/pipelines"));
  environment = {driver, "XDG_CACHE_HOME=weft_relative_cache", "HOME=weft_relative_home"};
  EXPECT_EQ(weft({"run", sheet, "--frames", "1", "--no-picture", "--out", out()}).exit, 0);
  EXPECT_FALSE(fs::exists("weft_relative_cache") || fs::exists("weft_relative_home"));
}

TEST_F(Outputs, a_terminal_that_moves_no_cursor_and_a_user_who_wants_no_colour_get_plain_lines) {
  const std::string sheet = write("sheet.json", kSheet);
  const auto shown_with = [&](std::vector<std::string> variables) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    EXPECT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
    fs::remove(folder / "stderr");
    fs::create_symlink(ptsname(terminal), folder / "stderr");
    const int held = open(ptsname(terminal), O_RDWR | O_NOCTTY);   // what was written is lost with the last who has it open
    environment = std::move(variables);
    int status = 0;
    waitpid(spawn({"run", sheet, "--frames", "4", "--no-picture", "--out", out()}), &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
    std::string shown(65536, '\0');
    shown.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(terminal, shown.data(), shown.size()))));
    close(held);
    close(terminal);
    return shown;
  };
  EXPECT_NE(shown_with({"TERM=xterm", "NO_COLOR="}).find('\033'), std::string::npos) << "a bar, so that the others mean something";
  for (const auto& variables : {std::vector<std::string>{"TERM=dumb", "NO_COLOR="}, {"TERM=", "NO_COLOR="}, {"TERM=xterm", "NO_COLOR=1"}}) {
    const std::string shown = shown_with(variables);
    EXPECT_EQ(shown.find('\033'), std::string::npos) << variables[0];
    EXPECT_NE(shown.find("simulating sheet: 4 of 4 frames"), std::string::npos) << shown;
  }
}

TEST_F(Outputs, a_program_that_was_started_deaf_to_ctrl_C_and_to_queues_stays_so) {
  deaf = true;
  const pid_t child = spawn({"run", write("sheet.json", kSheet), "--frames", "300", "--no-picture", "--out", out()});
  for (int tries = 0; tries < 3000 && !fs::exists(out()); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1})
    for (int times = 0; times < 3; ++times) kill(child, signal);
  const Outcome outcome = wait(child);
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_EQ(nlohmann::json::parse(read(folder / "out/report.json"), nullptr, false)["frames"], 300);
}

TEST_F(Outputs, a_mistyped_command_or_option_is_named_with_the_nearest) {
  const std::string sheet = write("sheet.json", kSheet);
  const auto said = [&](const std::vector<std::string>& call) {
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 2) << outcome.error;
    EXPECT_TRUE(outcome.error.ends_with("; weft --help tells what there is\n")) << outcome.error;
    return outcome.error.substr(0, outcome.error.find(';'));
  };
  EXPECT_EQ(said({"runn", sheet}), R"(weft: there is no command "runn" (did you mean "run"?))");
  EXPECT_EQ(said({"acuracy"}), R"(weft: there is no command "acuracy" (did you mean "accuracy"?))");
  EXPECT_EQ(said({"bogus"}), R"(weft: there is no command "bogus")");
  EXPECT_EQ(said({"--versoin"}), R"(weft: there is no option "--versoin" (did you mean "--version"?))");
  EXPECT_EQ(said({"run", sheet, "--frame", "3"}), R"(weft: there is no option "--frame" (did you mean "--frames"?))");
  EXPECT_EQ(said({"run", "--frame=3", sheet}), R"(weft: there is no option "--frame" (did you mean "--frames"?))");
  EXPECT_EQ(said({"time", sheet, "--warmup", "3"}), R"(weft: there is no option "--warmup" (did you mean "--warm-up"?))");
  EXPECT_EQ(said({"run", sheet, "--\033[31m"}), R"(weft: there is no option "--?[31m")");
  EXPECT_EQ(said({}).find("there is no"), std::string::npos);
  EXPECT_EQ(said({"time", sheet, "more"}).find("there is no"), std::string::npos);
}

}  // namespace
}  // namespace weft
