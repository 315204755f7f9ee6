// Geodesic rest distances to the nearest anchors, by a wavefront on the mesh.
//
// A wave runs out from every anchor over the mesh (in Dijkstra's order), and each vertex keeps the first few anchors whose waves
// arrive. Along edges alone distances would be up to 8 % too long on a grid, and a tether that is too long lets the cloth stretch
// by as much. So a distance also propagates across triangles: with the distances of a and b known, the source is unfolded into the
// triangle's plane and the distance of c measured straight from it, which is exact wherever the cloth unrolls flat.
//
//          c          This work is based on: Novotni and Klein 2002, "Computing geodesic distances on triangular
//         / \         meshes" (circular wavefronts); Kimmel and Sethian 1998.
//        a---b        Limitation: behind a hole or a corner, where the straight line leaves the cloth, distances
//         \ /         follow edges and are a little too long: tethers there are slack, never too tight.
//      (source)
#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

// A wave ends where a vertex has enough nearer anchors, and beside that border distances propagate only along edges. Spare
// places a vertex move the border away from the anchors that are used.
constexpr std::uint32_t kSpare = 1;

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

class Waves {
 public:
  Waves(const Mesh& mesh, std::uint32_t kept) : mesh_(mesh), kept_(kept), reached_(mesh.points.size()) {
    first_.assign(mesh.points.size() + 1, 0);
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t p : t) ++first_[p + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    around_.resize(first_.back());
    std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t p : mesh.triangles[t]) around_[fill[p]++] = t;
  }

  std::vector<std::vector<AnchorDistance>> run(std::span<const std::uint32_t> anchors, std::uint32_t count) {
    anchors_ = anchors;
    for (std::uint32_t k = 0; k < anchors.size(); ++k) offer(anchors[k], k, 0, 0);
    while (!front_.empty()) {
      const Arrival arrival = front_.top();
      front_.pop();
      Known* known = find(arrival.point, arrival.anchor);
      if (known == nullptr || known->distance != arrival.distance) continue;   // improved or crowded out since
      known->spread = true;
      for (std::uint32_t k = first_[arrival.point]; k < first_[arrival.point + 1]; ++k) spread(arrival, around_[k]);
    }
    std::vector<std::vector<AnchorDistance>> nearest(reached_.size());
    for (std::size_t p = 0; p < reached_.size(); ++p)
      for (std::size_t k = 0; k < std::min<std::size_t>(count, reached_[p].size()); ++k)
        nearest[p].push_back({reached_[p][k].anchor, reached_[p][k].distance, reached_[p][k].askew});
    return nearest;
  }

 private:
  struct Known {
    std::uint32_t anchor;
    double distance, askew;
    bool spread;   // it has been propagated at this distance
  };

  struct Arrival {
    double distance;
    std::uint32_t point, anchor;
    bool operator>(const Arrival& other) const {
      return std::tie(distance, point, anchor) > std::tie(other.distance, other.point, other.anchor);
    }
  };

  Eigen::Vector3d step(std::uint32_t a, std::uint32_t b) const { return vector(mesh_.points[b]) - vector(mesh_.points[a]); }
  double between(std::uint32_t a, std::uint32_t b) const { return step(a, b).norm(); }

  double askew(std::uint32_t triangle, const Eigen::Vector3d& way) const {
    const Eigen::Vector3d along = warp(mesh_, triangle);
    if (along.isZero() || way.isZero()) return 0;
    const double c2 = std::min(1.0, std::pow(along.dot(way), 2) / way.squaredNorm());
    return c2 * (1 - c2);
  }

  Known* find(std::uint32_t point, std::uint32_t anchor) {
    for (Known& known : reached_[point])
      if (known.anchor == anchor) return &known;
    return nullptr;
  }

  // Keeps the nearest `kept_` anchors of a point, sorted; a better distance replaces a worse one.
  void offer(std::uint32_t point, std::uint32_t anchor, double distance, double askew) {
    auto& list = reached_[point];
    const auto known = std::find_if(list.begin(), list.end(), [&](const Known& k) { return k.anchor == anchor; });
    if (known != list.end()) {
      if (distance >= known->distance * (1 - 1e-12)) return;
      list.erase(known);
    } else if (list.size() == kept_) {
      if (distance >= list.back().distance) return;
      list.pop_back();
    }
    const auto place = std::find_if(list.begin(), list.end(), [&](const Known& k) { return k.distance > distance; });
    list.insert(place, {anchor, distance, askew, false});
    front_.push({distance, point, anchor});
  }

  void spread(const Arrival& from, std::uint32_t number) {
    const Triangle& triangle = mesh_.triangles[number];
    const auto at = std::find(triangle.begin(), triangle.end(), from.point) - triangle.begin();
    const std::uint32_t others[] = {triangle[(at + 1) % 3], triangle[(at + 2) % 3]};
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t near = others[side], far = others[1 - side];
      const Eigen::Vector3d edge = step(from.point, near);
      offer(near, from.anchor, from.distance + edge.norm(), askew(number, edge));
      // Two distances locate the source. The end of an edge that propagates later sees both, and so does one that propagates
      // again: in obtuse triangles the wave can arrive at a corner before it arrives at the ends of the edge that it has
      // crossed.
      const Known* known = find(near, from.anchor);
      if (known == nullptr || !known->spread) continue;
      const auto line = across_triangle(edge.norm(), between(from.point, far), between(near, far), from.distance, known->distance);
      if (!line) continue;
      const Eigen::Vector3d other = step(from.point, far), across = other - other.dot(edge) / edge.squaredNorm() * edge;
      const Eigen::Vector3d way = line->along * edge.normalized() + line->off * across.normalized();
      // No way along the surface is shorter than the straight line in space.
      offer(far, from.anchor, std::max(std::hypot(line->along, line->off), between(far, anchors_[from.anchor])), askew(number, way));
    }
  }

  const Mesh& mesh_;
  std::uint32_t kept_;
  std::span<const std::uint32_t> anchors_;
  std::vector<std::vector<Known>> reached_;
  std::vector<std::uint32_t> first_, around_;   // triangles around each point
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> front_;
};

}  // namespace

std::vector<std::vector<AnchorDistance>> nearest_anchors(const Mesh& mesh, std::span<const std::uint32_t> anchors, std::uint32_t count) {
  if (count == 0) return std::vector<std::vector<AnchorDistance>>(mesh.points.size());
  return Waves(mesh, count + kSpare).run(anchors, count);
}

}  // namespace weft::cooking
