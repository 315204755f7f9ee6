// Twin of the contact passes: pairs of a vertex and a triangle or of two edges that must keep a separation and must not cross.
//
// A contact is the constraint C(p) = n . sum w_j p_j - separation >= 0 with the normal n and the weights w of the pose in which
// the substep began (Lewin 2018, "Cloth self collision with predictive contacts"); grad_j C = w_j n. Masses are split (Tonge et
// al. 2012): a contact gets the share of a particle's mass that it has in the total penetration of the particle's contacts
// (contact_share.glsl). Coulomb friction: an impulse of at most mu lambda, and of no more than stops the tangential motion of
// the substep.
//
// The limit (conservative advancement by planar truncation, after Chen et al. 2025, "Offset geometric contact"): particles move
// straight from x to p, and take only a fraction of that step, so that planes across n part the sides of every pair at the end
// as they do at the start. contact_limit.comp has the derivation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/contact/proximity.ref.h"
#include "shaders/shared.h"

namespace weft::reference {

struct Pair {
  std::array<std::uint32_t, 4> particle;
  double separation;   // m, to keep
  bool edges;          // particles 0 and 1 against 2 and 3; otherwise 0 against the others

  bool on_a(int j) const { return j < (edges ? 2 : 1); }
  std::uint32_t first_of_b() const { return particle[edges ? 2 : 1]; }
};

struct Contact {
  bool directed = false;                 // has a normal: the sides do not touch at the start
  bool touches = false;                  // active in this substep
  Vector normal = Vector::Zero();        // unit, from side B to side A
  Weights weights = Weights::Zero();
  double separation = 0;                 // m, to keep
};

inline Quad places(const Pair& pair, const Points& x) {
  return {x[pair.particle[0]], x[pair.particle[1]], x[pair.particle[2]], x[pair.particle[3]]};
}

/// Whether a kinematic particle of the pair comes nearer by more than the separation, so that other constraints may pull cloth into its way.
inline bool is_pushed(const Pair& pair, const Vector& normal, const Points& x, const Points& p, std::span<const double> inverse_masses) {
  for (int j = 0; j < 4; ++j) {
    const std::uint32_t i = pair.particle[static_cast<std::size_t>(j)];
    if (inverse_masses[i] == 0 && (pair.on_a(j) ? -1 : 1) * normal.dot(p[i] - x[i]) > pair.separation) return true;
  }
  return false;
}

/// By how much more than predicted a pair may approach each other (m): 0.35 of the displacement bounds of both sides, `most` at most, and
/// half of the separation where all of it gives way; a tenth of the separation at least.
struct Straying {
  std::span<const double> bounds = {};   // one a particle
  double most = 0;

