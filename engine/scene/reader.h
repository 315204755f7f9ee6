// JSON values to a Scene, by the tables in engine/scene/fields.h. Internal.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "engine/scene.h"
#include "engine/scene/faults.h"

namespace weft {

/// What keys that name files may name.
struct Nameable {
  const std::filesystem::path& folder;       // where files are looked for
  std::span<const std::string> meshes = {};  // that a program made (engine/cook/given.h): they come before files
};

/// Fills `scene` from `value`; every fault is added to `faults` with its JSON path.
void read_scene(const nlohmann::json& value, const Nameable& nameable, Scene& scene, Faults& faults);

/// parse_scene, of a scene that may name these meshes, too.
Result<Scene> parse_scene_with(std::string_view text, const Nameable& nameable, std::span<const Assignment> assignments);

}  // namespace weft
