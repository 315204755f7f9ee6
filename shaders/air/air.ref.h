// Twin of air in double precision.
#pragma once

#include <cmath>
#include <span>

#include "engine/effects/air/air.h"
#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// The velocity of gusts and eddies at x when `fraction` of the frame is over (m/s).
inline Vector stirred_at(const MovingAir& air, const Vector& x, double fraction) {
  const auto wide = [](const gpu::vec3& v) { return Vector(v.x, v.y, v.z); };
  Vector velocity = Vector::Zero();
  for (std::uint32_t k = 0; k < air.used; ++k)
    velocity += wide(air.waves[k].velocity) *
                std::sin(wide(air.waves[k].wave).dot(x) + double(air.waves[k].phase) + fraction * double(air.waves[k].turn));
  return velocity;
}

/// Force (N) of air that comes at `u` on a plate with the unit normal n.
inline Vector air_force(const gpu::Air& air, double area, const Vector& n, const Vector& u) {
  const double speed = u.norm(), c = speed > 0 ? n.dot(u) / speed : 0;
  return double(air.half_density) * area * speed *
         ((double(air.drag) * c * c + double(air.friction) * (1 - c * c)) * u + double(air.lift) * c * (speed * n - c * u));
}

struct AirCorner {
  std::uint32_t b, c;   // the others of a triangle, in winding order
  double area;          // m^2, at rest
};

/// By how much air that comes at `u` changes a particle's velocity in a substep h.
inline Vector push_by_air(const gpu::Air& air, std::span<const AirCorner> corners, const Vector& at, const Points& x, const Vector& u,
                          double inverse_mass, double h) {
  Vector force = Vector::Zero();
  double most = 0;
  for (const auto& [b, c, area] : corners) {
    const Vector across = (x[b] - at).cross(x[c] - at);
    force += air_force(air, area / 3, across.norm() > 1e-15 ? Vector(across.normalized()) : Vector(Vector::Zero()), u);
    most += double(air.half_density) * area / 3 * u.norm() * double(air.most);
  }
  const double share = h * inverse_mass, b = share * most;
  return share / std::sqrt(1 + b * b) * force;
}

}  // namespace weft::reference
