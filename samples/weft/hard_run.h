// A hard case run through Weft.
#pragma once

#include <filesystem>
#include <vector>

#include "compute/device.h"
#include "samples/weft/hard_cases.h"

namespace weft::command {

/// The case's scene, with its changes.
Result<Scene> scene_of(const HardCase& hard, const std::filesystem::path& scenes);

/// A figure for each of the case's checks.
Result<std::vector<double>> measure(const compute::Device& device, const HardCase& hard, const Scene& scene);

}  // namespace weft::command
