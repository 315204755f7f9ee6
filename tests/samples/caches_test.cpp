// `weft run --cache`: every frame of a scene in every format, as the library has it; runs that are killed and go on; what is refused.
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/cache.h"
#include "engine/simulation.h"
#include "tests/support/caches.h"
#include "tests/support/command_line.h"
#include "tests/support/gpu_fixture.h"

namespace weft {
namespace {

using test::ReadCache;
using test::same_bits;

class Caches : public CommandLine {};

constexpr std::uint32_t kFrames = 6;

// A mesh in the order of its file, with a vertex that no face has, and a grid; far away, so that the simulation has an origin of its own.
constexpr const char* kScene = R"({"name": "two cloths", "frames": 6, "contacts": false, "cloths": [
  {"mesh": "strip.obj", "transform": {"translate": [1000, 0, 0]}, "anchors": [{"vertices": [4]}]},
  {"grid": {"cells": [3, 3]}, "transform": {"translate": [1000, 1, 1]}, "anchors": [{"corners": ["low_low"]}]}]})";
constexpr const char* kStrip =
    "v 1 1 1\nv 0 0 0\nv 0.1 0 0\nv 0.2 0 0\nv 0.3 0 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.2 0 0.1\nv 0.3 0 0.1\nvt 0 0\nvt 1 0\n"
    "f 7/1 3/1 2/1 6/1\nf 8/1 4/1 3/1 7/1\nf 9/1 5/1 4/2 8/1\n";

/// The same scene by the library.
struct Simulated {
  CachedShape points, drawn;
  std::vector<std::vector<Vec3>> source, positions, normals;

  explicit Simulated(const std::string& file) {
    auto simulation = must(Simulation::create(*kGpu->device(), must(load_scene(file))));
    const auto shape = [&](CacheFormat format) {
      return cached_shape(simulation->fabric(), simulation->meshes(), simulation->origin(), format);
    };
    points = shape(CacheFormat::pc2);
    drawn = shape(CacheFormat::glb);
    for (std::uint32_t k = 0; k < kFrames; ++k) {
      must(simulation->advance(1 / simulation->scene().solver.rate));
      const std::vector<Vec3> vertices = must(simulation->read_vertex_positions()), directions = must(simulation->read_vertex_normals());
      source.push_back(cached_positions(points, vertices));
      positions.push_back(cached_positions(drawn, vertices));
      normals.push_back(cached_normals(drawn, directions));
      // What a shape chooses, said once more without it: after the loose vertex the file's own, then the grid's.
      for (std::size_t v = 0; v < 8; ++v) EXPECT_EQ(source.back()[v + 1], vertices[v]);
      for (std::size_t v = 0; v < 16; ++v) EXPECT_EQ(source.back()[v + 9], vertices[v + 9]);
      EXPECT_EQ(source.back()[0], (Vec3{1001, 1, 1}));
    }
  }
};

TEST_F(Caches, of_a_run_hold_the_frames_that_the_library_makes_to_the_last_bit) {
  ASSERT_NE(kGpu->device(), nullptr) << kGpu->refusal;
  write("strip.obj", kStrip);
  const std::string scene = write("scene.json", kScene);
  std::vector<std::string> call = {"run", scene, "--no-picture", "--out", out()};
  for (const char* name : {"cloth.pc2", "cloth.mdd", "cloth.glb", "cloth.usda", "cloth.ply", "cloth.obj"})
    call.insert(call.end(), {"--cache", name});
  const Outcome outcome = weft(call);
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("final.ply, cloth.pc2, cloth.mdd, cloth.glb, cloth.usda, cloth.ply, cloth.obj in "), std::string::npos)
      << outcome.out;
  const fs::path at = folder / "out";
  EXPECT_EQ(std::distance(fs::directory_iterator(at), {}), 3 + 4 + 2 * kFrames) << "and nothing else";

  const Simulated simulated(scene);
  const ReadCache pc2 = test::read_pc2(read(at / "cloth.pc2")), mdd = test::read_mdd(read(at / "cloth.mdd")),
                  glb = test::read_glb(read(at / "cloth.glb")), usda = test::read_usda(read(at / "cloth.usda"));
  ReadCache of_ply, of_obj;
  for (std::uint32_t k = 1; k <= kFrames; ++k) {
    test::add_ply(of_ply, read(sequence_file(at / "cloth.ply", k, kFrames)));
    test::add_obj(of_obj, read(sequence_file(at / "cloth.obj", k, kFrames)));
  }
  const ReadCache &ply = of_ply, &obj = of_obj;
  for (const ReadCache* cache : {&pc2, &mdd, &glb, &usda, &ply, &obj}) ASSERT_EQ(cache->frames.size(), kFrames);
  for (std::uint32_t k = 0; k < kFrames; ++k) {
    for (const ReadCache* cache : {&pc2, &mdd}) EXPECT_TRUE(same_bits(cache->frames[k], simulated.source[k])) << k;
    for (const ReadCache* cache : {&usda, &ply, &obj}) {
      EXPECT_TRUE(same_bits(cache->frames[k], simulated.positions[k])) << k;
      EXPECT_TRUE(same_bits(cache->normals[k], simulated.normals[k])) << k;
    }
    EXPECT_EQ(glb.frames[k], simulated.positions[k]) << "a kilometre away the differences are exact";
    EXPECT_EQ(mdd.times[k], static_cast<float>((k + 1) / 60.0));
    EXPECT_EQ(usda.times[k], k + 1);
  }
  EXPECT_NE(simulated.source[0], simulated.source[1]) << "it moves";
  EXPECT_EQ(read(sequence_file(at / "cloth.ply", kFrames, kFrames)), read(at / "final.ply"));
}

