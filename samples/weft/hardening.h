// A scene run under a perturbation, and what was measured. Poses are given in the unperturbed scene's place and size, so that they
// can be compared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compute/device.h"
#include "engine/metrics.h"
#include "samples/weft/perturbation.h"

namespace weft::command {

/// What was measured in one run.
struct PerturbedRun {
  std::uint32_t non_finite = 0;       // particles, put back or not
  double pins_off = 0;                // m: how far the worst anchor was from where it belongs, in any frame
  double kinematic_lag_limit = 0;     // m: how far from there cloth in their way may hold anchors
  Strain strain;                      // at the end
  std::uint32_t overflowed = 0;       // contacts
  std::uint64_t crossings = 0;        // of the worst frame; 0 in scenes without contacts
  double simulated = 0, clamped = 0;  // s
  double wall = 0;                    // s
  std::vector<Vec3> pose;             // cloths' particles at the end
  double size = 0;                    // m, diagonal of the box around the cloths as they start at rest
};

/// Runs `frames` frames' worth of the scene's time. Stops early when interrupted.
Result<PerturbedRun> run_perturbed(const compute::Device& device, const Scene& scene, const Perturbation& perturbation,
                                   std::uint32_t frames);

/// Relative to the cloths' size: how far the mean of all particles is from where it was without the perturbation, and how far the
/// particles are (rms).
struct Difference {
  double mean = 0, shape = 0;
};
Difference difference(const PerturbedRun& with, const PerturbedRun& without);

/// Of Difference::shape over that of the mean: folds of free cloth may come to lie another way.
inline constexpr double kShapeBands = 2;

/// What did not hold, a few words each; empty when all did. `band`: limit of Difference::mean.
std::vector<std::string> broken(const Perturbation& perturbation, const PerturbedRun& with, const PerturbedRun& without, double band);

}  // namespace weft::command
