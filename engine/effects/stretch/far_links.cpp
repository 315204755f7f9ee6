// Far links: between points a few edges apart on a straight line of edges.
//
//     a --- . --- . --- . --- e      |a - e| <= the line's length
//
// They speed up convergence: one Jacobi pass carries a pull over one edge, but over several along a far link. They only pull, so
// they never resist folding, and cloth that does not stretch never violates them. A pass corrects a smooth wave of wave number k in
// proportion to the sum of (length k)^2 over a particle's links, divided by their number; on a grid, four links of eight edges
// beside eight of one edge make that 22 times as much, with half as many links again.
//
// A strip stretched evenly must pull as hard as before. A far link of m edges covers m of them and gets k / (2 m^2), k the
// stiffness of an edge: in compliances, alpha_far = 2 m sum(alpha). It takes 1 / (2 m) off the stiffness of each edge under it. Up
// to m links overlap on an edge, so half of its stiffness moves over, and less near the ends of a line.
#include <algorithm>
#include <cmath>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

// Cosine. Lines that turn by more (25 degrees a step) are not followed: their length says little about the distance.
constexpr double kStraight = 0.9;

class Lines {
 public:
  Lines(const Mesh& mesh, const std::vector<bool>& is_diagonal) : mesh_(mesh), edges_at_(mesh.points.size()) {
    for (std::uint32_t e = 0; e < mesh.edges.size(); ++e) {
      if (is_diagonal[e]) continue;
      edges_at_[mesh.edges[e].a].push_back(e);
      edges_at_[mesh.edges[e].b].push_back(e);
    }
  }

  std::uint32_t other_end(std::uint32_t edge, std::uint32_t point) const {
    return mesh_.edges[edge].a == point ? mesh_.edges[edge].b : mesh_.edges[edge].a;
  }

  // The edge that goes on from `edge` beyond `point`, straightest first; kNone at the end of the line.
  std::uint32_t next(std::uint32_t edge, std::uint32_t point) const {
    const Eigen::Vector3d along = direction(other_end(edge, point), point);
    std::uint32_t best = kNone;
    double straightest = kStraight;
    for (const std::uint32_t candidate : edges_at_[point]) {
      const double cosine = along.dot(direction(point, other_end(candidate, point)));
      if (candidate != edge && cosine > straightest) {
        straightest = cosine;
        best = candidate;
      }
    }
    return best;
  }

 private:
  Eigen::Vector3d direction(std::uint32_t from, std::uint32_t to) const {
    return (vector(mesh_.points[to]) - vector(mesh_.points[from])).normalized();
  }

  const Mesh& mesh_;
  std::vector<std::vector<std::uint32_t>> edges_at_;
};

}  // namespace

void add_far_links(const Mesh& mesh, const std::vector<bool>& is_diagonal, std::uint32_t steps, std::vector<Spring>& near) {
  const Lines lines(mesh, is_diagonal);
  std::vector<Spring> far;
  std::vector<std::uint32_t> covering(mesh.edges.size());   // far links over each edge
  for (std::uint32_t e = 0; e < mesh.edges.size(); ++e) {
    if (is_diagonal[e]) continue;
    for (const std::uint32_t start : {mesh.edges[e].a, mesh.edges[e].b}) {
      Spring link{start, lines.other_end(e, start), near[e].rest, near[e].compliance, true, Spring::Kind::far};
      std::vector<std::uint32_t> line{e};
      while (line.size() < steps) {
        const std::uint32_t next = lines.next(line.back(), link.b);
        if (next == kNone) break;
        link.b = lines.other_end(next, link.b);
        link.rest += near[next].rest;
        link.compliance += near[next].compliance;
        line.push_back(next);
      }
      // Each line is found from both of its ends; the lower end makes the link.
      if (line.size() < steps || link.a >= link.b) continue;
      link.compliance *= 2 * steps;
      far.push_back(link);
      for (const std::uint32_t edge : line) ++covering[edge];
    }
  }
  // Where lines join, more may overlap; an edge keeps half of its stiffness all the same.
  for (std::uint32_t e = 0; e < mesh.edges.size(); ++e) near[e].compliance /= 1 - std::min(covering[e], steps) / (2.0 * steps);
  near.insert(near.end(), far.begin(), far.end());
}

}  // namespace weft::cooking
