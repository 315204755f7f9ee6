// This work is based on: Moeller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection"; Ericson 2005, "Real-time
// collision detection", 5.1.5.
#include "engine/solve/pick.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace weft {
namespace {

using Vector = Eigen::Vector3d;
using Corners = std::array<Vector, 3>;

// Relative to a triangle: rays that run along the edge of two must meet one of them.
constexpr double kRounding = 1e-12;

Vector wide(Vec3 v) { return {v.x, v.y, v.z}; }

Corners corners_of(const Triangle& t, std::span<const Vec3> points) { return {wide(points[t[0]]), wide(points[t[1]]), wide(points[t[2]])}; }

std::array<double, 3> cleaned(double u, double v) {
  std::array<double, 3> weights{std::max(0.0, 1 - u - v), std::max(0.0, u), std::max(0.0, v)};
  const double sum = weights[0] + weights[1] + weights[2];
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::array<double, 3> on_edge(int from, int to, double part) {
  std::array<double, 3> weights{};
  weights[static_cast<std::size_t>(from)] = 1 - part;
  weights[static_cast<std::size_t>(to)] = part;
  return weights;
}

// By the regions of the triangle's plane: corners, edges, inside.
std::array<double, 3> nearest_in(const Corners& c, const Vector& p) {
  const Vector ab = c[1] - c[0], ac = c[2] - c[0];
  const double d1 = ab.dot(p - c[0]), d2 = ac.dot(p - c[0]), d3 = ab.dot(p - c[1]), d4 = ac.dot(p - c[1]);
  const double d5 = ab.dot(p - c[2]), d6 = ac.dot(p - c[2]);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return on_edge(0, 1, d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return on_edge(0, 2, d2 / (d2 - d6));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return on_edge(1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  return cleaned(vb / (va + vb + vc), vc / (va + vb + vc));
}

}  // namespace

std::optional<Hit> first_on_ray(std::span<const Triangle> triangles, std::span<const Vec3> points, Vec3 origin, Vec3 direction) {
  const Vector from = wide(origin), along = wide(direction).normalized();
  std::optional<Hit> first;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Corners c = corners_of(triangles[t], points);
    const Vector ab = c[1] - c[0], ac = c[2] - c[0], across = along.cross(ac), off = from - c[0], turned = off.cross(ab);
    const double volume = ab.dot(across);
    if (!(std::abs(volume) > kRounding * ab.norm() * ac.norm())) continue;   // it runs along the plane, or there is none
    const double u = off.dot(across) / volume, v = along.dot(turned) / volume, distance = ac.dot(turned) / volume;
    if (!(u >= -kRounding && v >= -kRounding && u + v <= 1 + kRounding && distance >= 0)) continue;
    if (!first || distance < first->distance) first = Hit{t, cleaned(u, v), distance};
  }
  return first;
}

std::optional<Hit> nearest_to(std::span<const Triangle> triangles, std::span<const Vec3> points, Vec3 point) {
  const Vector p = wide(point);
  std::optional<Hit> nearest;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Corners c = corners_of(triangles[t], points);
    const std::array<double, 3> weights = nearest_in(c, p);
    const double distance = (weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2] - p).norm();
    if (std::isfinite(distance) && (!nearest || distance < nearest->distance)) nearest = Hit{t, weights, distance};
  }
  return nearest;
}

}  // namespace weft
