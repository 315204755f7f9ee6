// Which links are strands: lines along the warp in the first round, along the weft in the second.
//
// A line begins anywhere and goes on, both ways, by the straightest link that is left and leads to a point that no line of the round has
// yet. Cloth is woven of such lines; on other meshes they are shorter and less straight, which costs nothing but convergence. Long lines
// are cut into even pieces, so that there are many to be solved at once. The links between the pieces and those askew to both rounds
// are left to Jacobi.
//
// Strains are largest at these seams. Two ways out were measured and lost: pieces cut elsewhere in every second substep make cloth at rest
// shiver, at five centimetres a second; and walked back over in the same substep cloth is stiffer than contacts can follow (a sheet driven
// into a free one at 8 m/s waited for it by 1.8 mm instead of less than 1).
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/cook/parts.h"
#include "engine/effects/strand/strand.h"

namespace weft::cooking {
namespace {

// Cosine. Lines turn by less, 60 degrees, from link to link.
constexpr double kStraight = 0.5;

class Lines {
 public:
  Lines(const Mesh& mesh, const std::vector<Spring>& springs) : mesh_(mesh), springs_(springs), at_(mesh.points.size()), used_(springs.size()) {
    for (std::uint32_t k = 0; k < springs.size(); ++k)
      if (!springs[k].only_pulls)
        for (const std::uint32_t p : {springs[k].a, springs[k].b}) at_[p].push_back(k);
    // The warp at each point: of its triangles, the first that has one.
    warps_.assign(mesh.points.size(), Eigen::Vector3d::Zero());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t p : mesh.triangles[t])
        if (warps_[p].isZero()) warps_[p] = warp(mesh, t);
  }

  std::vector<Strand> round(bool along_warp) {
    std::vector<Strand> strands;
    std::vector<bool> taken(mesh_.points.size());
    for (std::uint32_t start = 0; start < mesh_.points.size(); ++start) {
      if (taken[start]) continue;
      taken[start] = true;
      Strand line{start};
      for (const bool back : {false, true}) {
        while (extend(line, along_warp, taken)) {}
        if (!back) std::reverse(line.begin(), line.end());
      }
      // Even pieces.
      const std::size_t pieces = (line.size() + kStrandLinks) / (kStrandLinks + 1);
      for (std::size_t k = 0; k < pieces; ++k)
        strands.emplace_back(line.begin() + at(line.size() * k / pieces), line.begin() + at(line.size() * (k + 1) / pieces));
    }
    for (const Strand& strand : strands)
      for (std::size_t k = 1; k < strand.size(); ++k) used_[spring_between(strand[k - 1], strand[k])] = true;
    return strands;
  }

 private:
  static std::ptrdiff_t at(std::size_t k) { return static_cast<std::ptrdiff_t>(k); }

  Eigen::Vector3d direction(std::uint32_t from, std::uint32_t to) const {
    return (vector(mesh_.points[to]) - vector(mesh_.points[from])).normalized();
  }
  std::uint32_t other_end(std::uint32_t spring, std::uint32_t point) const {
    return springs_[spring].a == point ? springs_[spring].b : springs_[spring].a;
  }
  std::uint32_t spring_between(std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t k : at_[a])
      if (other_end(k, a) == b) return k;
    return kNone;
  }

  // Adds one more point at the line's end, if it goes on.
  bool extend(Strand& line, bool along_warp, std::vector<bool>& taken) const {
    const std::uint32_t end = line.back();
    std::uint32_t best = kNone;
    double straightest = line.size() > 1 ? kStraight : 0;
    for (const std::uint32_t k : at_[end]) {
      const std::uint32_t other = other_end(k, end);
      if (used_[k] || taken[other]) continue;
      const Eigen::Vector3d way = direction(end, other);
      const double along = std::abs(warps_[end].dot(way));
      const double straight = line.size() > 1 ? direction(line[line.size() - 2], end).dot(way)
                                              : along_warp ? along + 1e-9 : std::sqrt(std::max(0.0, 1 - along * along)) + 1e-9;
      if (straight > straightest + 1e-9) straightest = straight, best = other;
    }
    if (best == kNone) return false;
    taken[best] = true;
    line.push_back(best);
    return true;
  }

  const Mesh& mesh_;
  const std::vector<Spring>& springs_;
  std::vector<std::vector<std::uint32_t>> at_;   // springs at each point
  std::vector<bool> used_;                       // springs that are in a strand
  std::vector<Eigen::Vector3d> warps_;
};

}  // namespace

std::array<std::vector<Strand>, kStrandRounds> choose_strands(const Mesh& mesh, const std::vector<Spring>& springs) {
  Lines lines(mesh, springs);
  auto first = lines.round(true);
  return {std::move(first), lines.round(false)};
}

}  // namespace weft::cooking