  double of(const Pair& pair, std::span<const double> inverse_masses) const {
    double sides[2] = {0, 0};
    for (int j = 0; j < 4 && !bounds.empty(); ++j) {
      double& side = sides[pair.on_a(j) ? 0 : 1];
      side = std::max(side, bounds[pair.particle[static_cast<std::size_t>(j)]]);
    }
    const bool gives_way = std::ranges::all_of(pair.particle, [&](std::uint32_t i) { return inverse_masses[i] > 0; });
    const double off = std::min(most, 0.35 * (sides[0] + sides[1]));
    return std::max(0.1 * pair.separation, gives_way ? std::min(off, 0.5 * pair.separation) : off);
  }
};

inline Contact prepare_contact(const Pair& pair, const Points& x, const Points& p, double recover,
                               std::span<const double> inverse_masses, const Straying& straying = {}) {
  const Quad at = places(pair, x);
  double extent = 0;
  for (const Vector& corner : at) extent = std::max(extent, (corner - at[0]).cwiseAbs().maxCoeff());
  const Proximity near = closest(at, pair.edges ? 2 : 1);
  if (!(near.distance > WEFT_NO_DISTANCE * extent)) return {};
  Contact contact{true, false, offset(near.weights, at) / near.distance, near.weights,
                  std::min(pair.separation, near.distance + recover)};
  contact.touches = contact.normal.dot(offset(near.weights, places(pair, p))) < contact.separation + straying.of(pair, inverse_masses) ||
                    is_pushed(pair, contact.normal, x, p, inverse_masses);
  return contact;
}

inline double contact_value(const Contact& contact, const Quad& p) {
  return contact.normal.dot(offset(contact.weights, p)) - contact.separation;
}
inline Vector contact_gradient(const Contact& contact, int j) { return contact.weights[j] * contact.normal; }

/// The impulse of one contact (kg m); a particle gets it times its weight. `split`: inverse masses of the copies that it moves.
struct ContactImpulse {
  double lambda;      // normal
  Vector tangential;
};
inline ContactImpulse contact_impulse(const Contact& contact, const Quad& x, const Quad& p, const Eigen::Vector4d& split,
                                      const Eigen::Vector4d& inverse_masses, double friction) {
  const double c = contact_value(contact, p);
  double weight = 0, longest = 0;
  for (int j = 0; j < 4; ++j) {
    weight += split[j] * contact_gradient(contact, j).squaredNorm();
    longest = std::max(longest, inverse_masses[j] * std::abs(contact.weights[j]));
  }
  if (c >= 0 || longest == 0) return {0, Vector::Zero()};
  // Bounded lever: no particle is moved further than -c, however small its weight is.
  const double give = std::max(weight, longest), lambda = -c / give;
  const Vector motion = offset(contact.weights, p) - offset(contact.weights, x);
  const Vector slip = motion - contact.normal * contact.normal.dot(motion);
  if (slip.norm() == 0) return {lambda, Vector::Zero()};
  return {lambda, -std::min(friction * lambda, slip.norm() / give) * slip.normalized()};
}

/// What one Jacobi iteration over all active contacts asks for: visit(pair, particle, by how much it is moved). `friction`: one a particle;
/// a pair's is the geometric mean of its sides'.
template <class Visit>
void for_each_correction(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                         std::span<const double> inverse_masses, std::span<const double> friction, Visit&& visit) {
  std::vector<double> total(p.size());
  const auto penetration = [&](std::size_t k, int j) {
    return std::abs(contacts[k].weights[j]) * std::max(0.0, -contact_value(contacts[k], places(pairs[k], p)));
  };
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (int j = 0; j < 4; ++j)
      if (contacts[k].touches) total[pairs[k].particle[j]] += penetration(k, j);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].touches) continue;
    Eigen::Vector4d split, own;
    for (int j = 0; j < 4; ++j) {
      own[j] = inverse_masses[pairs[k].particle[j]];
      split[j] = penetration(k, j) > 0 ? own[j] * total[pairs[k].particle[j]] / penetration(k, j) : own[j];
    }
    const double mu = std::sqrt(friction[pairs[k].particle[0]] * friction[pairs[k].first_of_b()]);
    const ContactImpulse impulse = contact_impulse(contacts[k], places(pairs[k], x), places(pairs[k], p), split, own, mu);
    for (int j = 0; j < 4; ++j)
      visit(k, pairs[k].particle[j],
            Vector(own[j] * (contact_gradient(contacts[k], j) * impulse.lambda + contacts[k].weights[j] * impulse.tangential)));
  }
}

inline Points solve_contacts(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                             std::span<const double> inverse_masses, std::span<const double> friction) {
  Points solved = p;
  for_each_correction(pairs, contacts, x, p, inverse_masses, friction,
                      [&](std::size_t, std::uint32_t i, const Vector& moved) { solved[i] += moved; });
  return solved;
}

/// Relative to the separation: the gap that the limit leaves at a substep's end, or the whole gap if it is less.
constexpr double kLimitMargin = 0.1;
/// Relative to the largest coordinate: the least gap that it leaves, because positions are rounded.
constexpr double kLimitFloor = 0x1p-20;

/// The kinematic lag limit, as a multiple of the separation: how far from its target a pair may hold an anchor, besides a substep's
/// motion, unless a scene says otherwise.
constexpr double kKinematicLagLimit = 8;

