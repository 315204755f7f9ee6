// The reference: a run of a scene on the CPU, in double precision, with which accuracy studies compare runs on the GPU.
//
// The reference takes the same time steps as the engine (implicit Euler, symplectic in gravity and drag) over the same cooked
// links, bends, tethers and anchors, and solves each step to its end (newton.cpp). So a GPU's distance to it at the same h is
// the solver's error alone, and the distance between two references, at h and at h / 16, is the error of the time step.
//
// Limitations: no colliders, no contacts and no cloth that bends about its mesh's angles; a scene with them is refused. Rigid
// links and tethers give way by a millionth of what their particles' masses do (energies.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/scene.h"

namespace weft::reference {

using Positions = Eigen::Matrix3Xd;   // one column a particle, in CookedFabric's order (m)

/// Poses at the ends of frames: poses[k] at (k + 1) * frame_seconds.
struct Trajectory {
  double frame_seconds = 0;
  std::vector<Positions> poses;
  std::uint64_t not_converged = 0;   // steps that ended above the tolerance; every report names them
  std::uint64_t newton_steps = 0;    // of all time steps together
};

/// Called after each step with how much is done (0 ... 1); false stops the run (an error then says that it was stopped).
using Progress = std::function<bool(double)>;

/// `h` (s) must divide the scene's frame into whole steps. A step has converged when no particle and no link asks for a
/// further displacement of more than `tolerance` times the largest that gravity or the constraints cause in it.
struct NewtonSettings {
  double h = 0;
  double tolerance = 1e-10;
  std::uint32_t most_steps = 50;
};

/// Newton on the incremental potential, implicit Euler with steps of `h`; `frames` frames at the scene's rate, from the pose
/// that was cooked, at rest. Errors: a collider, contacts or dihedral elements, an h that does not divide the frame, a run
/// that was stopped or turned non-finite.
Result<Trajectory> integrate_newton(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, const NewtonSettings& settings,
                                    const Progress& progress = {});

}  // namespace weft::reference
