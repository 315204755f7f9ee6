// Random colliders that move, and their twins.
#pragma once

#include <cmath>

#include "engine/effects/collide/collide.h"
#include "shaders/collide/collide.ref.h"
#include "tests/support/single_pass.h"

namespace weft {

inline constexpr int kBodySubstep = 2;   // of four

// Random bodies of one shape that move, and spin or tilt. Capsules `tapered`: with two radii, of which each third hides the smaller end in
// the larger.
inline std::vector<gpu::Collider> bodies(Random& random, ColliderShape shape, double speed, bool tapered = false) {
  std::vector<gpu::Collider> colliders;
  const auto one = [&](double low, double high) { return static_cast<float>(between(random, low, high)); };
  for (int k = 0; k < 3; ++k) {
    gpu::Collider c{};
    c.radius = one(0.2, shape == ColliderShape::capsule ? 0.5 : 0.8);
    c.friction = one(0, 1);
    c.half_size = {one(0.2, 0.4), one(0.4, 0.9), one(0.4, 0.9)};
    const gpu::vec4 way = anywhere(random, speed, 0);
    gpu::vec4 midway = anywhere(random, 1, 0);
    if (shape == ColliderShape::plane) midway.y = -1 + 0.3f * midway.y;
    const auto at = [&](float fraction) {   // kBodySubstep is where the body is among the particles
      const float t = fraction - (kBodySubstep + 0.5f) / 4;
      return gpu::vec3{midway.x + t * way.x, midway.y + t * way.y, midway.z + t * way.z};
    };
    c.centre_from = at(0);
    c.centre_to = at(1);
    const auto tilted = [&](double size) {
      const reference::Vector n = (reference::Vector::UnitY() + vector(anywhere(random, size, 0))).normalized();
      return gpu::vec3{static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
    };
    c.normal_from = tilted(0.3);
    c.normal_to = tilted(0.3);
    const gpu::vec4 spin = anywhere(random, 1, 0);
    c.spin = {spin.x, spin.y, spin.z};
    const Eigen::Quaternionf q = Eigen::Quaternionf(one(-1, 1), one(-1, 1), one(-1, 1), one(-1, 1)).normalized();
    c.rotation_from = {q.x(), q.y(), q.z(), q.w()};
    if (shape == ColliderShape::capsule) c.half_size.x = c.half_size.z = 0;
    if (tapered) {
      const double large = between(random, 0.4, 0.6), length = k == 2 ? 0.1 : between(random, 0.6, 1.2);
      const double small = between(random, 0.1, 0.25), low = k == 1 ? small : large;
      const gpu::BodySize size = body_size(shape, {low, large + small - low, length, {}});
      c.radius = size.radius;
      c.half_size = size.half_size;
    }
    colliders.push_back(c);
  }
  return colliders;
}

// The twin's radii of a capsule (body_size): one that hides an end in the other is a sphere off its middle.
inline void put_taper(reference::Body& body, const gpu::Collider& c) {
  const double middle = c.half_size.x, half = c.half_size.y, sine = c.half_size.z;
  body.half_size = {0, middle != 0 ? std::abs(middle) : half, 0};
  body.radius = middle > 0 ? 0 : c.radius + half * sine;
  body.taper = middle != 0 ? std::copysign(double(c.radius), -middle) : 2 * half * sine;
}

inline reference::Body body_of(const gpu::Collider& c, ColliderShape shape, double from, double to, double cloth_friction) {
  const auto centre = [&](double t) { return reference::Vector((1 - t) * vector(c.centre_from) + t * vector(c.centre_to)); };
  const auto normal = [&](double t) { return reference::Vector((1 - t) * vector(c.normal_from) + t * vector(c.normal_to)).normalized(); };
  const auto rotation = [&](double t) {
    const reference::Vector spin = vector(c.spin);
    const Eigen::Quaterniond start(c.rotation_from.w, c.rotation_from.x, c.rotation_from.y, c.rotation_from.z);
    if (spin.norm() == 0) return start;
    return Eigen::Quaterniond(Eigen::AngleAxisd(t * spin.norm(), spin.normalized())) * start;
  };
  reference::Body body;
  body.shape = static_cast<reference::Shape>(shape);
  body.centre_before = centre(from);
  body.centre_after = centre(to);
  body.normal_before = normal(from);
  body.normal_after = normal(to);
  body.radius = c.radius;
  body.half_size = vector(c.half_size);
  if (shape == ColliderShape::capsule) put_taper(body, c);
  body.rotation_before = rotation(from);
  body.rotation_after = rotation(to);
  body.turn = (to - from) * vector(c.spin);
  body.friction = std::sqrt(c.friction * cloth_friction);
  return body;
}

// Just missed or just hit, this face or the next: that makes all the difference. A particle whose place leaps when its way is
// stirred by rounding's size is not compared: half the tolerance after a sixteenth of it.
inline bool is_undecided(const reference::Body& body, const reference::Vector& x, const reference::Vector& p, double thickness,
                         double gap) {
  const reference::Vector undisturbed = reference::out_of_body(body, x, p, thickness);
  for (int k = 0; k < 12; ++k) {
    const reference::Vector stir = (k % 2 == 0 ? gap : -gap) / 16 * reference::Vector::Unit(k / 2 % 3);
    const auto there = k < 6 ? reference::out_of_body(body, x + stir, p, thickness) : reference::out_of_body(body, x, p + stir, thickness);
    if ((there - undisturbed).norm() > gap / 2) return true;
  }
  return false;
}

}  // namespace weft