/// A pair seen along its normal: side A above the middle of the gap at 0, side B below it.
class Layers {
 public:
  /// `lags`: how far kinematic particles are from their targets at the start (m); empty: they are there.
  Layers(const Pair& pair, const Vector& normal, const Points& x, const Points& p, std::span<const double> inverse_masses,
         std::span<const double> lags = {})
      : pair_(pair) {
    double size = 0;
    for (int j = 0; j < 4; ++j) {
      const Vector &from = x[pair.particle[j]], &to = p[pair.particle[j]];
      start_[j] = normal.dot(from - x[pair.particle[0]]);
      displacement_[j] = normal.dot(to - from);
      kinematic_[j] = inverse_masses[pair.particle[j]] == 0;
      const double too_far = lags.empty() ? 0 : lags[pair.particle[j]] - kKinematicLagLimit * pair.separation;
      least_[j] = kinematic_[j] ? std::clamp(too_far / std::max((to - from).norm(), 1e-30), 0.0, 1.0) : 0;
      size = std::max({size, from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff()});
    }
    const double low = lowest_of_a(start_), high = highest_of_b(start_);
    for (double& s : start_) s -= (low + high) / 2;
    half_gap_ = (low - high) / 2;
    margin_ = std::clamp(low - high, 0.0, std::max(kLimitMargin * pair.separation, kLimitFloor * size));
    rounding_ = kLimitFloor * size / 4;
    // A pair that was parted to the margin does not count as crossing, in spite of rounding; a pair without slack may not come closer.
    least_gap_ = margin_ - (low - high > margin_ + rounding_ ? rounding_ : 1e-4 * margin_);
  }

  bool crosses(const std::array<double, 4>& fractions) const {
    const auto end = ends(fractions);
    return lowest_of_a(end) - highest_of_b(end) < least_gap_;
  }

  /// The fractions to which a pass lowers them: only those of a side that approaches.
  std::array<double, 4> yield(const std::array<double, 4>& fractions) const { return stop(planes(fractions)); }

  /// The heights by which the ends of whole steps are to be raised to their planes, along the normal; 0 of kinematic particles (m).
  std::array<double, 4> slide() const {
    const Four whole{1, 1, 1, 1}, end = ends(whole);
    Four by{};
    if (!crosses(whole)) return by;
    auto [a, b] = planes(whole);
    // Cloth goes ahead of kinematic particles.
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (kinematic_[k] && pair_.on_a(j)) b = std::min(b, end[k] - margin_);
      if (kinematic_[k] && !pair_.on_a(j)) a = std::max(a, end[k] + margin_);
    }
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (kinematic_[k]) continue;
      by[k] = pair_.on_a(j) ? std::max(0.0, a + 2 * rounding_ - end[k]) : std::min(0.0, b - 2 * rounding_ - end[k]);
    }
    return by;
  }

  /// The fallback: fractions with which each side keeps to its half of the slack, whatever the other does.
  std::array<double, 4> keep_apart() const { return stop(divide(1, 1)); }

 private:
  using Four = std::array<double, 4>;
  using Planes = std::array<double, 2>;   // heights below which no particle of A may end, and above which none of B

  double lowest_of_a(const Four& h) const { return pair_.edges ? std::min(h[0], h[1]) : h[0]; }
  double highest_of_b(const Four& h) const { return pair_.edges ? std::max(h[2], h[3]) : std::max({h[1], h[2], h[3]}); }
  Four ends(const Four& fractions) const {
    Four end;
    for (std::size_t j = 0; j < 4; ++j) end[j] = start_[j] + fractions[j] * displacement_[j];
    return end;
  }
  Planes planes(const Four& fractions) const {
    const auto end = ends(fractions);
    const double a = std::max(0.0, half_gap_ - lowest_of_a(end)), b = std::max(0.0, highest_of_b(end) + half_gap_);
    if ((a > 0) == (b > 0)) return divide(a, b);
    return a > 0 ? Planes{highest_of_b(end) + margin_, -margin_ / 2} : Planes{margin_ / 2, lowest_of_a(end) - margin_};
  }
  /// Divides the slack, the gap less the margin, in proportion to a and b. Kinematic particles get what they need to reach their
  /// targets, and before that what they need to stay within their lag limit.
  Planes divide(double a, double b) const {
    const double slack = 2 * half_gap_ - margin_;
    if (slack <= 0) return {margin_ / 2, -margin_ / 2};
    double share = a + b > 0 ? slack * a / (a + b) : slack / 2;
    for (const Four& fractions : {Four{1, 1, 1, 1}, least_}) {
      double taken_by_a = 0, taken_by_b = 0;
      for (int j = 0; j < 4; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (!kinematic_[k]) continue;
        if (pair_.on_a(j)) taken_by_a = std::max(taken_by_a, half_gap_ - start_[k] - fractions[k] * displacement_[k]);
        else taken_by_b = std::max(taken_by_b, half_gap_ + start_[k] + fractions[k] * displacement_[k]);
      }
      share = std::min(std::max(share, taken_by_a), slack - taken_by_b);
    }
    return {half_gap_ - share, slack - share - half_gap_};
  }
  /// Truncates steps at these planes, except those of kinematic particles that must go on.
  Four stop(const Planes& planes) const {
    Four fractions{1, 1, 1, 1};
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      const double towards = pair_.on_a(j) ? 1 : -1, slack = towards * (start_[k] - planes[pair_.on_a(j) ? 0 : 1]);
      const double displacement = towards * displacement_[k];
      if (slack + displacement >= 0 || displacement >= rounding_) continue;
      fractions[k] = displacement < 0 ? std::clamp(-slack / displacement, least_[k], 1.0) : 0;
    }
    return fractions;
  }

  const Pair& pair_;
  Four start_{}, displacement_{};   // m, along the normal
  Four least_{};                    // of its step that a kinematic particle must take, to stay within its lag limit
  std::array<bool, 4> kinematic_{};
  double half_gap_ = 0, margin_ = 0, rounding_ = 0, least_gap_ = 0;   // m
};

