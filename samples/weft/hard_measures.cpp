// The figures, each with the closed form that it is held against.
#include "samples/weft/hard_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "engine/reference/intersections.h"
#include "samples/weft/drape_measure.h"

namespace weft::command::figure {

namespace {

using Eigen::Vector3d;

Vector3d vector(const gpu::vec4& p) { return {p.x, p.y, p.z}; }
Vector3d vector(Vec3 p) { return {p.x, p.y, p.z}; }
std::uint32_t particles(const Glance& at) { return cloth_particles(at.fabric); }
double mass(const Glance& at, std::size_t i) { return at.start[i].w > 0 ? 1 / double(at.start[i].w) : 0; }

Vector3d centre_of_mass(const Glance& at, std::span<const gpu::vec4> positions, std::uint32_t first, std::uint32_t count) {
  Vector3d sum = Vector3d::Zero();
  double masses = 0;
  for (std::uint32_t i = first; i < first + count; ++i) {
    sum += mass(at, i) * vector(positions[i]);
    masses += mass(at, i);
  }
  return sum / masses;
}
Vector3d centre_of_mass(const Glance& at, std::span<const gpu::vec4> positions) { return centre_of_mass(at, positions, 0, particles(at)); }

Vector3d momentum(const Glance& at, std::span<const gpu::vec4> velocities) {
  Vector3d sum = Vector3d::Zero();
  for (std::uint32_t i = 0; i < particles(at); ++i) sum += mass(at, i) * vector(velocities[i]);
  return sum;
}

double substeps(const Glance& at) { return std::round(at.time / at.fabric.h); }

// How far the lowest particle is below the anchors.
double depth(const Glance& at, std::span<const gpu::vec4> positions) {
  double lowest = INFINITY, top = -INFINITY;
  for (std::uint32_t i = 0; i < particles(at); ++i) {
    lowest = std::min(lowest, double(positions[i].y));
    if (at.start[i].w == 0) top = std::max(top, double(positions[i].y));
  }
  return top - lowest;
}

}  // namespace

double not_finite(const Glance& at) {
  double lost = 0;
  for (const gpu::vec4& p : at.positions) lost += !std::isfinite(p.x + p.y + p.z);
  return lost + at.counts.non_finite;
}

double crossings(const Glance& at) {
  std::vector<Vec3> places;
  for (const gpu::vec4& p : at.positions) places.push_back({p.x, p.y, p.z});
  return static_cast<double>(count_crossings(places, at.fabric.triangles, at.fabric.cloth_triangles));
}

double contacts_overflowed(const Glance& at) { return at.counts.contacts_overflowed; }

double pins_off(const Glance& at) {
  double farthest = 0;
  const std::vector<Vec3> targets = anchor_targets(at.scene, at.fabric, at.time);
  for (std::size_t k = 0; k < targets.size(); ++k)
    farthest = std::max(farthest, (vector(at.positions[at.fabric.anchors[k].particle]) - vector(targets[k])).norm());
  return farthest;
}

double largest_strain(const Glance& at) { return 100 * measure_strain(at.fabric, at.positions).max; }

double mean_strain(const Glance& at) { return 100 * measure_strain(at.fabric, at.positions).mean; }

double top_speed(const Glance& at) {
  double fastest = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i)
    if (at.start[i].w > 0) fastest = std::max(fastest, vector(at.velocities[i]).norm());
  return fastest;
}

double centre_moved(const Glance& at) { return (centre_of_mass(at, at.positions) - centre_of_mass(at, at.start)).norm(); }

double momentum_change(const Glance& at) {
  double most = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i) most += mass(at, i) * vector(at.start_velocities[i]).norm();
  return (momentum(at, at.velocities) - momentum(at, at.start_velocities)).norm() / most;
}

double spin(const Glance& at) {
  const Vector3d centre = centre_of_mass(at, at.positions);
  Vector3d sum = Vector3d::Zero();
  double inertia = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i) {
    const Vector3d r = vector(at.positions[i]) - centre, v = vector(at.velocities[i]);
    sum += mass(at, i) * r.cross(v);
    inertia += mass(at, i) * r.squaredNorm();
  }
  return sum.norm() / inertia;
}

