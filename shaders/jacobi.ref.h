// What the Jacobi twins share, in double precision and written from the papers: XPBD's step for one constraint, and the averaging
// of several constraints on one particle. The twins loop over constraints and scatter into all their particles; the shaders
// gather, so that an error in one is not an error in the other.
//
// This work is based on: Macklin, Mueller, Chentanez 2016, "XPBD", eq. 18; Tonge, Benevolenski, Voroshilov 2012, "Mass
// splitting for jitter-free parallel rigid body simulation". A particle in n constraints is cut into n copies of mass m / n,
// each constraint moves its own copies, and the particle goes to the mean of its copies. Count-averaging lets every
// constraint move a copy of the full mass instead, and does not conserve momentum. Over-relaxation applies to the split masses:
// copies show a constraint 1 / omega of their inverse mass, and the constraint's compliance is unchanged.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace weft::reference {

using Vector = Eigen::Vector3d;
using Points = std::vector<Vector>;

enum class Averaged { mass_split, count };   // of several constraints on one particle

/// XPBD, eq. 18: the change of a multiplier. `weight` is sum W |grad C|^2, `compliance` is not yet divided by h^2.
/// A constraint that nothing can give way to (weight and compliance 0) does nothing. C and lambda: a number or a vector.
template <class Value>
Value change_of_multiplier(const Value& c, const Value& lambda, double weight, double compliance, double h) {
  const double scaled = compliance / (h * h);
  if (weight + scaled <= 0) return 0 * c;
  return (-c - scaled * lambda) / (weight + scaled);
}

/// One Jacobi iteration over one kind of constraint: count every use first, then move copies, then take the mean.
class Copies {
 public:
  Copies(std::span<const double> inverse_masses, Averaged averaging)
      : inverse_masses_(inverse_masses),
        averaging_(averaging),
        uses_(inverse_masses.size()),
        moved_(inverse_masses.size(), Vector::Zero()) {}

  void use(std::uint32_t particle) { ++uses_[particle]; }
  /// Inverse mass of one copy.
  double weight(std::uint32_t particle) const {
    return inverse_masses_[particle] * (averaging_ == Averaged::mass_split ? uses_[particle] : 1);
  }
  /// A constraint's impulse (gradient times change of multiplier) on its copy of a particle.
  void push(std::uint32_t particle, const Vector& impulse) { moved_[particle] += weight(particle) * impulse; }
  /// Every particle at the mean of its copies.
  Points averaged(const Points& from) const {
    Points to = from;
    for (std::size_t i = 0; i < to.size(); ++i)
      if (uses_[i] > 0) to[i] += 1.0 / uses_[i] * moved_[i];
    return to;
  }

 private:
  std::span<const double> inverse_masses_;
  Averaged averaging_;
  std::vector<std::uint32_t> uses_;
  Points moved_;
};

}  // namespace weft::reference
