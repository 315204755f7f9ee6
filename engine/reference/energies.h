// The discrete energies of a cooked fabric, in double precision: what every solver of Weft minimises, written from the papers
// and from the numbers that the cook made, and from nothing else.
//
//   link   C = |a - b| - L,  E = C^2 / (2 alpha);  one that only pulls has E = 0 where C < 0
//   tether a link to a held particle that only pulls and is rigid
//   bend   E = 1/2 k |l|^2,  l = K_1 (p_1 - p_0) + K_2 (p_2 - p_0) + K_3 (p_3 - p_0),  k = B q  (Bergou et al. 2006)
//
// A rigid link has no potential. It becomes one of the smallest compliance that is worth telling apart: alpha / h^2 of at least
// kSoftening (w_a + w_b), so that a link gives way by a millionth of what its two particles would without it. A sheet of n
// particles that hangs from one link stretches it by n kSoftening h^2 g: 3e-7 m for 10,000 particles at h = 1/600 s. Links of
// several edges get that for every edge under them, squared, which keeps the ratio of the stiffnesses that compliant cloth has.
//
// Rest lengths are taken as they were before they were packed for the GPU, from the pose that was cooked: packed ones are rounded, each
// its own way (2^-19), so that no pose fits them all, and a sheet of rigid links would be prestressed far beyond its weight.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/reference/trajectory.h"

namespace weft::reference {

inline constexpr double kSoftening = 1e-6;

/// What of an energy a preconditioner knows (time_step.h): all of a stiff one between neighbours in the mesh; of a soft one what it does
/// to each of its particles; nothing of a stiff one between others.
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
