// Twin of stretch: distance constraints C(a, b) = |a - b| - L with compliance alpha, energy C^2 / (2 alpha)
// (Macklin, Mueller, Chentanez 2016). A link that only pulls is the inequality C <= 0: its multiplier never rises above 0.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"
#include "shaders/support/support.ref.h"

namespace weft::reference {

struct Stretch {
  std::uint32_t a, b;
  double rest;         // m, rest length
  double compliance;   // m/N
  bool only_pulls;
};

inline double stretch_value(const Stretch& link, const Vector& a, const Vector& b) { return (a - b).norm() - link.rest; }
/// With respect to a; with respect to b it is the opposite.
inline Vector stretch_gradient(const Vector& a, const Vector& b) { return (a - b).normalized(); }
/// J; of a link with a compliance above 0.
inline double stretch_energy(const Stretch& link, const Vector& a, const Vector& b) {
  const double c = stretch_value(link, a, b);
  return link.only_pulls && c < 0 ? 0 : c * c / (2 * link.compliance);
}

/// Ends closer than this (m) have no direction and are pushed apart along this one, the end with the lower number forwards.
constexpr double kCoincident = 1e-10;
inline Vector apart() { return {0.36, 0.48, 0.8}; }

/// One iteration. `lambda`: one a link, renewed. `coincident` receives the number of links whose ends were at one place.
inline Points relax_stretch(std::span<const Stretch> links, const Points& p, std::span<const double> inverse_masses,
                            std::span<double> lambda, double h, double omega, Averaged averaging, std::uint32_t& coincident) {
  Copies copies(inverse_masses, averaging);
  for (const Stretch& link : links) {
    copies.use(link.a);
    copies.use(link.b);
  }
  coincident = 0;
  for (std::size_t e = 0; e < links.size(); ++e) {
    const Stretch& link = links[e];
    const bool together = (p[link.a] - p[link.b]).norm() <= kCoincident;
    coincident += together;
    const Vector gradient = together ? (link.a < link.b ? apart() : Vector(-apart())) : stretch_gradient(p[link.a], p[link.b]);
    const double weight = copies.weight(link.a) + copies.weight(link.b);   // gradients are of unit length
    double next = lambda[e] + change_of_multiplier(stretch_value(link, p[link.a], p[link.b]), lambda[e], weight / omega,
                                                   link.compliance, h);
    if (link.only_pulls) next = std::min(next, 0.0);
    const double change = next - lambda[e];
    lambda[e] = next;
    copies.push(link.a, change * gradient);
    copies.push(link.b, -change * gradient);
  }
  return copies.averaged(p);
}

/// A sweep of Gauss-Seidel: one link after another, in their order, moves its ends. `lambda`: one a link, renewed. `supports`: of
/// particles.
inline void sweep_stretch(std::span<const Stretch> links, Points& p, std::span<const double> inverse_masses,
                          std::span<double> lambda, double h, double omega, Supports* supports = nullptr) {
  for (std::size_t e = 0; e < links.size(); ++e) {
    const Stretch& link = links[e];
    const double weight_a = inverse_masses[link.a], weight_b = inverse_masses[link.b];
    const bool together = (p[link.a] - p[link.b]).norm() <= kCoincident;
    const Vector gradient = together ? apart() : stretch_gradient(p[link.a], p[link.b]);
    const double weight = supports ? supported_weight(*supports, link.a, weight_a, link.b, weight_b, gradient) : weight_a + weight_b;
    const double c = stretch_value(link, p[link.a], p[link.b]);
    double next = lambda[e] + change_of_multiplier(c, lambda[e], weight / omega, link.compliance, h);
    if (link.only_pulls) next = std::min(next, 0.0);
    const Vector impulse = (next - lambda[e]) * gradient;
    p[link.a] += supports ? supports->move(link.a, weight_a * impulse) : Vector(weight_a * impulse);
    p[link.b] += supports ? supports->move(link.b, -weight_b * impulse) : Vector(-weight_b * impulse);
    lambda[e] = next;
  }
}

}  // namespace weft::reference
