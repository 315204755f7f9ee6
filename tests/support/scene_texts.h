// What the scene tests share: a folder with the files that their scenes name, and a scene that uses every key.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "engine/scene.h"

namespace weft::scene_test {

// A folder with the files that scenes here name; gone when the test program ends.
class Folder {
 public:
  static const std::filesystem::path& path() {
    static const Folder folder;
    return folder.path_;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

 private:
  Folder() : path_(std::filesystem::temp_directory_path() / ("weft_scene_test_" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directories(path_ / "directory.glb");
    for (const char* name : {"sheet.glb", "weave.png", "weave.jpg", "notes.txt"}) std::ofstream(path_ / name) << name;
  }
  std::filesystem::path path_;
};

inline constexpr const char* kGrid = R"({"cloths": [{"grid": {}}]})";

// A scene that uses every key.
inline constexpr const char* kFull = R"({
  "$schema": "../scene.schema.json", "name": "full", "description": "all keys", "frames": 12, "gravity": [0, -1.5, 0.25],
  "solver": {"rate": 50, "substeps": 7, "iterations": 2, "bend_steps": 3, "averaging": "count", "relaxation": 1,
             "linear": "jacobi", "shifts": false, "longest_advance": 0.05},
  "contacts": {"iterations": 2, "recover": 0.5, "kinematic_lag_limit": 3, "capacity": 4096, "cell": 0.03, "detection_margin": 0.002},
  "cloths": [
    {"name": "curtain", "mesh": "sheet.glb", "transform": {"translate": [1, 2, 3], "axis": [0, 0, 2], "degrees": 90, "scale": 0.5},
     "start": {"pose": "folded", "degrees": 120, "radius": 0.25, "velocity": [0, -1, 2], "imperfection": 0.5, "seed": 4294967295},
     "fabric": {"preset": "denim", "area_density": 0.3, "stretch": "rigid", "shear": 5, "bend": 0, "damping": 0,
                "friction": 0.1, "thickness": 0.004},
     "bending": false, "tethers": {"per_vertex": 2, "slack": 0.1},
     "anchors": [{"top": 0.02, "every": 8, "keys": [{"time": 0}, {"time": 1, "translate": [0, 1, 0], "axis": [1, 0, 0], "degrees": 720}]},
                 {"box": {"low": [0, 0, 0], "high": [1, 1, 1]}}, {"vertices": [0, 5]}],
     "appearance": {"albedo": "weave.png", "normal": "weave.png", "roughness": "weave.jpg", "occlusion": "weave.jpg",
                    "base_colour": [1, 0, 0], "roughness_factor": 0.5, "metallic": 0.25, "repeat": [4, 6], "mesh_materials": true}},
    {"grid": {"size": [2, 3], "cells": [4, 5], "topology": "centre", "upright": true},
     "fabric": "silk", "bends_as_plate": true, "bend_rest": "mesh", "tethers": false, "skin": {"takes_targets": true}, "meets": ["curtain"],
     "anchors": [{"corners": ["low_high", "high_high"]}]}],
  "colliders": [{"shape": "sphere", "centre": [0, 1, 0], "radius": 0.25, "friction": 0, "colour": [0, 1, 0], "keys": [{"time": 2}]},
                {"shape": "plane", "centre": [0, -1, 0], "normal": [0, 0, 5]},
                {"shape": "capsule", "axis": [2, 0, 0], "length": 0.75, "radius": 0.125, "radius_end": 0.25, "meets": ["cloth", "curtain"]},
                {"shape": "box", "size": [1, 2, 3], "axis": [0, 0, 4], "degrees": 45, "resizes": true,
                 "bone": {"cloth": "cloth", "joint": ""}},
                {"shape": "mesh", "mesh": "sheet.glb", "centre": [0, 2, 0], "axis": [0, 3, 0], "degrees": 30, "scale": 2,
                 "thickness": 0.004}],
  "camera": {"eye": [0, 1, 5], "target": [0, 1, 0], "fov_degrees": 30},
  "light": {"direction": [0, -2, 0], "colour": [1, 1, 1], "sun": 3, "sky": 0.5}
})";

inline Result<Scene> parse(std::string_view text, std::vector<Assignment> assignments = {}) {
  return parse_scene(text, Folder::path(), assignments);
}

// A grid cloth with one more key.
inline std::string cloth_with(const std::string& key_and_value) { return R"({"cloths": [{"grid": {}, )" + key_and_value + "}]}"; }

inline std::string fault_of(std::string_view text, std::vector<Assignment> assignments = {}) {
  const Result<Scene> scene = parse(text, std::move(assignments));
  return scene ? "no fault" : scene.error();
}

inline bool mentions(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

}  // namespace weft::scene_test
