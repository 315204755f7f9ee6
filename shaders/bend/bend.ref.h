// Twin of bend, bend_lambda and bend_gather: the quadratic bending energy of Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006,
// "A quadratic bending model for inextensible surfaces".
//
//        x2          The inner edge (x0, x1) with its opposite vertices. With cIJ the cotangent of the angle between
//       /  \         edges I and J at rest (the paper's e0 = x0 x1, e1 = x0 x2, e2 = x0 x3, e3 = x1 x2, e4 = x1 x3),
//     x0----x1           K = (c03 + c04, c01 + c02, -c01 - c03, -c02 - c04),
//       \  /             E = B/2 q |K0 p0 + K1 p1 + K2 p2 + K3 p3|^2.
//        x3          As an XPBD constraint: l = sum K_j p_j = 0, compliance 1 / (B q).
//
// The paper has q = 3 / (A0 + A1). A third of that is used, so that a mesh of equilateral triangles, rolled into a cylinder in
// any direction, has a plate's energy 1/2 B k^2 per area (engine/effects/bend/stencils.cpp says where the 3 comes from).
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

using Stencil = std::array<Vector, 4>;

struct BendStencil {
  Eigen::Vector4d k;
  double q;   // 1/m^2: 1 / (A0 + A1)
};

/// Of the angle between two edges that leave one vertex.
inline double cotangent(const Vector& u, const Vector& v) { return u.dot(v) / u.cross(v).norm(); }

inline BendStencil bend_stencil(const Stencil& x) {
  const double c01 = cotangent(x[1] - x[0], x[2] - x[0]), c02 = cotangent(x[1] - x[0], x[3] - x[0]);
  const double c03 = cotangent(x[0] - x[1], x[2] - x[1]), c04 = cotangent(x[0] - x[1], x[3] - x[1]);
  const double area0 = (x[1] - x[0]).cross(x[2] - x[0]).norm() / 2, area1 = (x[1] - x[0]).cross(x[3] - x[0]).norm() / 2;
  return {{c03 + c04, c01 + c02, -c01 - c03, -c02 - c04}, 1 / (area0 + area1)};
}

inline Vector bend_value(const Eigen::Vector4d& k, const Stencil& p) { return k[0] * p[0] + k[1] * p[1] + k[2] * p[2] + k[3] * p[3]; }

/// J, for a rigidity in N m.
inline double bend_energy(const BendStencil& stencil, double rigidity, const Stencil& p) {
  return rigidity / 2 * stencil.q * bend_value(stencil.k, p).squaredNorm();
}
/// N: its gradient with respect to each of the four.
inline Stencil bend_energy_gradient(const BendStencil& stencil, double rigidity, const Stencil& p) {
  const Vector force = rigidity * stencil.q * bend_value(stencil.k, p);
  return {stencil.k[0] * force, stencil.k[1] * force, stencil.k[2] * force, stencil.k[3] * force};
}

struct Bend {
  std::array<std::uint32_t, 4> particle;
  Eigen::Vector4d k;
  double compliance;   // 1 / (B q)
};

/// A line of a lattice has three.
inline std::size_t particles_of(const Bend& bend) { return bend.k[3] == 0 ? 3 : 4; }

/// The one visit of a substep: a stabilised explicit step of the bending force,
///     p - h^2 W K^T C^-1 K p,   with C no less than h^2 sum n_j w_j K_j^2 / 1.25, n_j stencils sharing particle j:
/// no eigenvalue is then above 1.25 and no mode has more than a quarter left.
inline Points bend_in_one_step(std::span<const Bend> bends, const Points& p, std::span<const double> inverse_masses, double h) {
  std::vector<double> uses(p.size());
  for (const Bend& bend : bends)
    for (std::size_t j = 0; j < particles_of(bend); ++j) ++uses[bend.particle[j]];
  Points q = p;
  for (const Bend& bend : bends) {
    double weight = 0;
    for (int j = 0; j < 4; ++j) weight += uses[bend.particle[j]] * inverse_masses[bend.particle[j]] * bend.k[j] * bend.k[j];
    const double compliance = std::max(bend.compliance, h * h * weight / 1.25);
    if (!(compliance > 0)) continue;
    const Vector l = bend_value(bend.k, {p[bend.particle[0]], p[bend.particle[1]], p[bend.particle[2]], p[bend.particle[3]]});
    for (std::size_t j = 0; j < particles_of(bend); ++j)
      q[bend.particle[j]] -= h * h * inverse_masses[bend.particle[j]] * bend.k[static_cast<Eigen::Index>(j)] / compliance * l;
  }
  return q;
}

/// One of several iterations. `lambda`: one vector a stencil, renewed.
inline Points relax_bend(std::span<const Bend> bends, const Points& p, std::span<const double> inverse_masses, std::span<Vector> lambda,
                         double h, double omega, Averaged averaging) {
  Copies copies(inverse_masses, averaging);
  for (const Bend& bend : bends)
    for (std::size_t j = 0; j < particles_of(bend); ++j) copies.use(bend.particle[j]);
  for (std::size_t e = 0; e < bends.size(); ++e) {
    const Bend& bend = bends[e];
    double weight = 0;
    for (int j = 0; j < 4; ++j) weight += copies.weight(bend.particle[j]) * bend.k[j] * bend.k[j];
    const Vector l = bend_value(bend.k, {p[bend.particle[0]], p[bend.particle[1]], p[bend.particle[2]], p[bend.particle[3]]});
    const Vector change = change_of_multiplier<Vector>(l, lambda[e], weight / omega, bend.compliance, h);
    lambda[e] += change;
    for (std::size_t j = 0; j < particles_of(bend); ++j) copies.push(bend.particle[j], bend.k[static_cast<Eigen::Index>(j)] * change);
  }
  return copies.averaged(p);
}

}  // namespace weft::reference
