// Runs that are killed and go on: the program `weft` with --checkpoint.
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/command_line.h"

namespace weft {
namespace {

using nlohmann::json;

class Checkpoint : public CommandLine {};

// A sheet that falls over itself: contacts have the most state.
constexpr const char* kFalling = R"({"name": "falling", "frames": 400, "contacts": true, "solver": {"longest_advance": 0.01},
  "cloths": [{"grid": {"cells": [8, 8]}, "anchors": [{"corners": ["low_low"]}]}], "colliders": [{"centre": [0, -0.5, 0]}]})";

TEST_F(Checkpoint, a_run_that_was_killed_goes_on_from_its_last_checkpoint_to_the_same_bits) {
  const std::string scene = write("falling.json", kFalling);
  const auto call = [&](const char* where, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"run", scene, "--no-picture", "--check", "--out", out(where)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const fs::path checkpoint = folder / "killed/falling.snapshot";
  const pid_t child = spawn(call("killed", {"--checkpoint", "20"}));
  for (int tries = 0; tries < 3000 && !fs::exists(checkpoint); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(child, SIGKILL);
  ASSERT_EQ(wait(child).exit, -SIGKILL);
  ASSERT_TRUE(fs::exists(checkpoint));
  ASSERT_FALSE(fs::exists(folder / "killed/report.json"));

  // A checkpoint of another scene, or half of one, is refused, and stays where it is.
  const Outcome other = weft(call("killed", {"--checkpoint", "20", "--set", "gravity=[0,-5,0]"}));
  EXPECT_EQ(other.exit, 2);
  EXPECT_NE(other.error.find("another scene"), std::string::npos) << other.error;
  const std::string whole = read(checkpoint);
  fs::resize_file(checkpoint, whole.size() / 2);
  const Outcome cut = weft(call("killed", {"--checkpoint", "20"}));
  EXPECT_EQ(cut.exit, 2);
  EXPECT_NE(cut.error.find("is cut"), std::string::npos) << cut.error;
  std::ofstream(checkpoint, std::ios::binary) << whole;
  // What a kill in the middle of a write leaves beside it (file_test.cpp kills there) is in no run's way.
  std::ofstream(folder / "killed/falling.snapshot.1.part", std::ios::binary) << whole.substr(0, whole.size() / 2);

  const Outcome resumed = weft(call("killed", {"--checkpoint", "20"}));
  ASSERT_EQ(resumed.exit, 0) << resumed.error;
  EXPECT_NE(resumed.out.find("Going on after frame "), std::string::npos) << resumed.out;
  EXPECT_FALSE(fs::exists(checkpoint)) << "the run is over";
  ASSERT_EQ(weft(call("whole")).exit, 0);
  const json a = json::parse(read(folder / "killed/report.json"), nullptr, false),
             b = json::parse(read(folder / "whole/report.json"), nullptr, false);
  ASSERT_TRUE(a.is_object() && b.is_object());
  for (const char* key : {"hash", "frames", "contacts", "non_finite", "intersections", "strain", "speed"}) EXPECT_EQ(a[key], b[key]) << key;
  EXPECT_GE(a["resumed_at"], 20);
  EXPECT_FALSE(b.contains("resumed_at"));
  // A frame of 1/60 s of which 1/100 s may be simulated: a surplus is never lost without a word.
  for (const json& report : {a, b}) EXPECT_NEAR(report["clamped_seconds"], 400 * (1.0 / 60 - 0.01), 1e-9);
  EXPECT_NE(read(folder / "stdout").find("s were not simulated"), std::string::npos);
  // The middle of a long run is timed, not all of it.
  EXPECT_EQ(b["timed"]["first"], 140);
  EXPECT_LE(b["timed"]["frames"], 120);
  EXPECT_GT(b["timed"]["frames"], 0);
  EXPECT_EQ(read(folder / "whole/timings.csv").find("\n140,") != std::string::npos, true);
}

TEST_F(Checkpoint, a_run_that_was_interrupted_leaves_one_of_its_last_frame) {
  const std::vector<std::string> call = {
      "run", write("falling.json", kFalling), "--frames", "1000000", "--no-picture", "--out", out(), "--checkpoint", "1000000"};
  const pid_t child = spawn(call);
  for (int tries = 0; tries < 300 && read(folder / "stdout").empty(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(child, SIGINT);
  EXPECT_EQ(wait(child).exit, 130);
  const json report = json::parse(read(folder / "out/report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  std::vector<std::string> rest = call;
  rest[3] = std::to_string(report["frames"].get<int>() + 2);
  const Outcome resumed = weft(rest);
  EXPECT_EQ(resumed.exit, 0) << resumed.error;
  EXPECT_NE(resumed.out.find("Going on after frame " + report["frames"].dump()), std::string::npos) << resumed.out;
  rest[3] = "1";
  rest.back() = "1";
  EXPECT_EQ(weft(rest).exit, 0) << "what is over is begun anew";
}

}  // namespace
}  // namespace weft
