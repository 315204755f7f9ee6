#include "engine/effects/contact/smooth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

namespace weft::cooking {
namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }
double area(std::span<const Point> polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) twice += cross(polygon[k], polygon[(k + 1) % polygon.size()]);
  return 0.5 * twice;
}

// Counter-clockwise, by Andrew's monotone chain (1979).
std::vector<Point> convex_hull(std::vector<Point> points) {
  std::ranges::sort(points, [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Point> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const Point& p : points) {
      while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

// Sutherland and Hodgman 1974. Most triangles are inside altogether, or beyond one side.
double area_inside(const std::array<Point, 3>& triangle, std::span<const Point> hull) {
  bool all = true;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Point &a = hull[k], along = hull[(k + 1) % hull.size()] - a;
    const int inside = (cross(along, triangle[0] - a) >= 0) + (cross(along, triangle[1] - a) >= 0) + (cross(along, triangle[2] - a) >= 0);
    if (inside == 0) return 0;
    all = all && inside == 3;
  }
  if (all) return area(triangle);
  std::vector<Point> polygon(triangle.begin(), triangle.end());
  std::vector<Point> kept;
  for (std::size_t k = 0; k < hull.size() && !polygon.empty(); ++k) {
    const Point &a = hull[k], along = hull[(k + 1) % hull.size()] - a;
    kept.clear();
    for (std::size_t j = 0; j < polygon.size(); ++j) {
      const Point &p = polygon[j], &q = polygon[(j + 1) % polygon.size()];
      const double at_p = cross(along, p - a), at_q = cross(along, q - a);
      if (at_p >= 0) kept.push_back(p);
      if ((at_p >= 0) != (at_q >= 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
    std::swap(polygon, kept);
  }
  return polygon.empty() ? 0 : area(polygon);
}

// Relative to the piece's size: rounding of rest positions.
constexpr double kFlat = 1e-5;
constexpr double kCovered = 1e-5;
// Of the eigenvalue that is asked for: so that pairs are not only apart but not active either (contact_prepare).
constexpr double kSpare = 1.1;
// No smoothness lasts that asks for more.
constexpr double kMostRatio = 0.8;

class Surroundings {
 public:
  Surroundings(const CookedFabric& fabric, ClusterLists& lists) : fabric_(fabric), lists_(lists), seen_(lists.clusters.size(), kNobody) {
    touching_.resize(fabric.positions.size());
    for (const gpu::uvec4& face : lists.faces)
      for (const std::uint32_t i : {face.x, face.y, face.z})
        if (touching_[i].empty() || touching_[i].back() != face.w) touching_[i].push_back(face.w);   // faces lie by cluster
    for (std::uint32_t k = 0; k + 1 < lists.clusters.size(); ++k) {
      const auto first = static_cast<std::uint32_t>(lists.around.size());
      lists.surroundings.push_back({first, first, first, 0});
      if (!find(k)) lists.around.resize(first);
      else lists.surroundings.back().z = static_cast<std::uint32_t>(lists.around.size());
    }
    for (gpu::uvec4& own : lists.surroundings)
      if (own.z == own.x) own.y = own.x;
  }

 private:
  static constexpr std::uint32_t kNobody = WEFT_NONE;

  Eigen::Vector3d rest(std::uint32_t i) const { return {fabric_.rest[i].x, fabric_.rest[i].y, fabric_.rest[i].z}; }
  std::span<const gpu::uvec4> faces_of(std::uint32_t cluster) const {
    return std::span(lists_.faces).subspan(lists_.clusters[cluster].x, lists_.clusters[cluster + 1].x - lists_.clusters[cluster].x);
  }
  template <class Visit>
  void for_neighbours(std::uint32_t cluster, Visit&& visit) {
    for (const gpu::uvec4& face : faces_of(cluster))
      for (const std::uint32_t i : {face.x, face.y, face.z})
        for (const std::uint32_t other : touching_[i]) visit(other);
  }

  bool find(std::uint32_t cluster) {
    gpu::uvec4& own = lists_.surroundings.back();
    const auto faces = faces_of(cluster);
    if (faces.empty()) return false;
    origin_ = rest(faces[0].x);
    const Eigen::Vector3d side = rest(faces[0].y) - origin_, normal = side.cross(rest(faces[0].z) - origin_);
    if (!(normal.norm() > 0)) return false;
    normal_ = normal.normalized();
    axes_ << side.normalized().transpose(), normal_.cross(side).normalized().transpose();
    add(cluster, cluster);
    for_neighbours(cluster, [&](std::uint32_t other) { add(other, cluster); });
    own.y = static_cast<std::uint32_t>(lists_.around.size());

    std::vector<Point> points;
    for (std::uint32_t k = own.x; k < own.y; ++k)
      for (const gpu::uvec4& face : faces_of(lists_.around[k]))
        for (const std::uint32_t i : {face.x, face.y, face.z}) points.push_back(flat(i));
    const std::vector<Point> hull = convex_hull(std::move(points));
    if (hull.size() < 3) return false;
    size_ = 0;
    for (const Point& p : hull) size_ = std::max(size_, p.norm());
    const double whole = area(hull);
    double covered = 0, thickness = 0;
    least_height_ = INFINITY;
    for (std::uint32_t k = own.x; k < lists_.around.size(); ++k) {
      const std::uint32_t at = lists_.around[k];
      const double share = area_in(at, hull, thickness);
      if (!(share >= 0)) return false;
      if (share <= 0 && k >= own.y) {   // it only touches the piece
        lists_.around[k] = lists_.around.back();
        lists_.around.pop_back();
        --k;
        continue;
      }
      covered += share;
      for_neighbours(at, [&](std::uint32_t other) { add(other, cluster); });
    }
    const double least = kSpare * thickness / least_height_;
    own.w = std::bit_cast<std::uint32_t>(static_cast<float>(least));
    return std::abs(covered - whole) <= kCovered * whole && least < kMostRatio;
  }

  void add(std::uint32_t other, std::uint32_t cluster) {
    if (std::exchange(seen_[other], cluster) != cluster) lists_.around.push_back(other);
  }

  Point flat(std::uint32_t i) const { return axes_ * (rest(i) - origin_); }

  // How much of the hull the cluster's triangles cover; below 0 where one that covers some of it is not flat or turned over.
  double area_in(std::uint32_t cluster, std::span<const Point> hull, double& thickness) {
    double sum = 0;
    for (const gpu::uvec4& face : faces_of(cluster)) {
      const std::array<Point, 3> corners{flat(face.x), flat(face.y), flat(face.z)};
      const double own = area(corners);
      const double inside = own > 0 ? area_inside(corners, hull) : -area_inside({corners[0], corners[2], corners[1]}, hull);
      if (inside <= 0 && own > 0) continue;
      bool is_flat = own > 0;
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (corners[(k + 1) % 3] - corners[k]).norm());
      for (const std::uint32_t i : {face.x, face.y, face.z}) {
        is_flat = is_flat && std::abs(normal_.dot(rest(i) - origin_)) <= kFlat * size_;
        thickness = std::max(thickness, double(fabric_.rest[i].w));
      }
      if (!is_flat) return -1;
      least_height_ = std::min(least_height_, 2 * own / longest);
      sum += inside;
    }
    return sum;
  }

  const CookedFabric& fabric_;
  ClusterLists& lists_;
  std::vector<std::vector<std::uint32_t>> touching_;   // the clusters of each particle
  std::vector<std::uint32_t> seen_;                    // each cluster's last `add`
  Eigen::Vector3d origin_, normal_;
  Eigen::Matrix<double, 2, 3> axes_;
  double size_ = 0, least_height_ = 0;
};

}  // namespace

void find_surroundings(const CookedFabric& fabric, ClusterLists& lists) { Surroundings(fabric, lists); }

}  // namespace weft::cooking
