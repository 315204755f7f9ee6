// Limits of a scene's values: ranges, names, and lengths of lists. Internal: not part of the public API.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "engine/scene.h"

namespace weft::scene_fields {

/// What a number may be. `unit` is only for people.
struct Range {
  double low, high;
  bool above = false;  // low itself is excluded
  bool below = false;  // high itself is excluded
  std::string_view unit = "";
};

constexpr Range between(double low, double high, std::string_view unit = "") { return {low, high, false, false, unit}; }
constexpr Range above(double low, double high, std::string_view unit = "") { return {low, high, true, false, unit}; }
constexpr Range below(double low, double high, std::string_view unit = "") { return {low, high, false, true, unit}; }
constexpr Range inside(double low, double high, std::string_view unit = "") { return {low, high, true, true, unit}; }

// 100 km from the origin floats are 8 mm apart: too coarse for cloth.
constexpr double kFarthest = 1e5;  // m
constexpr Range kPlace = between(-kFarthest, kFarthest, "m");
constexpr Range kTurn = between(-1e6, 1e6, "degrees");
// Stiffer than 1e9 N/m is beyond what float positions resolve; "rigid" says it better.
constexpr Range kStiffness = above(0, 1e9, "N/m");
constexpr Range kFriction = between(0, 10);
constexpr Range kThickness = between(0, 1, "m");

// Squares of floats vanish for shorter vectors.
constexpr double kShortestDirection = 1e-12;
inline std::string no_direction(const std::string& length) {
  return "is a vector of length " + length + ": a direction needs one above 1e-12";
}

constexpr Range kCells = between(1, 2048);

constexpr std::size_t kMostCloths = 1024;
constexpr std::size_t kMostKeys = 100'000;
constexpr std::size_t kMostVertices = 4'000'000;  // as many as a mesh may have

using Names = std::span<const std::string_view>;
inline constexpr std::array<std::string_view, 2> kTopologies = {"diagonal", "centre"};
inline constexpr std::array<std::string_view, 6> kStartPoses = {"rest", "stretched", "folded", "flattened", "scrambled", "collapsed"};
inline constexpr std::array<std::string_view, 9> kMethods = {"default", "jacobi", "strands", "gauss_seidel", "chebyshev", "mass_spring",
                                                             "verlet", "implicit", "auto"};
inline constexpr std::array<std::string_view, 2> kLinears = {"cg", "jacobi"};
inline constexpr std::array<std::string_view, 2> kAveragings = {"mass_split", "count"};
inline constexpr std::array<std::string_view, 7> kMeshEndings = {".gltf", ".glb", ".obj", ".ply", ".stl", ".dae", ".fbx"};
inline constexpr std::array<std::string_view, 3> kPictureEndings = {".png", ".jpg", ".jpeg"};

}  // namespace weft::scene_fields
