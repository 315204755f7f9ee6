// JSON values to a Scene, by the tables in engine/scene/fields.h. Internal.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "engine/scene.h"
#include "engine/scene/faults.h"

namespace weft {

/// Fills `scene` from `value`; every fault is added to `faults` with its JSON path. `folder` is where files are looked for.
void read_scene(const nlohmann::json& value, const std::filesystem::path& folder, Scene& scene, Faults& faults);

}  // namespace weft
