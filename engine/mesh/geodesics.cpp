#include "engine/mesh/geodesics.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

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
  if (distance != other.distance) return distance > other.distance;
  return std::tie(point, source) > std::tie(other.point, other.source);
}

Waves::Waves(const IntrinsicSurface& surface, std::uint32_t kept, std::vector<double> reach)
    : surface_(surface), kept_(kept), reach_(std::move(reach)) {
  std::uint32_t points = std::max(surface.count, static_cast<std::uint32_t>(surface.points.size()));
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t p : t) points = std::max(points, p + 1);
  reached_.resize(std::size_t(points) * kept);
  count_.resize(points);
  first_.assign(points + 1, 0);
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t p : t) ++first_[p + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  around_.resize(first_.back());
  sides_.reserve(6 * surface.triangles.size());
  for (const IntrinsicSurface::Flat& flat : surface.flat)
    for (std::uint32_t at = 0; at < 3; ++at)
      for (const std::uint32_t side : {1, 2}) {
        const Eigen::Vector2d near = flat.corners[(at + side) % 3] - flat.corners[at], far = flat.corners[(at + 3 - side) % 3] - flat.corners[at];
        const double length = near.norm(), along = length > 0 ? near.dot(far) / length : 0;
        sides_.push_back({length, along, std::sqrt(std::max(0.0, far.squaredNorm() - along * along))});
      }
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) around_[fill[surface.triangles[t][k]]++] = 3 * t + k;
}

void Waves::add(std::uint32_t point) {
  sources_.push_back(point);
  if (Arrived* here = offer(point, static_cast<std::uint32_t>(sources_.size() - 1), 0)) here->along = 1;
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
  Arrived* first = reached_.data() + std::size_t(point) * kept_;
  for (Arrived* known = first; known != first + count_[point]; ++known)
    if (known->source == source) return known;
  return nullptr;
}

// Keeps the nearest sources of a point, sorted; a better distance replaces a worse one. What is kept, for the caller to add how it arrived;
// null if it is not.
Waves::Arrived* Waves::offer(std::uint32_t point, std::uint32_t source, double distance) {
  std::uint32_t& count = count_[point];
  if (!reach_.empty() && distance > reach_[point]) return nullptr;
  Arrived* place = find(point, source);
  if (place != nullptr) {
    if (distance >= place->distance * (1 - 1e-12)) return nullptr;
  } else {
    place = reached_.data() + std::size_t(point) * kept_ + count;
    if (count == kept_ && distance >= (--place)->distance) return nullptr;
    count = std::min(count + 1, kept_);
  }
  for (const Arrived* first = reached_.data() + std::size_t(point) * kept_; place != first && (place - 1)->distance > distance; --place)
    *place = *(place - 1);
  *place = {source, distance, 1, false};
  front_.push({distance, point, source});
  return place;
}

void Waves::spread(const Arrival& from, std::uint32_t corner) {
  const Triangle& triangle = surface_.triangles[corner / 3];
  const IntrinsicSurface::Flat& flat = surface_.flat[corner / 3];
  const std::uint32_t at = corner % 3;
  for (const std::uint32_t side : {1, 2}) {
    const std::uint32_t near = (at + side) % 3, far = (at + 3 - side) % 3;
    const auto& [length, far_along, far_off] = sides_[2 * corner + side - 1];
    const Eigen::Vector2d edge = flat.corners[near] - flat.corners[at];
    if (Arrived* reached = offer(triangle[near], from.source, from.distance + length)) reached->along = along(flat, edge);
    // Two distances locate the source. The end of an edge that propagates later sees both, and so does one that propagates
    // again: in obtuse triangles the wave can arrive at a corner before it arrives at the ends of the edge that it has
    // crossed.
    const Arrived* known = find(triangle[near], from.source);
    if (known == nullptr || !known->spread || length == 0) continue;
    const double squared = from.distance * from.distance, source = (length * length + squared - known->distance * known->distance) / (2 * length);
    const double source_off = std::sqrt(std::max(0.0, squared - source * source)), apart = far_off + source_off;
    if (apart <= 1e-12 * length) continue;
    // Where the straight line to the third corner crosses the edge, if it does.
    const double crossing = source * apart + (far_along - source) * source_off;
    if (crossing < -1e-9 * length * apart || crossing > (1 + 1e-9) * length * apart) continue;
    double distance = std::sqrt((far_along - source) * (far_along - source) + apart * apart);
    // No way along the surface is shorter than the straight line in space.
    if (!surface_.points.empty())
      distance = std::max(distance, (surface_.points[triangle[far]] - surface_.points[sources_[from.source]]).norm());
    if (Arrived* reached = offer(triangle[far], from.source, distance)) {
      const Eigen::Vector2d ahead = edge / length, other = flat.corners[far] - flat.corners[at];
      reached->along = along(flat, (far_along - source) * ahead + apart * (other - other.dot(ahead) * ahead).normalized());
    }
  }
}

}  // namespace weft::cooking
