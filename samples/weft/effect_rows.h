// The effects that a scene can ask for, each by the assignments that switch it on over one base scene: the barest cloth there is, a free
// sheet of links and a patch above it, and nothing else. A new effect is one row in effect_rows.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/scene.h"

namespace weft::command {

struct EffectRow {
  const char* name;
  const char* what;                // for people
  std::vector<Assignment> on;
  std::vector<Assignment> off;     // the same keys with values that call for nothing
};

std::span<const EffectRow> effect_rows();

/// Two effects in one scene. A list that both rows give has the entries of both; a key to which they give two values is an error, a
/// sentence.
Result<std::vector<Assignment>> both_of(const EffectRow& first, const EffectRow& second);

/// The base scene with so many cells along a side of the sheet, and assignments. `folder` is where write_body has put the mesh collider's
/// file.
/// Errors: as parse_scene.
Result<Scene> base_scene(std::uint32_t cells, const std::filesystem::path& folder, std::span<const Assignment> assignments = {});

inline constexpr const char* kBodyFile = "effects_body.obj";
inline constexpr const char* kMorphFile = "effects_morph.gltf";

/// An octahedron, as the mesh collider that a row asks for, and one with a morph target. Errors: what writing a file can meet.
Result<void> write_body(const std::filesystem::path& folder);

}  // namespace weft::command
