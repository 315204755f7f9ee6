// Twin of triangle_collide: how far a triangle is from a body, by search where the shader lists features, and what putting it out means.
#pragma once

#include <array>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "shaders/collide/collide.ref.h"

namespace weft::reference {

using Corners = std::array<Vector, 3>;

/// In the body's axes.
struct Gap {
  Vector normal = Vector::UnitX();    // unit, from the body to the triangle
  double size = 0;                    // m, along the normal; negative where they overlap
  Vector weights = Vector::UnitX();   // of the corners, sum 1: the triangle's point that is nearest, or deepest
};

inline Vector point_at(const Corners& x, const Vector& weights) { return weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2]; }

/// How far a body extends in a direction (m).
inline double support_of(const Body& body, const Vector& n) {
  if (body.shape == Shape::sphere) return body.radius * n.norm();
  if (body.shape == Shape::capsule)   // the farther of its ends' spheres
    return std::max(body.radius * n.norm() - body.half_size.y() * n.y(), (body.radius - body.taper) * n.norm() + body.half_size.y() * n.y());
  return n.cwiseAbs().dot(body.half_size);
}

/// The smallest value of a convex function of a number between low and high, and where. Golden section (Kiefer 1953): of two values
/// inside one is used again, so that each step costs one more.
template <class Function>
std::pair<double, double> least_of(const Function& f, double low, double high) {
  constexpr double kKept = 1 / std::numbers::phi;
  double left = high - kKept * (high - low), right = low + kKept * (high - low), at_left = f(left), at_right = f(right);
  for (int k = 0; k < 47; ++k)   // to 1e-10 of where it began
    if (at_left < at_right) {
      high = right, right = left, at_right = at_left;
      at_left = f(left = high - kKept * (high - low));
    } else {
      low = left, left = right, at_left = at_right;
      at_right = f(right = low + kKept * (high - low));
    }
  return {f(0.5 * (low + high)), 0.5 * (low + high)};
}

/// The weights of the point where a convex function is least, by its values at points of the triangle.
template <class Function>
Vector least_on(const Corners& x, const Function& f) {
  const auto at = [&](double u, double v) { return f(point_at(x, {1 - u - v, u, v})); };
  const auto along = [&](double u) { return least_of([&](double v) { return at(u, v); }, 0, 1 - u); };
  const double u = least_of([&](double t) { return along(t).first; }, 0, 1).second, v = along(u).second;
  return {1 - u - v, u, v};
}

/// Round bodies: a sphere's centre or a capsule's axis is a core, and the distance from a core, which is convex, a convex function; with
/// two radii that from the surface is.
inline Gap gap_to_core(const Body& body, const Corners& x) {
  const auto from_core = [&](const Vector& p) { return body.shape == Shape::sphere ? p : Vector(p - nearest_of_core(body, p)); };
  const Vector weights = least_on(x, [&](const Vector& p) { return from_core(p).norm(); });
  const Vector way = from_core(point_at(x, weights));
  if (way.norm() > 1e-7 && body.taper != 0) {   // the length of the way less the radius where it begins
    const Vector nearest = least_on(x, [&](const Vector& p) { return own_distance(body, p); }), point = point_at(x, nearest);
    return {own_gradient(body, point), own_distance(body, point), nearest};
  }
  if (way.norm() > 1e-7) return {way.normalized(), way.norm() - body.radius, weights};
  const Vector across = (x[1] - x[0]).cross(x[2] - x[0]).normalized();   // the core crosses the triangle
  const double above = across.dot(x[0]) - support_of(body, across), below = -across.dot(x[0]) - support_of(body, -across);
  const Vector normal = above >= below ? across : Vector(-across);
  const auto reach = [&](double end) { return end * body.half_size.y() * normal.y() + body.radius - (end > 0 ? body.taper : 0); };
  const Vector deepest(0, body.shape == Shape::sphere ? 0 : std::copysign(body.half_size.y(), reach(1) - reach(-1)), 0);
  return {normal, std::max(above, below), least_on(x, [&](const Vector& p) { return (p - deepest).norm(); })};
}

/// Boxes. The best of all directions that are normal to two edges, the box's or the triangle's: separating axes, or the shortest way out.
inline Gap gap_to_box(const Body& body, const Corners& x) {
  const std::array<Vector, 6> edges = {Vector::UnitX(), Vector::UnitY(), Vector::UnitZ(), x[1] - x[0], x[2] - x[1], x[0] - x[2]};
  Gap best{Vector::UnitX(), -std::numeric_limits<double>::infinity(), Vector::UnitX()};
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const double sign : {-1.0, 1.0}) {
        const Vector across = edges[i].cross(edges[j]);
        if (across.norm() < 1e-9) continue;
        const Vector n = sign * across.normalized();
        const double lowest = std::min({n.dot(x[0]), n.dot(x[1]), n.dot(x[2])}), size = lowest - support_of(body, n);
        // An edge of the triangle counts only where it is what is nearest along n.
        const bool is_nearest = i < 3 || n.dot(x[i - 3]) < lowest + 1e-9;
        const bool is_whole = i < 3 || n.dot(x[(i - 2) % 3]) < lowest + 1e-9;
        if (is_nearest && is_whole && size > best.size) best = {n, size, Vector::UnitX()};
      }
  return best;
}