// Symplectic Euler: after n steps of h from rest h^2 g n (n + 1) / 2.
double fall_error(const Glance& at) {
  const double n = substeps(at), h = at.fabric.h;
  const Vector3d gravity = vector(at.scene.gravity);
  const double fallen = (centre_of_mass(at, at.positions) - centre_of_mass(at, at.start)).dot(gravity.normalized());
  return std::abs(fallen / (h * h * gravity.norm() * n * (n + 1) / 2) - 1);
}

double sideways(const Glance& at) {
  const Vector3d down = vector(at.scene.gravity).normalized(), moved = centre_of_mass(at, at.positions) - centre_of_mass(at, at.start);
  return (moved - moved.dot(down) * down).norm();
}

double bend_angle(const Glance& at) {
  double most = 0;
  // Of cloth that bends about flat, over the edges of its triangles.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vector3d> normals;
  for (std::uint32_t t = 0; t < at.fabric.cloth_triangles && !at.fabric.bends.empty(); ++t) {
    const Triangle& corner = at.fabric.triangles[t];
    const Vector3d a = vector(at.positions[corner[0]]);
    const Vector3d normal = (vector(at.positions[corner[1]]) - a).cross(vector(at.positions[corner[2]]) - a);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [edge, first] = normals.try_emplace(std::minmax({corner[c], corner[(c + 1) % 3]}), normal);
      if (!first) most = std::max(most, std::atan2(edge->second.cross(normal).norm(), edge->second.dot(normal)));
    }
  }
  for (const gpu::Hinge& hinge : at.fabric.hinges) {
    const Vector3d a = vector(at.positions[hinge.particle[0]]), b = vector(at.positions[hinge.particle[1]]);
    const Vector3d c = vector(at.positions[hinge.particle[2]]), d = vector(at.positions[hinge.particle[3]]);
    const Vector3d edge = b - a, first = edge.cross(c - a), second = (d - a).cross(edge);
    const double angle = std::atan2(edge.normalized().dot(first.cross(second)), first.dot(second));
    most = std::max(most, std::abs(std::remainder(angle - std::atan2(hinge.rest_sine, hinge.rest_cosine), 2 * std::numbers::pi)));
  }
  return most;
}

double deepest(const Glance& at) {
  double depth = 0;
  for (const Collider& collider : at.scene.colliders)
    for (const ClothRange& cloth : at.fabric.cloths) {
      const double thickness = at.scene.cloths[static_cast<std::size_t>(&cloth - at.fabric.cloths.data())].fabric.thickness;
      for (std::uint32_t i = cloth.first_particle; i < cloth.first_particle + cloth.particles; ++i) {
        if (at.start[i].w == 0) continue;   // pins stay where they are put
        const Vector3d from = vector(at.positions[i]) - vector(collider.centre);
        if (collider.shape == ColliderShape::plane) depth = std::max(depth, thickness - from.dot(vector(collider.normal)));
        if (collider.shape == ColliderShape::sphere) depth = std::max(depth, thickness + collider.radius - from.norm());
      }
    }
  return depth;
}

double out_of_order(const Glance& at) {
  double wrong = 0, below = -INFINITY;
  for (const ClothRange& cloth : at.fabric.cloths) {
    const double height = centre_of_mass(at, at.positions, cloth.first_particle, cloth.particles).y();
    wrong += !(height > below);
    below = height;
  }
  return wrong;
}

double unaccounted(const Glance& at) { return std::max(0.0, std::abs(at.asked - at.clamped - at.time) - at.fabric.h); }

// Friction combines by the geometric mean. What slides does so with g (sin a - mu cos a).
double slide_error(const Glance& at) {
  const Collider& plane = at.scene.colliders.front();
  const double mu = std::sqrt(plane.friction * at.scene.cloths.front().fabric.friction);
  const Vector3d gravity = vector(at.scene.gravity), normal = vector(plane.normal);
  const double across = -gravity.dot(normal), along = (gravity + across * normal).norm();
  const double slid = (centre_of_mass(at, at.positions) - centre_of_mass(at, at.start)).norm() / (0.5 * along * at.time * at.time);
  return std::abs(slid - std::max(0.0, 1 - mu * across / along));
}

