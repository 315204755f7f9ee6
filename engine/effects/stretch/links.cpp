// Links: which pairs of points have a distance constraint, and how stiff each is.
//
// Woven cloth is stiff along its threads (u and v of the UVs) and soft across them. With no lateral contraction the modulus
// in a direction at angle t from the warp is, for an orthotropic sheet (Jones, Mechanics of Composite Materials, eq. 2.97),
//     1 / Y(t) = (cos^4 t + sin^4 t) / Y + cos^2 t sin^2 t / G,
// with Y the stretch and G the shear modulus in N/m. An edge of length L carries the modulus of its direction over the area A of
// the triangles beside it: k = Y(t) A / L^2 (van Gelder 1998); its compliance is 1 / k. Along the threads a family of parallel
// links covers the cloth once; across them two do, the links at t and those at -t, so each has half of the modulus: the term of G
// counts twice. That gives Y along the threads and the shear energy 1/2 G per area, whether a grid's cells are squares or
// oblongs, have one diagonal or a centre.
//
//      d ---- c     An edge (a, c) that is the longest of both its triangles is the diagonal of a quad; the other
//      |    / |     diagonal (b, d) becomes a link as well. The second one only pulls, so that it never resists
//      |  /   |     folding along the first. Without it a sheet shears more easily one way than the other. On
//      a ---- b     grids with centres the quads stand on their corners, and their diagonals are threads.
//
// Limitation: where the UVs say nothing the sheet is equally stiff in all directions, and the two diagonals halve their area.
#include <cmath>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

// Ratio. Longest by more than rounding: an equilateral triangle has no diagonal.
constexpr double kLonger = 1.001;

// Length of a far link, in edges; measured in engine/README.md, "Far links".
constexpr std::uint32_t kFarSteps = 8;

class Weave {
 public:
  Weave(const Mesh& mesh, const Stiffness& stiffness) : mesh_(mesh), stiffness_(stiffness) {}

  Eigen::Vector3d point(std::uint32_t i) const { return vector(mesh_.points[i]); }

  double area(std::uint32_t triangle) const {
    if (triangle == kNone) return 0;
    const auto [a, b, c] = mesh_.triangles[triangle];
    return 0.5 * (point(b) - point(a)).cross(point(c) - point(a)).norm();
  }

  double compliance(const Eigen::Vector3d& direction, const WingedEdge& edge, bool diagonal) const {
    Eigen::Vector3d along = warp(mesh_, edge.triangle[0]);
    if (along.isZero()) along = warp(mesh_, edge.triangle[1]);
    const double covered = (diagonal && along.isZero() ? 0.5 : 1) * (area(edge.triangle[0]) + area(edge.triangle[1]));
    const double squared = direction.squaredNorm();
    const double c2 = along.isZero() ? 1 : std::min(1.0, std::pow(along.dot(direction), 2) / squared);
    const double s2 = 1 - c2;
    // Directions along a thread differ from it by rounding; the soft shear must not leak into them.
    const double mixed = c2 * s2 < 1e-9 ? 0 : c2 * s2;
    const double inverse_modulus = (c2 * c2 + s2 * s2) / stiffness_.stretch + (mixed == 0 ? 0 : 2 * mixed / stiffness_.shear);
    return covered > 0 ? inverse_modulus * squared / covered : 0;
  }

  bool longest_in(std::uint32_t triangle, double length) const {
    const auto [a, b, c] = mesh_.triangles[triangle];
    const double sides[] = {(point(a) - point(b)).norm(), (point(b) - point(c)).norm(), (point(c) - point(a)).norm()};
    int shorter = 0;
    for (const double side : sides) shorter += length > kLonger * side;
    return shorter == 2;
  }

 private:
  const Mesh& mesh_;
  const Stiffness& stiffness_;
};

}  // namespace

Eigen::Vector3d warp(const Mesh& mesh, std::uint32_t triangle) {
  if (triangle == kNone || mesh.render.triangles.size() != mesh.triangles.size()) return Eigen::Vector3d::Zero();
  const auto [a, b, c] = mesh.render.triangles[triangle];
  const Vec2 ua = mesh.render.uvs[a], ub = mesh.render.uvs[b], uc = mesh.render.uvs[c];
  const double u1 = double(ub.x) - ua.x, u2 = double(uc.x) - ua.x, v1 = double(ub.y) - ua.y, v2 = double(uc.y) - ua.y;
  const double determinant = u1 * v2 - u2 * v1;
  const Eigen::Vector3d e1 = vector(mesh.render.positions[b] - mesh.render.positions[a]);
  const Eigen::Vector3d e2 = vector(mesh.render.positions[c] - mesh.render.positions[a]);
  const Eigen::Vector3d along = determinant * (v2 * e1 - v1 * e2);
  const double length = along.norm();
  return length > 1e-30 ? Eigen::Vector3d(along / length) : Eigen::Vector3d::Zero();
}

std::vector<Spring> springs(const Mesh& mesh, const Stiffness& stiffness, bool far) {
  const Weave weave(mesh, stiffness);
  std::vector<Spring> springs, second_diagonals;
  std::vector<bool> is_diagonal;
  springs.reserve(mesh.edges.size() * 2);
  for (const WingedEdge& edge : mesh.edges) {
    const Eigen::Vector3d d = weave.point(edge.b) - weave.point(edge.a);
    const bool inner = edge.triangle[0] != kNone && edge.triangle[1] != kNone;
    const bool diagonal = inner && edge.across[0] != edge.across[1] && weave.longest_in(edge.triangle[0], d.norm()) &&
                          weave.longest_in(edge.triangle[1], d.norm());
    is_diagonal.push_back(diagonal);
    springs.push_back(
        {edge.a, edge.b, d.norm(), weave.compliance(d, edge, diagonal), false, diagonal ? Spring::Kind::diagonal : Spring::Kind::edge});
    if (!diagonal) continue;
    const Eigen::Vector3d other = weave.point(edge.across[1]) - weave.point(edge.across[0]);
    if (other.norm() < 0.1 * d.norm()) continue;   // folded flat on itself at rest: no quad
    second_diagonals.push_back(
        {edge.across[0], edge.across[1], other.norm(), weave.compliance(other, edge, true), true, Spring::Kind::diagonal});
  }
  if (far) add_far_links(mesh, is_diagonal, kFarSteps, springs);
  springs.insert(springs.end(), second_diagonals.begin(), second_diagonals.end());
  return springs;
}

}  // namespace weft::cooking