/// Boxes: moved by the gap's size along its normal the box touches the triangle in the point that is meant.
inline Vector touching(const Body& body, const Corners& x, const Gap& gap) {
  return least_on(x, [&](const Vector& p) {
    const Vector q = p - gap.size * gap.normal;
    return (q - nearest_of_core(body, q)).norm();
  });
}

/// A box's without weights.
inline Gap gap_of(const Body& body, const Corners& x) {
  return body.shape == Shape::box ? gap_to_box(body, x) : gap_to_core(body, x);
}

/// The way out of a body for the triangle that was at `from` when the substep began and is now at `to`, both in the world: the shortest,
/// or back along the normal that it had at first where that leads to the other side.
struct Way {
  Gap gap;
  bool is_back = false;
  double wanted = 0;   // m, of the gap: the separation, or half way to it from where the substep began, if that is outside, or from the surface
};
inline Way way_out(const Body& body, const Corners& from, const Corners& to, double separation) {
  Corners a, b;
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = body.rotation_before.conjugate() * (from[k] - body.centre_before);
    b[k] = body.rotation_after.conjugate() * (to[k] - body.centre_after);
  }
  Gap now = gap_of(body, b), before = gap_of(body, a);
  const bool is_back = now.normal.dot(before.normal) < 0;
  if (body.shape == Shape::box) (is_back ? before : now).weights = touching(body, is_back ? a : b, is_back ? before : now);
  const double wanted = std::min(separation, 0.5 * (std::max(before.size, 0.0) + separation));
  if (!is_back) return {now, false, wanted};
  before.size = before.normal.dot(point_at(b, before.weights)) - support_of(body, before.normal);
  return {before, true, wanted};
}

/// What its triangles together ask of a particle (m): out of bodies, and by friction.
struct Asked {
  Vector out_of = Vector::Zero(), friction = Vector::Zero();
  double longer = 1;   // out_of than the mean
};

/// Planes are left to the vertices. Weights of a mean are whole numbers, the square of the depth in 1024ths of (2 cm)^2,
/// rounded up. The mean is made longer, threefold at most, until what each triangle has of it along its own way out is on average,
/// by weight and depth, as much as the mean depth asks.
inline std::vector<Asked> ask_triangles(std::span<const Body> bodies, std::span<const std::array<std::uint32_t, 3>> triangles,
                                        const Points& x, const Points& p, std::span<const double> inverse_masses, double thickness) {
  std::vector<Asked> sums(p.size());
  std::vector<double> weights(p.size()), depths(p.size());
  for (const auto& t : triangles)
    for (const Body& body : bodies) {
      if (body.shape == Shape::plane) continue;
      const double separation = 0.9 * thickness;
      const bool is_held = std::any_of(t.begin(), t.end(), [&](std::uint32_t i) {
        return inverse_masses[i] == 0 && signed_distance(body, p[i]) < separation;
      });
      const Way way = way_out(body, {x[t[0]], x[t[1]], x[t[2]]}, {p[t[0]], p[t[1]], p[t[2]]}, separation);
      const double missing = way.wanted - way.gap.size;
      if (is_held || missing <= 0) continue;
      const Vector normal = body.rotation_after * way.gap.normal;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t i = t[static_cast<std::size_t>(k)];
        const double depth = std::min(0.1, missing * way.gap.weights[k] / way.gap.weights.squaredNorm());
        if (inverse_masses[i] == 0 || depth <= 0) continue;
        const Vector carried = body.rotation_after * body.rotation_before.conjugate() * (x[i] - body.centre_before);
        const Vector motion = p[i] - body.centre_after - carried;
        const Vector slip = motion - motion.dot(normal) * normal;
        const double weight = std::ceil(1024 * std::min(depth * depth / (0.02 * 0.02), 1.0));
        sums[i].out_of += weight * depth * normal;
        if (slip.norm() > 1e-12) sums[i].friction -= weight * std::min(1.0, body.friction * depth / slip.norm()) * slip;
        weights[i] += weight;
        depths[i] += weight * depth;
      }
    }
  for (std::size_t i = 0; i < p.size(); ++i)
    if (weights[i] > 0) {
      const double longer = std::min(3.0, depths[i] * depths[i] / sums[i].out_of.squaredNorm());
      sums[i] = {longer / weights[i] * sums[i].out_of, sums[i].friction / weights[i], longer};
    }
  return sums;
}

}  // namespace weft::reference
