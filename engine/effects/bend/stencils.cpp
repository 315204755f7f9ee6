// Bending stencils of the isometric model.
//
// This work is based on: Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006, "A quadratic bending model for inextensible
// surfaces". For the inner edge (x0, x1) with opposite vertices x2, x3 and rest angles' cotangents a0, a1 (triangle 012, at
// x0, x1) and b0, b1 (triangle 013),
//     K = (a1 + b1, a0 + b0, -(a0 + a1), -(b0 + b1)),   E = 1/2 B q |K0 p0 + K1 p1 + K2 p2 + K3 p3|^2,   q = 1 / (A0 + A1),
// B the flexural rigidity in N m. The energy is zero for every flat pose of the stencil.
//
// The paper's q is 3 / (A0 + A1), which converges to 1/2 B (3 k1^2 + 3 k2^2 - 2 k1 k2) per area on a mesh of equilateral
// triangles, k1 and k2 the principal curvatures. Cloth that bends does so as a cylinder (k2 = 0), and there that is three times
// the 1/2 B k1^2 of a plate whose rigidity was measured; a third of it makes every such mesh exact, and squares with one
// diagonal that bend along a side (tests/effects/bend/twin_test.cpp measures it).
//
// Where the mesh is a lattice, and the scene wants a plate, the stencils are others (lattice.cpp).
//
// Limitations: the rest state is flat, even where the mesh is curved (engine/effects/dihedral has curved ones). On meshes that are
// neither a lattice nor equilateral the rigidity of hinges depends on the direction, and a plate of them has a Poisson's ratio of -1/3:
// domes are softer and saddles stiffer.
#include <algorithm>
#include <cmath>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

double cotangent(const Eigen::Vector3d& u, const Eigen::Vector3d& v, bool& clamped) {
  const double sine = u.cross(v).norm(), cosine = u.dot(v);
  if (std::abs(cosine) <= kLargestCotangent * sine) return cosine / sine;
  clamped = true;
  return std::copysign(kLargestCotangent, cosine);
}

}  // namespace

std::vector<gpu::Bend> bend_stencils(const Mesh& mesh, double rigidity, bool as_plate, std::uint32_t& clamped) {
  std::vector<gpu::Bend> bends;
  bends.reserve(mesh.edges.size());
  std::vector<bool> lattice(mesh.triangles.size());
  if (as_plate) lattice = add_lattice_stencils(mesh, rigidity, bends);
  for (const WingedEdge& edge : mesh.edges) {
    if (edge.triangle[0] == kNone || edge.triangle[1] == kNone || edge.across[0] == edge.across[1]) continue;
    if (lattice[edge.triangle[0]] && lattice[edge.triangle[1]]) continue;
    const std::uint32_t particles[] = {edge.a, edge.b, edge.across[0], edge.across[1]};
    Eigen::Vector3d x[4];
    for (int j = 0; j < 4; ++j) x[j] = vector(mesh.points[particles[j]]);
    bool limited = false;
    const double a0 = cotangent(x[1] - x[0], x[2] - x[0], limited), a1 = cotangent(x[0] - x[1], x[2] - x[1], limited);
    const double b0 = cotangent(x[1] - x[0], x[3] - x[0], limited), b1 = cotangent(x[0] - x[1], x[3] - x[1], limited);
    clamped += limited;
    const double area0 = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm(), area1 = 0.5 * (x[1] - x[0]).cross(x[3] - x[0]).norm();
    // Beside a lattice a hinge stands for its other triangle only. (Triangles without an area are of no lattice.)
    double part = 1;
    if (lattice[edge.triangle[0]]) part = area1 / (area0 + area1);
    if (lattice[edge.triangle[1]]) part = area0 / (area0 + area1);
    gpu::Bend bend{};
    const double k[] = {a1 + b1, a0 + b0, -(a0 + a1), -(b0 + b1)};
    for (int j = 0; j < 4; ++j) {
      bend.particle[j] = particles[j];
      bend.k[j] = static_cast<float>(k[j]);
    }
    bend.compliance = static_cast<float>((area0 + area1) / (rigidity * part));
    bends.push_back(bend);
  }
  return bends;
}

}  // namespace weft::cooking
