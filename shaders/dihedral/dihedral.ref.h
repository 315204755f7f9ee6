// Twin of dihedral and dihedral_gather: the energy of a dihedral angle about its rest angle, E = (phi - phi_rest)^2 / (2 alpha), as
// an XPBD constraint.
//
//        x2         Written with the triangles' normals, n0 = (x1 - x0) x (x2 - x0) and n1 = (x3 - x0) x (x1 - x0), where the shader has
//       /  \        the arms: phi = atan2(e . (n0 x n1), n0 . n1) and, with the edge's length L (Bridson, Marino, Fedkiw 2003,
//     x0----x1      "Simulation of clothing with folds and wrinkles", section 4, which has these up to a common factor),
//       \  /            g2 = -L n0 / |n0|^2,   g3 = -L n1 / |n1|^2,
//        x3             g0 = ((x2 - x1) . e n0 / |n0|^2 + (x3 - x1) . e n1 / |n1|^2) (-1),
//                       g1 = (x2 - x0) . e n0 / |n0|^2 + (x3 - x0) . e n1 / |n1|^2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

using HingePose = std::array<Vector, 4>;

struct Hinge {
  std::array<std::uint32_t, 4> particle;
  double rest;         // rad
  double compliance;   // rad^2/J
};

inline double hinge_angle(const HingePose& x) {
  const Vector e = (x[1] - x[0]).normalized(), n0 = (x[1] - x[0]).cross(x[2] - x[0]), n1 = (x[3] - x[0]).cross(x[1] - x[0]);
  return std::atan2(e.dot(n0.cross(n1)), n0.dot(n1));
}

/// 1/m
inline HingePose hinge_gradient(const HingePose& x) {
  const double length = (x[1] - x[0]).norm();
  const Vector e = (x[1] - x[0]) / length, n0 = (x[1] - x[0]).cross(x[2] - x[0]), n1 = (x[3] - x[0]).cross(x[1] - x[0]);
  const Vector a = n0 / n0.squaredNorm(), b = n1 / n1.squaredNorm();
  return {-(x[2] - x[1]).dot(e) * a - (x[3] - x[1]).dot(e) * b, (x[2] - x[0]).dot(e) * a + (x[3] - x[0]).dot(e) * b, -length * a,
          -length * b};
}

/// C, between -pi and pi.
inline double hinge_value(double rest, const HingePose& x) {
  return std::remainder(hinge_angle(x) - rest, 2 * std::numbers::pi);
}

/// J
inline double hinge_energy(const Hinge& hinge, const HingePose& x) {
  return std::pow(hinge_value(hinge.rest, x), 2) / (2 * hinge.compliance);
}

/// One iteration. `lambda`: one an element, renewed. An element with a triangle without a height has no angle and does nothing.
inline Points relax_hinges(std::span<const Hinge> hinges, const Points& p, std::span<const double> inverse_masses,
                           std::span<double> lambda, double h, double omega, Averaged averaging) {
  Copies copies(inverse_masses, averaging);
  for (const Hinge& hinge : hinges)
    for (const std::uint32_t i : hinge.particle) copies.use(i);
  for (std::size_t k = 0; k < hinges.size(); ++k) {
    const Hinge& hinge = hinges[k];
    const HingePose x{p[hinge.particle[0]], p[hinge.particle[1]], p[hinge.particle[2]], p[hinge.particle[3]]};
    const HingePose gradient = hinge_gradient(x);
    double weight = 0;
    for (std::size_t j = 0; j < 4; ++j) weight += copies.weight(hinge.particle[j]) * gradient[j].squaredNorm();
    if (!std::isfinite(weight)) continue;
    const double change = change_of_multiplier(hinge_value(hinge.rest, x), lambda[k], weight / omega, hinge.compliance, h);
    lambda[k] += change;
    for (std::size_t j = 0; j < 4; ++j) copies.push(hinge.particle[j], change * gradient[j]);
  }
  return copies.averaged(p);
}

}  // namespace weft::reference
