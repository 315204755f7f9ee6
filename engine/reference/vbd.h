// Vertex block descent on the CPU, in double precision: what would it buy on Weft's curve?
//
// It minimises the incremental potential of a time step that the reference solves to its end (time_step.h), a particle at a time while
// its neighbours stand still: p_i <- p_i - H_i^-1 g_i, g_i and H_i gradient and Hessian in p_i alone (Chen, Liu, Yang, Yuksel
// 2024, "Vertex block descent", section 3). Particles of a colour share no energy, so that a GPU could move them at once. A step
// begins with the free motion, of gravity as much as acted in the step before ("adaptive initialisation", section 3.7).
//
// Steepness freezes it: the stiffer the links beside their particles' masses, the less a particle can move by itself, and cloth that falls
// stops in the air. So rigid links take the augmented form (Giles, Diaz, Yuksel 2025, "Augmented vertex block descent"): a
// multiplier, and a stiffness that begins low and grows with what the link violates,
//     force k C* + lambda,   lambda <- k C* + lambda,   k <- k + growth |C*| / (L w),   C* = C - kept C(where the step began)
// once a sweep; both go over into the next step, lessened. `kept` below 1 takes old errors away by and by: with none of them kept, cloth,
// which has more links than freedoms, blows up.
//
// Limitations: no colliders, no contacts, anchors that stand still; momentum is kept only as far as a step is solved; one thread.
#pragma once

#include "engine/reference/trajectory.h"

namespace weft::reference {

struct VbdSettings {
  std::uint32_t sweeps = 1;       // a time step, over all colours
  bool augmented = true;          // rigid links; or stiff springs, as every other is
  // Measured on hung and falling sheets of 33 x 33 and 100 x 100 particles; times of 1 / (w_a + w_b).
  double start = 0.3;             // lowest stiffness of an augmented link
  double growth = 100;            // of its stiffness with strain
  double kept = 0.5;              // of an error that a step began with
  double lessened = 0.99;         // stiffnesses and multipliers from step to step
};

struct VbdRun {
  Trajectory trajectory;
  std::uint32_t colours = 0;
};

/// `frames` frames at the scene's rate in steps of fabric.h, from the pose that was cooked, at rest. Errors: a collider, contacts, hinges, keyed
/// anchors; a run that turned non-finite.
Result<VbdRun> integrate_vbd(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, const VbdSettings& settings);

}  // namespace weft::reference
