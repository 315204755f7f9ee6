// Dihedral elements: bending about the mesh's own dihedral angles, for cloth with folds and curves at rest.
//
// This work is based on: Grinspun, Hirani, Desbrun, Schroeder 2003, "Discrete shells"; Bridson, Marino, Fedkiw 2003, "Simulation of
// clothing with folds and wrinkles". The energy of an inner edge (x0, x1), the hinge, with the areas A0, A1 of its triangles is
//     E = 1/2 B |x1 - x0|^2 / (A0 + A1) (phi - phi_rest)^2,
// B the flexural rigidity in N m. For small angles it is the energy of the isometric model
// (engine/effects/bend/stencils.cpp), whose vector l then has the length |x1 - x0| phi, so that the same B describes the same plate in
// both.
//
//        2      phi is the angle between the triangles' normals, n0 = (x1 - x0) x (x2 - x0) and n1 = (x3 - x0) x (x1 - x0),
//       / \     about the edge: 0 where they are flat, near +-pi where they are closed.
//      0---1
//       \ /     All edges of such a cloth are treated so, the flat ones too: a threshold would be seen in the cloth.
//        3
//
// Limitations: an angle is known up to whole turns, so an edge that is bent more than half a turn from rest is driven on
// round, not back. The rigidity depends on the direction as that of the isometric model does.
#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/cook/parts.h"
#include "engine/effects/dihedral/dihedral.h"

namespace weft::cooking {
namespace {

// A larger compliance (rad^2/J) has no visible effect, and an infinite one leads to NaN (engine/cook/parts.h, kSoftest).
constexpr double kSoftestHinge = 1e12;

// The limit over the larger cotangent at the edge of the triangle (x0, x1, across), at most 1: slivers are softened as in the isometric
// model, where the opposite vertex would move rigidly with the edge.
double within_limit(const Eigen::Vector3d& edge, const Eigen::Vector3d& from_0, double twice_area) {
  const double largest = std::max(std::abs(edge.dot(from_0)), std::abs(edge.dot(edge - from_0)));
  return std::min(1.0, kLargestCotangent * twice_area / largest);
}

}  // namespace

std::uint32_t add_hinges(const Mesh& mesh, std::span<const std::uint32_t> particle_of, double rigidity, const std::vector<float>& factors,
                         CookedFabric& fabric) {
  std::uint32_t softened = 0;
  for (const WingedEdge& winged : mesh.edges) {
    if (winged.triangle[0] == kNone || winged.triangle[1] == kNone || winged.across[0] == winged.across[1]) continue;
    const std::uint32_t points[] = {winged.a, winged.b, winged.across[0], winged.across[1]};
    const Eigen::Vector3d x0 = vector(mesh.points[points[0]]), edge = vector(mesh.points[points[1]]) - x0;
    const Eigen::Vector3d d2 = vector(mesh.points[points[2]]) - x0, d3 = vector(mesh.points[points[3]]) - x0;
    const Eigen::Vector3d n0 = edge.cross(d2), n1 = d3.cross(edge);
    const double rest = std::atan2(edge.normalized().dot(n0.cross(n1)), n0.dot(n1));
    const double limit = std::min(within_limit(edge, d2, n0.norm()), within_limit(edge, d3, n1.norm()));
    softened += limit < 1;
    const double here = factor(factors, winged.a, winged.b) * rigidity;
    const double compliance = 0.5 * (n0.norm() + n1.norm()) / (here * edge.squaredNorm() * limit * limit);
    gpu::Hinge hinge{};
    for (int j = 0; j < 4; ++j) hinge.particle[j] = particle_of[points[j]];
    hinge.rest_cosine = static_cast<float>(std::cos(rest));
    hinge.rest_sine = static_cast<float>(std::sin(rest));
    hinge.compliance = static_cast<float>(std::min(compliance, kSoftestHinge));
    fabric.hinges.push_back(hinge);
  }
  return softened;
}

// A particle's mass is split among its elements as among its links; with plain averaging only the gather divides by the counts.
void lay_out_hinges(Averaging averaging, bool may_pin, CookedFabric& fabric) {
  const bool split = averaging == Averaging::mass_split;
  std::vector<std::uint32_t> uses(fabric.positions.size());
  for (const gpu::Hinge& hinge : fabric.hinges)
    for (const std::uint32_t p : hinge.particle) ++uses[p];
  std::vector<std::vector<gpu::uvec2>> shares(fabric.positions.size());
  for (std::uint32_t e = 0; e < fabric.hinges.size(); ++e)
    for (std::uint32_t j = 0; j < 4; ++j) {
      const std::uint32_t p = fabric.hinges[e].particle[j];
      const float w = fabric.positions[p].w;
      fabric.hinges[e].weight[j] = static_cast<float>(split ? uses[p] : 1) * w;
      if (w > 0 || may_pin) shares[p].push_back({4 * e + j, std::bit_cast<std::uint32_t>(w / static_cast<float>(split ? 1 : uses[p]))});
    }
  fabric.own.of<DihedralLists>().uses = pack_rows(shares, Padding::repeated);
}

}  // namespace weft::cooking
