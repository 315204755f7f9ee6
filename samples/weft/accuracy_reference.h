// References for an accuracy sweep: the same scene solved by Newton's method in double precision (engine/reference/trajectory.h),
// saved on disk, since they cost more than all that is compared with them.
#pragma once

#include <filesystem>
#include <string>

#include "engine/reference/trajectory.h"
#include "engine/scene.h"

namespace weft::command {

/// The scene's run of `frames` frames in time steps of 1 / (rate substeps). Loaded from `folder` if it is there, and saved
/// there otherwise; the name tells the scene, what was cooked from it, the frames and the step. Errors: those of integrate_newton,
/// and "stopped" after ctrl-C.
Result<reference::Trajectory> reference_run(Scene scene, std::uint32_t substeps, std::uint32_t frames, const std::filesystem::path& folder);

}  // namespace weft::command
