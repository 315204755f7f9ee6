#include "engine/effects/collide/weave.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace weft {
namespace {

// Of the smallest circle about a triangle: about its longest side, or about all corners where no angle is obtuse.
double circle_about(const gpu::vec4& a, const gpu::vec4& b, const gpu::vec4& c) {
  const auto length = [](const gpu::vec4& p, const gpu::vec4& q) {
    return std::hypot(double(p.x) - q.x, double(p.y) - q.y, double(p.z) - q.z);
  };
  double sides[3] = {length(a, b), length(b, c), length(c, a)};
  std::ranges::sort(sides);
  const auto [k, m, n] = sides;
  if (k * k + m * m <= n * n) return n / 2;
  const double cosine = (k * k + m * m - n * n) / (2 * k * m);
  return n / (2 * std::sqrt(1 - cosine * cosine));   // the law of sines
}

double area_of(const gpu::vec4& a, const gpu::vec4& b, const gpu::vec4& c) {
  const Eigen::Vector3d p(a.x, a.y, a.z), q(b.x, b.y, b.z), r(c.x, c.y, c.z);
  return (q - p).cross(r - p).norm() / 2;
}

}  // namespace

std::vector<Weave> weaves_of(const CookedFabric& fabric) {
  std::vector<Weave> weaves(fabric.cloths.size());
  const auto& x = fabric.positions;
  for (const auto& [a, b, c] : std::span(fabric.triangles).first(fabric.cloth_triangles)) {
    Weave& weave = weaves[body_of(fabric, a)];
    weave.circle = std::max(weave.circle, circle_about(x[a], x[b], x[c]));
    weave.area += area_of(x[a], x[b], x[c]);
    ++weave.triangles;
  }
  for (const gpu::Material& material : fabric.materials)
    if (const auto body = static_cast<std::size_t>(material.body); body < weaves.size())
      weaves[body].thickness = std::min(weaves[body].thickness, double(material.thickness));
  return weaves;
}

bool is_round(const Collider& collider) { return collider.shape == ColliderShape::sphere || collider.shape == ColliderShape::capsule; }

double radius_of(const Collider& collider) {
  return collider.shape == ColliderShape::capsule ? std::min(collider.radius, radius_at_end(collider)) : collider.radius;
}

bool is_thin(const Collider& collider, const Weave& weave, double part) {
  return is_round(collider) && radius_of(collider) < part * std::sqrt(weave.area);
}

}  // namespace weft
