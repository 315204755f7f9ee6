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

/// The velocity of a field at x (m/s).
inline Vector field_at(const Air::Field& field, const Vector& x) {
  const Vector d = x - Vector(field.centre.x, field.centre.y, field.centre.z), velocity(field.velocity.x, field.velocity.y, field.velocity.z);
  const Vector way = velocity.norm() > 0 ? Vector(velocity.normalized()) : Vector(Vector::Zero());
  const double along = d.dot(way), across = (d - along * way).norm();
  switch (field.shape) {
    case Air::Field::Shape::jet: {
      if (along < 0) return Vector::Zero();
      const double half_width = std::max(field.radius, 0.094 * along), core = 5.8 * 2 * field.radius;
      return (along > core ? core / along : 1) * std::exp2(-std::pow(across / half_width, 2)) * velocity;
    }
    case Air::Field::Shape::vortex: {   // alpha solves exp(alpha) = 1 + 2 alpha: then it is fastest at the radius of the core
      constexpr double kAlpha = 1.2564312086261697;
      if (across < 1e-9) return Vector::Zero();
      const double r = across / field.radius, speed = velocity.norm() * (1 + 0.5 / kAlpha) / r * (1 - std::exp(-kAlpha * r * r));
      return speed * way.cross(d).normalized();
    }
    default: break;
  }
  const Vector half(field.size.x / 2, field.size.y / 2, field.size.z / 2);
  const double outside = field.shape == Air::Field::Shape::box ? (d.cwiseAbs() - half).cwiseMax(0).norm() : std::max(d.norm() - field.radius, 0.0);
  const double t = outside <= 0 ? 0 : field.falloff > 0 ? std::min(outside / field.falloff, 1.0) : 1;
  return (1 - t * t * (3 - 2 * t)) * velocity;
}

/// The part of the velocity that is lost at d (m) from the middle of a body of this radius, in a wind that goes along `way`.
inline double deficit_at(const Vector& d, const Vector& way, double radius) {
  const double behind = d.dot(way);
  if (behind <= 0) return 0;
  const double far = std::max(behind / (2 * radius), 1.0), width = 0.6 * radius * std::cbrt(far);
  return std::exp2(-(d - behind * way).squaredNorm() / (width * width)) / std::pow(far, 2.0 / 3);
}

/// What a surface shows to a wind that goes along `way`: the disc that it is taken for.
struct Disc {
  Vector middle = Vector::Zero();
  double radius = 0;   // m
};
inline Disc shown_disc(std::span<const std::array<std::uint32_t, 3>> triangles, const Points& x, const Vector& way) {
  double front = 0, back = 0;
  Vector sum = Vector::Zero();
  for (const auto& [a, b, c] : triangles) {
    const double area = (x[b] - x[a]).cross(x[c] - x[a]).dot(way) / 2;
    (area > 0 ? front : back) += std::abs(area);
    sum += std::abs(area) * (x[a] + x[b] + x[c]) / 3;
  }
  if (front + back == 0) return {};
  return {sum / (front + back), std::sqrt(std::max(front, back) / 3.14159265358979323846)};
}

/// The same as deficit_at of a disc, at d from its middle.
inline double deficit_of_disc(const Vector& d, const Vector& way, double radius) {
  if (radius == 0) return 0;
  return std::min(1.0, d.dot(way) / (0.1 * radius)) * deficit_at(d, way, radius);
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

/// By how much air that comes at `u` changes a particle's velocity in a time h (s).
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
