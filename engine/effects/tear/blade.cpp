// Cuts along a blade. Triangles are not divided: each that the blade meets goes to the side on which most of it lies, and the cloth parts
// between those of different sides. Where the blade ends within the cloth, so does the cut, at a point that stays one.
#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "engine/effects/tear/tear.h"

namespace weft::cooking {
namespace {

using Eigen::Vector3d;

// Whether the blade meets the way from p to q: where it passes the plane it lies between the two rays.
bool meets(const Blade& blade, const Vector3d& normal, const Vector3d& p, const Vector3d& q) {
  const double from = normal.dot(p - blade.origin), to = normal.dot(q - blade.origin);
  if ((from > 0) == (to > 0)) return false;
  const Vector3d at = p + from / (from - to) * (q - p) - blade.origin;
  return normal.dot(blade.a.cross(at)) >= 0 && normal.dot(at.cross(blade.b)) >= 0;
}

// Of a fan that is cut at places on its rim, all pieces but the one with the first triangle.
void add_pieces(std::uint32_t point, const Fan& fan, const std::vector<std::size_t>& cuts, std::vector<Split>& splits) {
  const std::size_t count = fan.corners.size();
  std::vector<std::vector<std::uint32_t>> pieces;
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    auto& piece = pieces.emplace_back();
    const std::size_t end = k + 1 < cuts.size() ? cuts[k + 1] : fan.is_closed() ? cuts[0] + count : count;
    for (std::size_t at = cuts[k]; at < end; ++at) piece.push_back(fan.corners[at % count]);
    std::ranges::sort(piece);
  }
  if (!fan.is_closed()) {
    auto& piece = pieces.emplace_back(fan.corners.begin(), fan.corners.begin() + static_cast<std::ptrdiff_t>(cuts[0]));
    std::ranges::sort(piece);
  }
  std::ranges::sort(pieces);
  for (std::size_t k = 1; k < pieces.size(); ++k) splits.push_back({point, std::move(pieces[k])});
}

}  // namespace

std::vector<Split> cut_by(const Posed& cloth, const Blade& blade) {
  const Mesh& mesh = cloth.mesh;
  const Vector3d normal = blade.a.cross(blade.b);
  std::vector<bool> is_met(mesh.triangles.size());
  for (const WingedEdge& edge : mesh.edges) {
    if (!meets(blade, normal, cloth.places[edge.a], cloth.places[edge.b])) continue;
    for (const std::uint32_t t : edge.triangle)
      if (t != kNone) is_met[t] = true;
  }
  const auto is_in_front = [&](std::uint32_t p) { return normal.dot(cloth.places[p] - blade.origin) > 0; };
  const auto goes_to_front = [&](std::uint32_t t) {
    double sum = 0;
    for (const std::uint32_t p : mesh.triangles[t]) sum += normal.dot(cloth.places[p] - blade.origin);
    return sum > 0;
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> parted;
  std::set<std::uint32_t> points;
  for (const WingedEdge& edge : mesh.edges) {
    const auto [left, right] = edge.triangle;
    if (left == kNone || right == kNone || (!is_met[left] && !is_met[right])) continue;
    // One that is not met is where the edge is; where the blade passes beyond its end, that is nowhere.
    if (!(is_met[left] && is_met[right]) && is_in_front(edge.a) != is_in_front(edge.b)) continue;
    const auto side = [&](std::uint32_t t) { return is_met[t] ? goes_to_front(t) : is_in_front(edge.a); };
    if (side(left) == side(right)) continue;
    parted.insert(std::minmax(edge.a, edge.b));
    points.insert({edge.a, edge.b});
  }
  const Fans fans(mesh);
  std::vector<Split> splits;
  for (const std::uint32_t point : points) {
    if (cloth.is_held(point)) continue;
    for (const Fan& fan : fans.of(point)) {
      std::vector<std::size_t> cuts;
      for (std::size_t k = fan.is_closed() ? 0 : 1; k < fan.corners.size(); ++k)
        if (parted.contains(std::minmax(point, fan.rim[k]))) cuts.push_back(k);
      if (cuts.size() >= (fan.is_closed() ? 2u : 1u)) add_pieces(point, fan, cuts, splits);
    }
  }
  return splits;
}

}  // namespace weft::cooking
