// Twin of the detection (detect_trajectory, pair_faces, pair_edges): which pairs may meet, over all pairs, in double precision and
// without a grid. Derived for two convex primitives A and B on their trajectories r_i + s q_i / H, s the substeps since the
// detection: two of their points, mixtures of the particles, are d apart at s = 0. They approach by the difference of their
// trajectories; or by that of H - 1 substeps and a whole step of one side, if the other is stopped at the start of the last; and
// by the displacement bound R on either side (pair.glsl has the inequalities).
#pragma once

#include <algorithm>
#include <cstdint>

#include "shaders/contact/proximity.ref.h"

namespace weft::reference {

constexpr double kHorizon = 10;   // substeps, H: the candidate lifetime
constexpr double kMostCells = 32;
constexpr double kShareOfRest = 0.9;

struct Tracks {
  Points references, paths, rest;
  std::vector<double> thickness, inverse_masses;
  std::vector<std::uint32_t> cloth;
  double margin;   // m, R: the detection margin
};

/// The trajectory of H substeps, from the step of one.
inline Vector path_along(const Vector& step, double cell) {
  const double longest = kMostCells * cell;
  return kHorizon * (step.norm() > longest ? Vector(longest / step.norm() * step) : step);
}

using Particles = std::array<std::uint32_t, 4>;

/// The box that the surface of a side cannot leave: no particle is further than its displacement bound from its trajectory.
inline Eigen::AlignedBox3d box_of(const Tracks& t, std::span<const std::uint32_t> side) {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t i : side) box.extend(t.references[i]).extend(t.references[i] + t.paths[i]);
  const Vector margin = Vector::Constant(t.margin + t.thickness[side[0]] / 2);
  return {box.min() - margin, box.max() + margin};
}

/// Whether a pair can be a candidate: it has no particle twice, and one of them moves. The first `a` particles are side A.
inline bool can_be_pair(const Tracks& t, const Particles& p, int a) {
  for (int i = 0; i < a; ++i)
    for (int j = a; j < 4; ++j)
      if (p[i] == p[j]) return false;
  return std::any_of(p.begin(), p.end(), [&](std::uint32_t i) { return t.inverse_masses[i] > 0; });
}

/// The separation that a pair keeps (m).
inline double keep_of(const Tracks& t, const Particles& p, int a) {
  const double separation = (t.thickness[p[0]] + t.thickness[p[static_cast<std::size_t>(a)]]) / 2;
  if (t.cloth[p[0]] != t.cloth[p[static_cast<std::size_t>(a)]]) return separation;
  return std::min(separation, kShareOfRest * closest({t.rest[p[0]], t.rest[p[1]], t.rest[p[2]], t.rest[p[3]]}, a).distance);
}

/// By how much the two sides are further apart than they need to be for the pair to be left out (m); below 0 it is a candidate.
inline double spare_distance(const Tracks& t, const Particles& p, int a) {
  const std::span<const std::uint32_t> all(p);
  const auto side_a = all.first(static_cast<std::size_t>(a)), side_b = all.subspan(static_cast<std::size_t>(a));
  const auto box_a = box_of(t, side_a), box_b = box_of(t, side_b);
  const double apart = std::max((box_b.min() - box_a.max()).maxCoeff(), (box_a.min() - box_b.max()).maxCoeff());
  if (apart > 0) return apart;
  double relative = 0, step = 0;
  for (const std::uint32_t i : side_a)
    for (const std::uint32_t j : side_b) {
      relative = std::max(relative, (t.paths[i] - t.paths[j]).norm());
      step = std::max({step, t.paths[i].norm() / kHorizon, t.paths[j].norm() / kHorizon});
    }
  const double closer = std::max(relative, (1 - 1 / kHorizon) * relative + step);
  const double distance = closest({t.references[p[0]], t.references[p[1]], t.references[p[2]], t.references[p[3]]}, a).distance;
  return std::max(apart, distance - closer - 2 * t.margin - keep_of(t, p, a));
}

}  // namespace weft::reference
