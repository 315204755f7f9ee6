// Errors of a run against the reference, and figures of a pose by itself.
//
//   solver error   rms distance of a run to the reference with the same time step
//   time error     rms distance of the reference with that step to the one with a sixteenth of it
//
// over all particles and frames, relative to the sheet's size. Both are errors of the simulation, not of the model of cloth.
#pragma once

#include <span>

#include "engine/metrics.h"
#include "engine/reference/trajectory.h"

namespace weft::reference {

/// Longest side of the box around the cooked pose (m).
double sheet_size(const CookedFabric& fabric);

/// Positions that a GPU handed back, of cloth's particles alone.
Positions pose_of(const CookedFabric& fabric, std::span<const gpu::vec4> positions);

/// Rms distance of two poses, and of two runs over the frames that both have; relative to `size` (m). NaN where a pose is not
/// finite. Poses must have the same particles.
double pose_error(const Positions& pose, const Positions& reference, double size);
double run_error(const Trajectory& run, const Trajectory& reference, double size);

struct Errors {
  double solver = 0, time = 0;
};
Errors errors_of(const Trajectory& run, const Trajectory& same_step, const Trajectory& fine_step, double size);

/// |length / rest - 1| over the links that both push and pull, as weft::measure_strain has it, of a pose in double precision.
Strain measure_strain(const CookedFabric& fabric, const Positions& pose);

/// Momenta and energies of the particles that are not held: conserved, or changing in a known way. Velocities are differences
/// of two poses `seconds` apart, all else is of the later one. Rigid links and tethers have no energy.
struct Balance {
  Eigen::Vector3d momentum;           // kg m/s
  Eigen::Vector3d angular_momentum;   // kg m^2/s, about the origin
  double kinetic = 0, elastic = 0, bending = 0, height = 0;   // J; height: -m g x
  double energy() const { return kinetic + elastic + bending + height; }
};
Balance balance_of(const CookedFabric& fabric, const Positions& before, const Positions& after, double seconds, Vec3 gravity);

}  // namespace weft::reference
