// How triangles look: as a scene says of a cloth, or as materials of a mesh's file say (glTF's metallic-roughness model).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh.h"
#include "engine/scene.h"

namespace weft::shading {

/// What of a picture a texture has, and where it has it.
enum class Map { albedo, normal, roughness, surface, occlusion };   // surface: roughness in green and metal in blue, as in glTF

struct Source {
  Map map = Map::albedo;
  std::filesystem::path file = {};         // PNG or JPEG; or
  const std::string* embedded = nullptr;   // one in memory. Neither: a texel that changes nothing
  double strength = 1;                     // of normals' slopes, and of occlusion
};

struct Look {
  std::string name;            // for errors: cloth "dress", material 2
  std::array<Source, 4> maps;  // albedo, normal, roughness or surface, occlusion
  Vec3 base_colour{1, 1, 1};   // linear, multiplies albedo
  double roughness = 1, metallic = 0;   // multiply what the map has
  Vec2 repeat{1, 1};
  double cutoff = 0;           // what has less alpha is not there; 0: all is
};

/// Of the triangles that no material of the file's is drawn for.
Look look_of(std::string name, const Appearance& appearance, const std::filesystem::path& folder);

/// A mesh's triangles in runs that look alike, each with its material; in one of none (kNone) where a cloth is not to look as its file says.
std::vector<std::pair<std::uint32_t, std::vector<Triangle>>> runs_of(const RenderMesh& mesh, const Appearance* appearance);

/// Of each material of the mesh; `notes` gets a sentence for what of them pictures do not have. Points into the mesh.
std::vector<Look> looks_of(const std::string& name, const Materials& materials, std::vector<std::string>& notes);

}  // namespace weft::shading
