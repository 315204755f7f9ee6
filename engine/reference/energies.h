// The discrete energies of a cooked fabric, in double precision: what every solver of Weft minimises. Written from the papers
// and the cooked numbers, independently of the engine's solvers.
//
//   link   C = |a - b| - L,  E = C^2 / (2 alpha);  one that only pulls has E = 0 where C < 0
//   tether a link to a held particle that only pulls and is rigid
//   bend   E = 1/2 k |l|^2,  l = K_1 (p_1 - p_0) + K_2 (p_2 - p_0) + K_3 (p_3 - p_0),  k = B q  (engine/effects/bend)
//
// A rigid link has no potential, so it gets the smallest compliance that matters: alpha / h^2 of at least
// kSoftening (w_a + w_b), with which a link gives way by a millionth of what its two particles would without it. A sheet of n
// particles that hangs from one link stretches it by n kSoftening h^2 g: 3e-7 m for 10,000 particles at h = 1/600 s. For links of
// several edges it is multiplied by the square of their number, which preserves the ratio of the stiffnesses in compliant cloth.
//
// Rest lengths are those before packing for the GPU, from the cooked pose. Packed ones are rounded, each independently
// (2^-19), so no pose satisfies them all, and a sheet of rigid links would be prestressed far beyond its weight.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/reference/trajectory.h"

namespace weft::reference {

inline constexpr double kSoftening = 1e-6;

/// The part of an energy's Hessian in the preconditioner (time_step.h): all of a stiff energy between neighbours in the mesh;
/// of a soft one the diagonal blocks; nothing of a stiff energy between particles farther apart.
enum class Preconditioned { whole, diagonal, left_out };

struct LinkEnergy {
  std::uint32_t a, b;
  double rest;         // m
  double softness;     // 1/kg: alpha / h^2, never 0
  double weight;       // 1/kg: w_a + w_b, above 0
  bool only_pulls;
  Preconditioned part;
};

struct BendEnergy {
  std::array<std::uint32_t, 4> particle;
  std::array<double, 4> k;   // sums to 0
  double stiffness;          // kg: h^2 B q
  Preconditioned part;
};

struct Energies {
  Eigen::VectorXd inverse_masses;   // 1/kg; 0: held
  std::vector<LinkEnergy> links;    // without those between held particles
  std::vector<BendEnergy> bends;
};

Energies energies_of(const CookedFabric& fabric, double h);

}  // namespace weft::reference