// Of an even weight per area rho g and a modulus Y per width: rho g L^2 / (2 Y).
double strip_error(const Glance& at) {
  const Fabric& fabric = at.scene.cloths.front().fabric;
  const double longer = depth(at, at.positions) - depth(at, at.start), length = depth(at, at.start);
  return std::abs(longer / (fabric.area_density * -at.scene.gravity.y * length * length / (2 * fabric.stretch)) - 1);
}

// A strip along x between two ends: y = a cosh(x / a), with L = 2 a sinh(d / 2 a).
double catenary_error(const Glance& at) {
  double left = INFINITY, right = -INFINITY, height = 0, length = at.scene.cloths.front().grid->size.x;
  for (std::uint32_t i = 0; i < particles(at); ++i) {
    if (at.start[i].w > 0) continue;
    left = std::min(left, double(at.positions[i].x));
    right = std::max(right, double(at.positions[i].x));
    height = at.positions[i].y;
  }
  const double span = right - left, middle = (left + right) / 2;
  double low = span / 100, high = span * 100;   // of a: the curve gets shorter as a grows
  for (int k = 0; k < 100; ++k) {
    const double a = std::sqrt(low * high);
    (2 * a * std::sinh(span / (2 * a)) > length ? low : high) = a;
  }
  double squares = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i) {
    const double y = height + low * (std::cosh((at.positions[i].x - middle) / low) - std::cosh(span / (2 * low)));
    squares += std::pow(at.positions[i].y - y, 2);
  }
  return std::sqrt(squares / particles(at)) / length;
}

// Euler and Bernoulli: rho g L^4 / (8 B). The strip lies along x and is clamped over its first cell.
double cantilever_error(const Glance& at) {
  const Cloth& cloth = at.scene.cloths.front();
  double clamp = -INFINITY, tip = -INFINITY, sinks = 0, ends = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i) {
    if (at.start[i].w == 0) clamp = std::max(clamp, double(at.start[i].x));
    tip = std::max(tip, double(at.start[i].x));
  }
  for (std::uint32_t i = 0; i < particles(at); ++i)
    if (at.start[i].x > tip - 1e-6) sinks += at.start[i].y - at.positions[i].y, ++ends;
  const double length = tip - clamp;
  return std::abs(sinks / ends / (cloth.fabric.area_density * -at.scene.gravity.y * std::pow(length, 4) / (8 * cloth.fabric.bend)) - 1);
}

// All that moves hangs at one distance from a line of anchors along x and swings across it. The period follows from its phase, with
// the small-angle series for its amplitude; it starts at rest, at a small angle.
double pendulum_error(const Glance& at) {
  double pivot = 0;
  std::size_t swings = 0;
  for (std::uint32_t i = 0; i < particles(at); ++i)
    if (at.start[i].w == 0) pivot = at.start[i].y;
    else swings = i;
  const double z = at.positions[swings].z, v = at.velocities[swings].z, length = std::hypot(at.start[swings].z, pivot - at.start[swings].y);
  const double angle = std::asin(at.start[swings].z / length), omega = std::sqrt(-at.scene.gravity.y / length) / (1 + angle * angle / 16);
  const double expected = omega * at.time, turn = 2 * std::numbers::pi;
  const double off = std::remainder(std::atan2(-v / omega, z) - expected, turn);
  return std::abs(off) / expected;
}

double drape_order(const Glance& at) {
  double worst = 0, before = 0;
  for (const ClothRange& cloth : at.fabric.cloths) {
    const double coefficient = drape_coefficient(at.fabric, cloth, at.start, at.positions).value_or(0);
    worst = std::max(worst, before / coefficient);
    before = coefficient;
  }
  return worst;
}

}  // namespace weft::command::figure
