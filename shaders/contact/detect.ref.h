// Twin of the detection (detect_track, detect_outline, pair_faces, pair_edges): which pairs may meet, over all pairs, in double precision and
// without a grid. Derived for two convex primitives A and B on their trajectories r_i + s q_i / H, s the substeps since the
// detection: along any direction n the sides' least heights, each towards itself, are concave in s. Within substep s each particle
// is within the displacement bound R of a place on its trajectory between s - 1 and s, so the gap along n is at least that of the
// lower of both places of either side, less the largest R of either. pair.glsl has the inequality, and says which directions are tried.
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
  std::vector<double> bounds;   // m, R: displacement bounds
};

/// The trajectory of H substeps, from the step of one.
inline Vector path_along(const Vector& step, double cell) {
  const double longest = kMostCells * cell;
  return kHorizon * (step.norm() > longest ? Vector(longest / step.norm() * step) : step);
}

using Particles = std::array<std::uint32_t, 4>;

/// Whether a pair can be a candidate: it has no particle twice, nor two of a cloth that were one before it tore, and one of them moves. The
/// first `a` particles are side A.
inline bool can_be_pair(const Tracks& t, const Particles& p, int a) {
  for (int i = 0; i < a; ++i)
    for (int j = a; j < 4; ++j)
      if (p[i] == p[j] || (t.cloth[p[i]] == t.cloth[p[j]] && t.rest[p[i]] == t.rest[p[j]])) return false;
  return std::any_of(p.begin(), p.end(), [&](std::uint32_t i) { return t.inverse_masses[i] > 0; });
}

/// The separation that a pair keeps (m).
inline double keep_of(const Tracks& t, const Particles& p, int a) {
  const double separation = (t.thickness[p[0]] + t.thickness[p[static_cast<std::size_t>(a)]]) / 2;
  if (t.cloth[p[0]] != t.cloth[p[static_cast<std::size_t>(a)]]) return separation;
  return std::min(separation, kShareOfRest * closest({t.rest[p[0]], t.rest[p[1]], t.rest[p[2]], t.rest[p[3]]}, a).distance);
}

/// The least gap of two sides along n, the first `a` particles side A's, over all substeps, whoever is stopped (m).
inline double least_gap(const Vector& n, std::span<const Vector> from, std::span<const Vector> way, int a) {
  // Side A's (0) or B's (1) least height towards itself after s substeps.
  const auto least = [&](int side, double s) {
    double height = INFINITY;
    for (std::size_t i = side == 0 ? 0 : static_cast<std::size_t>(a); i < (side == 0 ? static_cast<std::size_t>(a) : 4); ++i)
      height = std::min(height, (side == 0 ? 1 : -1) * n.dot(from[i] + s / kHorizon * way[i]));
    return height;
  };
  double gap = INFINITY;
  for (double s = 1; s <= kHorizon; ++s)
    gap = std::min(gap, std::min(least(0, s - 1), least(0, s)) + std::min(least(1, s - 1), least(1, s)));
  return gap;
}

/// By how much the two sides are further apart than they need to be for the pair to be left out (m); below 0 it is a candidate.
inline double spare_distance(const Tracks& t, const Particles& p, int a) {
  Points from, to, way;
  for (const std::uint32_t i : p) {
    from.push_back(t.references[i]);
    way.push_back(t.paths[i]);
    to.push_back(t.references[i] + t.paths[i]);
  }
  double gap = -INFINITY;
  for (const Points* pose : {&from, &to}) {
    const Quad x{(*pose)[0], (*pose)[1], (*pose)[2], (*pose)[3]};
    const Vector d = offset(closest(x, a).weights, x);
    if (d.norm() > 0) gap = std::max(gap, least_gap(d.normalized(), from, way, a));
  }
  if (a == 2) {
    const Vector middles = from[0] + from[1] - from[2] - from[3] + to[0] + to[1] - to[2] - to[3];
    if (middles.norm() > 0) gap = std::max(gap, least_gap(middles.normalized(), from, way, a));
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) gap = std::max(gap, least_gap(sign * Vector::Unit(axis), from, way, a));
  double bounds[2] = {0, 0};
  for (int i = 0; i < 4; ++i) bounds[i < a ? 0 : 1] = std::max(bounds[i < a ? 0 : 1], t.bounds[p[static_cast<std::size_t>(i)]]);
  return gap - bounds[0] - bounds[1] - keep_of(t, p, a);
}

}  // namespace weft::reference