TEST_F(Caches, of_a_run_that_was_killed_and_goes_on_are_the_same_bits) {
  const std::string scene = write("sheet.json", kSheet);
  const auto call = [&](const char* where, std::vector<std::string> more) {
    std::vector<std::string> words = {"run", scene, "--no-picture", "--frames", "400", "--out", out(where)};
    for (const char* format : {"pc2", "mdd", "glb", "usda", "ply"}) words.insert(words.end(), {"--cache", std::string("a.") + format});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const fs::path killed = folder / "killed", checkpoint = killed / "sheet.snapshot";
  const pid_t child = spawn(call("killed", {"--checkpoint", "10"}));
  for (int tries = 0; tries < 3000 && !fs::exists(checkpoint); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(child, SIGKILL);
  ASSERT_EQ(wait(child).exit, -SIGKILL);
  ASSERT_TRUE(fs::exists(killed / "a.glb.part"));
  ASSERT_FALSE(fs::exists(killed / "a.glb"));

  fs::rename(killed / "a.usda.part", folder / "kept");
  const Outcome missing = weft(call("killed", {"--checkpoint", "10"}));
  EXPECT_EQ(missing.exit, 2);
  EXPECT_EQ(missing.error, "--cache: " + (killed / "a.usda.part").string() + " is not there; --fresh begins anew\n");
  fs::rename(folder / "kept", killed / "a.usda.part");

  const Outcome resumed = weft(call("killed", {"--checkpoint", "10"}));
  ASSERT_EQ(resumed.exit, 0) << resumed.error;
  EXPECT_NE(resumed.out.find("Going on after frame "), std::string::npos) << resumed.out;
  ASSERT_EQ(weft(call("whole", {})).exit, 0);
  std::size_t caches = 0;
  for (const auto& entry : fs::directory_iterator(folder / "whole")) {
    const std::string name = entry.path().filename().string();
    if (name == "report.json" || name == "timings.csv") continue;
    ++caches;
    EXPECT_EQ(read(killed / name) == read(entry.path()), true) << name;
  }
  EXPECT_EQ(caches, 4u + 400 + 1);
  // (A kill in the middle of a file of the sequence leaves its *.part, under a name of its own.)
  for (const char* name : {"a.pc2.part", "a.mdd.part", "a.glb.part", "a.usda.part", "sheet.snapshot"})
    EXPECT_FALSE(fs::exists(killed / name)) << name;
}

TEST_F(Caches, of_a_run_that_was_interrupted_are_none_or_parts) {
  const std::string scene = write("sheet.json", kSheet);
  std::vector<std::string> call = {"run", scene, "--no-picture", "--frames", "1000000", "--out", out(), "--cache", "a.pc2"};
  const auto interrupt = [&] {
    const pid_t child = spawn(call);
    for (int tries = 0; tries < 3000 && read(folder / "stdout").empty(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(child, SIGINT);
    return wait(child);
  };
  const Outcome dropped = interrupt();
  EXPECT_EQ(dropped.exit, 130);
  EXPECT_NE(dropped.error.find("a.pc2 is not written: it has "), std::string::npos) << dropped.error;
  EXPECT_EQ(dropped.out.find("a.pc2"), std::string::npos) << dropped.out;
  for (const auto& entry : fs::directory_iterator(folder / "out")) EXPECT_EQ(entry.path().string().find("a.pc2"), std::string::npos);

  call.insert(call.end(), {"--checkpoint", "100000"});
  const Outcome kept = interrupt();
  EXPECT_EQ(kept.exit, 130);
  EXPECT_NE(kept.error.find("a.pc2 will be written when the run goes on; its part has "), std::string::npos) << kept.error;
  EXPECT_TRUE(fs::exists(folder / "out/a.pc2.part"));
  const auto frames = nlohmann::json::parse(read(folder / "out/report.json"), nullptr, false)["frames"].get<std::size_t>();
  call[4] = std::to_string(frames + 2);   // the header alone of a PC2 says how many there are
  const Outcome resumed = weft(call);
  EXPECT_EQ(resumed.exit, 0) << resumed.error;
  EXPECT_EQ(test::read_pc2(read(folder / "out/a.pc2")).frames.size(), frames + 2);
}

TEST_F(Caches, that_cannot_be_written_are_refused_before_anything_runs) {
  const std::string scene = write("sheet.json", kSheet), at = out() + "/";
  const auto expect = [&](const char* frames, const std::vector<std::string>& caches, int exit, const std::string& sentence) {
    std::vector<std::string> call = {"run", scene, "--no-picture", "--frames", frames, "--out", out()};
    for (const std::string& cache : caches) call.insert(call.end(), {"--cache", cache});
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, exit) << sentence;
    EXPECT_EQ(outcome.error, sentence + '\n');
    EXPECT_FALSE(fs::exists(folder / "out/report.json")) << sentence;
    return outcome.out;
  };
  const std::string refused = "--cache: " + at;
  EXPECT_EQ(expect("3", {"a.abc"}, 2,
                   refused + "a.abc has the extension \".abc\"; caches are .glb, .pc2, .mdd, .usda, or .ply and .obj with a file a frame"),
            "");
  expect("0", {"a.pc2"}, 2, refused + "a.pc2 is not written: a cache has at least one frame, and the run has 0");
  expect("3", {"a.pc2", "./a.pc2"}, 2, refused + "a.pc2 is asked for twice");
  fs::create_directories(folder / "out/a.usda");
  expect("3", {"a.usda"}, 1, at + "a.usda cannot be written: it is a folder");
  fs::create_directories(folder / "out/a_0002.ply");
  expect("3", {"a.ply"}, 1, at + "a_0002.ply cannot be written: it is a folder");
  expect("3", {"/proc/self/a.pc2"}, 1, "/proc/self/a.pc2 cannot be written: No such file or directory");
  expect("40000", {"a.glb"}, 2,
         refused + "a.glb is not written: 40000 frames of 81 vertices take more than 4294967295 bytes, and a GLB has at most 4294967295; "
                   "a .usda, a .pc2 or a .mdd has no such limit");
}

TEST_F(Caches, that_are_read_are_not_written) {
  fs::create_directories(folder / "own");
  for (const auto& [mesh, cache] : {std::pair{"flag.glb", "flag.glb"}, {"flag_0002.obj", "flag.obj"}}) {
    write((std::string("own/") + mesh).c_str(), "cloth");
    const std::string scene = write("flag.json", std::string(R"({"frames": 3, "cloths": [{"mesh": "own/)") + mesh + R"("}]})");
    const Outcome outcome = weft({"run", scene, "--no-picture", "--out", out("own"), "--cache", cache});
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_EQ(outcome.error, out("own") + "/" + mesh + " is read as cloths[0].mesh and would be overwritten: choose another --out\n");
    EXPECT_EQ(read(folder / "own" / mesh), "cloth");
  }
}

TEST_F(Caches, leave_no_half_file_on_a_full_disk) {
  const std::string scene = write("sheet.json", kSheet);
  for (const char* cache : {"a.pc2", "a.usda"}) {
    disk_bytes = 150'000;
    const Outcome outcome = weft({"run", scene, "--no-picture", "--frames", "300", "--out", out(), "--cache", cache});
    EXPECT_EQ(outcome.exit, 1);
    EXPECT_NE(outcome.error.find(std::string(cache) + " cannot be written: File too large"), std::string::npos) << outcome.error;
    EXPECT_TRUE(fs::is_empty(folder / "out")) << cache;
  }
}

// ffmpeg's place is taken by a script that keeps what it is given.
TEST_F(Caches, are_joined_by_a_movie_of_the_pictures_where_there_is_ffmpeg) {
  const std::string scene = write("sheet.json", kSheet);
  const std::vector<std::string> call = {"run", scene, "--frames", "5", "--every", "2", "--movie", "--out", out()};
  environment = {"PATH=" + folder.string()};
  const Outcome missing = weft(call);
  EXPECT_EQ(missing.exit, 1);
  EXPECT_EQ(missing.error, "--movie: the program ffmpeg, which makes it, is not installed\n");
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_EQ(weft({"run", scene, "--movie"}).exit, 2) << "there are no pictures";

  const auto install = [&](const std::string& script) {
    fs::permissions(write("ffmpeg", "#!/bin/sh\nPATH=/bin:/usr/bin\n" + script), fs::perms::owner_all);
  };
  install("for last; do :; done; echo \"$@\" > " + (folder / "words").string() + "; cat > \"$last\"\n");
  const Outcome made = weft(call);
  ASSERT_EQ(made.exit, 0) << made.error;
  std::string pictures;
  for (const char* name : {"frame_0000.png", "frame_0002.png", "frame_0004.png"}) pictures += read(folder / "out" / name);
  EXPECT_EQ(read(folder / "out/sheet.mp4") == pictures, true);
  EXPECT_NE(read(folder / "words").find("-framerate 30 "), std::string::npos) << read(folder / "words");
  fs::remove(folder / "out/sheet.mp4");

  install("exec 0<&-; exit 7\n");
  const Outcome broken = weft(call);
  EXPECT_EQ(broken.exit, 1);
  EXPECT_NE(broken.error.find("sheet.mp4 is not written: ffmpeg ended with the code 7"), std::string::npos) << broken.error;
  EXPECT_FALSE(fs::exists(folder / "out/sheet.mp4") || fs::exists(folder / "out/sheet.mp4.part"));
}

}  // namespace
}  // namespace weft
