// Scenes of one sheet for the tests of Simulation, and what is measured on it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <vector>

#include "engine/simulation.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/without_contacts.h"

namespace weft {

inline constexpr double kFrame = 1.0 / 60;   // s

/// A flat sheet of 1 m by 1 m in the xz plane at y = 0, free, in gravity, without colliders or damping.
inline Scene sheet(std::uint32_t cells) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, false};
  cloth.fabric.damping = 0;
  return scene;
}

inline Anchor held_at(std::vector<Corner> corners) {
  Anchor anchor;
  anchor.corners = std::move(corners);
  return anchor;
}

inline Collider plane(float height, double friction = 0.4) {
  Collider collider;
  collider.centre = {0, height, 0};
  collider.friction = friction;
  return collider;
}

inline Collider sphere(Vec3 centre, double radius) {
  Collider collider;
  collider.shape = ColliderShape::sphere;
  collider.centre = centre;
  collider.radius = radius;
  return collider;
}

inline Collider capsule(Vec3 centre, double radius, double length, Vec3 axis, double friction = 0.4) {
  Collider collider;
  collider.shape = ColliderShape::capsule;
  collider.centre = centre;
  collider.radius = radius;
  collider.length = length;
  collider.axis = axis;
  collider.friction = friction;
  return collider;
}

inline void run(Simulation& simulation, double seconds, double frame = 1.0 / 60) {
  const long frames = std::lround(seconds / frame);
  for (long k = 0; k < frames; ++k) must(simulation.advance(frame));
}

inline std::uint64_t hash_of(const Simulation& simulation) { return position_hash(must(simulation.read_positions())); }
inline Strain strain_of(const Simulation& simulation) { return measure_strain(simulation.fabric(), must(simulation.read_positions())); }

/// Mean of the positions, weighted by mass: the centre of mass. Anchors, which have no finite mass, are left out.
struct Point {
  double x = 0, y = 0, z = 0;
};
inline Point centre_of_mass(const std::vector<gpu::vec4>& positions) {
  Point sum;
  double mass = 0;
  for (const gpu::vec4& p : positions) {
    if (p.w == 0) continue;
    sum = {sum.x + p.x / p.w, sum.y + p.y / p.w, sum.z + p.z / p.w};
    mass += 1 / p.w;
  }
  return {sum.x / mass, sum.y / mass, sum.z / mass};
}

/// How far rounding carries the centre of mass of so many particles along an axis within a second, root mean square (m). Every projection
/// of a particle rounds its position, of up to a metre, by 2^-24 m times 0.29; what is rounded in one of 600 substeps is velocity times h,
/// so velocities walk at random, and the drift is their integral.
inline double rounding_drift(double projections, double particles) {
  constexpr double kSubsteps = 600;
  return 0.29 * 0x1p-24 * kSubsteps * std::sqrt(projections * kSubsteps / particles) / std::sqrt(3);
}

inline double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

inline double top_speed(const Simulation& simulation) {
  double fastest = 0;
  for (const gpu::vec4& v : must(simulation.read_velocities()))
    fastest = std::max(fastest, std::hypot(double(v.x), double(v.y), double(v.z)));
  return fastest;
}

}  // namespace weft
