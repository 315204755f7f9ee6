// Vertex block descent on the CPU, in double precision, to find its place on Weft's accuracy curve.
//
// It minimises the incremental potential of a time step, which the reference solves to its end (time_step.h), one particle at
// a time while its neighbours are fixed: p_i <- p_i - H_i^-1 g_i, with g_i and H_i the gradient and Hessian in p_i alone
// (Chen, Liu, Yang, Yuksel 2024, "Vertex block descent", section 3). Particles of a colour share no energy, so a GPU could
// move them in parallel. A step begins with the free motion, with as much of gravity as acted in the step before ("adaptive
// initialisation", section 3.7).
//
// Stiff links stall it: the stiffer they are relative to their particles' masses, the less a particle can move by itself, and
// falling cloth stops in the air. So rigid links take the augmented form (Giles, Diaz, Yuksel 2025, "Augmented vertex block
// descent"): a multiplier, and a stiffness that begins low and grows with the link's violation,
//     force k C* + lambda,   lambda <- k C* + lambda,   k <- k + growth |C*| / (L w),   C* = C - kept C(where the step began)
// once a sweep; both are carried over into the next step, lessened. With `kept` below 1 old errors decay over several steps;
// with `kept` 0 cloth, which has more links than degrees of freedom, blows up.
//
// Limitations: no colliders, no contacts, anchors that stand still; momentum is conserved only as far as a step is solved;
// one thread.
#pragma once

#include "engine/reference/trajectory.h"

namespace weft::reference {

struct VbdSettings {
  std::uint32_t sweeps = 1;       // a time step, over all colours
  bool augmented = true;          // rigid links have multipliers; false: they are stiff springs
  // Measured on hung and falling sheets of 33 x 33 and 100 x 100 particles; times of 1 / (w_a + w_b).
  double start = 0.3;             // lowest stiffness of an augmented link
  double growth = 100;            // of its stiffness with strain
  double kept = 0.5;              // fraction of a link's error at the step's start that the step leaves uncorrected
  double lessened = 0.99;         // factor on stiffnesses and multipliers from step to step
};

struct VbdRun {
  Trajectory trajectory;
  std::uint32_t colours = 0;
};

/// `frames` frames at the scene's rate in steps of fabric.h, from the pose that was cooked, at rest. Errors: a collider,
/// contacts, dihedral elements, keyed anchors; a run that turned non-finite.
Result<VbdRun> integrate_vbd(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, const VbdSettings& settings);

}  // namespace weft::reference
