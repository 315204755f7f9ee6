#include "engine/mesh/geodesics.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

struct Line {
  double along, off;   // ab, and towards c (m)
};

// The line from the source to c, if it crosses ab.
std::optional<Line> across_triangle(double ab, double ac, double bc, double to_a, double to_b) {
  const double cx = (ab * ab + ac * ac - bc * bc) / (2 * ab);
  const double cy = std::sqrt(std::max(0.0, ac * ac - cx * cx));
  const double sx = (ab * ab + to_a * to_a - to_b * to_b) / (2 * ab);
  const double sy = std::sqrt(std::max(0.0, to_a * to_a - sx * sx));
  if (cy + sy <= 1e-12 * ab) return std::nullopt;
  const double crossing = sx + (cx - sx) * sy / (cy + sy);
  if (crossing < -1e-9 * ab || crossing > (1 + 1e-9) * ab) return std::nullopt;
  return Line{cx - sx, cy + sy};
}

// cos^2 of the angle to the warp.
double along(const IntrinsicSurface::Flat& triangle, const Eigen::Vector2d& way) {
  if (triangle.warp.isZero() || way.isZero()) return 1;
  return std::min(1.0, std::pow(triangle.warp.dot(way), 2) / way.squaredNorm());
}

}  // namespace

std::array<Eigen::Vector2d, 3> flat_triangle(double ab, double ac, double bc) {
  const double x = ab > 0 ? (ab * ab + ac * ac - bc * bc) / (2 * ab) : 0;
  return {Eigen::Vector2d(0, 0), Eigen::Vector2d(ab, 0), Eigen::Vector2d(x, std::sqrt(std::max(0.0, ac * ac - x * x)))};
}

IntrinsicSurface surface_of(const Mesh& mesh) {
  IntrinsicSurface surface;
  surface.points.reserve(mesh.points.size());
  for (const Vec3 point : mesh.points) surface.points.push_back(vector(point));
  surface.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const Eigen::Vector3d ab = surface.points[b] - surface.points[a], ac = surface.points[c] - surface.points[a];
    const auto corners = flat_triangle(ab.norm(), ac.norm(), (ac - ab).norm());
    // The warp in the triangle's own axes: along ab, and across it.
    const Eigen::Vector3d along = warp(mesh, t), x = ab.normalized(), y = (ac - ac.dot(x) * x).normalized();
    surface.flat.push_back({corners, {along.dot(x), along.dot(y)}});
  }
  return surface;
}

bool Waves::Arrival::operator>(const Arrival& other) const {
  return std::tie(distance, point, source) > std::tie(other.distance, other.point, other.source);
}

Waves::Waves(const IntrinsicSurface& surface, std::uint32_t kept) : surface_(surface), kept_(kept) {
  std::uint32_t points = static_cast<std::uint32_t>(surface.points.size());
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t p : t) points = std::max(points, p + 1);
  reached_.resize(points);
  first_.assign(points + 1, 0);
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t p : t) ++first_[p + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  around_.resize(first_.back());
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    for (const std::uint32_t p : surface.triangles[t]) around_[fill[p]++] = t;
}

void Waves::add(std::uint32_t point) {
  sources_.push_back(point);
  offer(point, static_cast<std::uint32_t>(sources_.size() - 1), 0, 1);
}

void Waves::run() {
  while (!front_.empty()) {
    const Arrival arrival = front_.top();
    front_.pop();
    Arrived* known = find(arrival.point, arrival.source);
    if (known == nullptr || known->distance != arrival.distance) continue;   // improved or crowded out since
    known->spread = true;
    for (std::uint32_t k = first_[arrival.point]; k < first_[arrival.point + 1]; ++k) spread(arrival, around_[k]);
  }
}

Waves::Arrived* Waves::find(std::uint32_t point, std::uint32_t source) {
  for (Arrived& known : reached_[point])
    if (known.source == source) return &known;
  return nullptr;
}

// Keeps the nearest sources of a point, sorted; a better distance replaces a worse one.
void Waves::offer(std::uint32_t point, std::uint32_t source, double distance, double along) {
  auto& list = reached_[point];
  const auto known = std::find_if(list.begin(), list.end(), [&](const Arrived& k) { return k.source == source; });
  if (known != list.end()) {
    if (distance >= known->distance * (1 - 1e-12)) return;
    list.erase(known);
  } else if (list.size() == kept_) {
    if (distance >= list.back().distance) return;
    list.pop_back();
  }
  const auto place = std::find_if(list.begin(), list.end(), [&](const Arrived& k) { return k.distance > distance; });
  list.insert(place, {source, distance, along, false});
  front_.push({distance, point, source});
}

void Waves::spread(const Arrival& from, std::uint32_t number) {
  const Triangle& triangle = surface_.triangles[number];
  const IntrinsicSurface::Flat& flat = surface_.flat[number];
  const auto at = static_cast<std::size_t>(std::find(triangle.begin(), triangle.end(), from.point) - triangle.begin());
  const std::size_t others[] = {(at + 1) % 3, (at + 2) % 3};
  for (int side = 0; side < 2; ++side) {
    const std::size_t near = others[side], far = others[1 - side];
    const Eigen::Vector2d edge = flat.corners[near] - flat.corners[at];
    offer(triangle[near], from.source, from.distance + edge.norm(), along(flat, edge));
    // Two distances locate the source. The end of an edge that propagates later sees both, and so does one that propagates
    // again: in obtuse triangles the wave can arrive at a corner before it arrives at the ends of the edge that it has
    // crossed.
    const Arrived* known = find(triangle[near], from.source);
    if (known == nullptr || !known->spread) continue;
    const Eigen::Vector2d other = flat.corners[far] - flat.corners[at];
    const auto line = across_triangle(edge.norm(), other.norm(), (other - edge).norm(), from.distance, known->distance);
    if (!line) continue;
    const Eigen::Vector2d across = other - other.dot(edge) / edge.squaredNorm() * edge;
    const Eigen::Vector2d way = line->along * edge.normalized() + line->off * across.normalized();
    double distance = std::hypot(line->along, line->off);
    // No way along the surface is shorter than the straight line in space.
    if (!surface_.points.empty())
      distance = std::max(distance, (surface_.points[triangle[far]] - surface_.points[sources_[from.source]]).norm());
    offer(triangle[far], from.source, distance, along(flat, way));
  }
}

}  // namespace weft::cooking