/// One round of contact_slide: each particle takes the largest way asked of it, of each sign of each coordinate.
inline Points slide(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                    std::span<const double> inverse_masses) {
  Points up(p.size(), Vector::Zero()), down = up, slid = p;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].directed || !contacts[k].touches) continue;
    const auto by = Layers(pairs[k], contacts[k].normal, x, p, inverse_masses).slide();
    for (std::size_t j = 0; j < 4; ++j) {
      const Vector way = by[j] * contacts[k].normal;
      const std::uint32_t i = pairs[k].particle[j];
      up[i] = up[i].cwiseMax(way);
      down[i] = down[i].cwiseMin(way);
    }
  }
  for (std::size_t i = 0; i < p.size(); ++i) slid[i] += up[i] + down[i];
  return slid;
}

struct Limit {
  std::vector<double> fractions;   // of each particle's step
  bool unsafe = false;             // the passes were not enough: the fallback applies to all
};

constexpr int kLastPass = WEFT_LIMIT_PASSES - 1;

inline Limit limit_motion(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                          std::span<const double> inverse_masses, std::span<const double> lags = {}) {
  Limit limit{std::vector<double>(x.size(), 1.0), false};
  std::vector<double> fallback = limit.fractions;
  bool changed = true;
  for (int pass = 0; pass <= kLastPass && changed; ++pass) {
    std::vector<double> next = limit.fractions;
    changed = false;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      std::array<double, 4> before, after;
      bool crosses = false;
      for (std::size_t j = 0; j < 4; ++j) before[j] = limit.fractions[pairs[k].particle[j]];
      if (!contacts[k].directed) {
        for (std::size_t j = 0; j < 4; ++j) after[j] = inverse_masses[pairs[k].particle[j]] == 0 ? 1 : 0;
      } else {
        const Layers layers(pairs[k], contacts[k].normal, x, p, inverse_masses, lags);
        crosses = layers.crosses(before);
        after = pass == kLastPass ? layers.keep_apart() : crosses ? layers.yield(before) : before;
      }
      for (std::size_t j = 0; j < 4; ++j) {
        double& fraction = (pass == kLastPass ? fallback : next)[pairs[k].particle[j]];
        const bool less = after[j] < before[j];
        if (pass == kLastPass) limit.unsafe = limit.unsafe || (crosses && less);
        else changed = changed || less;
        fraction = std::min(fraction, after[j]);
      }
    }
    limit.fractions = next;
  }
  if (limit.unsafe)
    for (std::size_t i = 0; i < fallback.size(); ++i) limit.fractions[i] = std::min(limit.fractions[i], fallback[i]);
  return limit;
}

}  // namespace weft::reference
