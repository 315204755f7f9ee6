// Twin of the contact passes: pairs of a vertex and a triangle or of two edges that must not come nearer than a distance, nor
// cross.
//
// A contact is the constraint C(p) = n . sum w_j p_j - keep >= 0 with the direction n and the weights w of the pose in which the
// substep began (Lewin 2018, "Cloth self collision with predictive contacts"); grad_j C = w_j n. Solved with split masses (Tonge
// et al. 2012), each contact with the share of a particle's mass that it has in what the particle's contacts lack together (contact_share.glsl),
// and Coulomb friction: the impulse mu lambda at most, and no more than stops the tangential motion since then.
//
// The limit (after Chen et al. 2025, "Offset geometric contact", planar truncation): particles go straight from x to p; of each
// way only a fraction is gone, so that planes across n part the sides of every pair at the end as they do at the start.
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
  double keep;   // m
  bool edges;    // particles 0 and 1 against 2 and 3; otherwise 0 against the others

  bool on_a(int j) const { return j < (edges ? 2 : 1); }
  std::uint32_t first_of_b() const { return particle[edges ? 2 : 1]; }
};

struct Contact {
  bool directed = false;                 // the sides do not meet
  bool touches = false;                  // worth solving in this substep
  Vector normal = Vector::Zero();        // unit, from side B to side A
  Weights weights = Weights::Zero();
  double keep = 0;                       // m
};

inline Quad places(const Pair& pair, const Points& x) {
  return {x[pair.particle[0]], x[pair.particle[1]], x[pair.particle[2]], x[pair.particle[3]]};
}

/// Sides nearer than this (m) have no direction.
constexpr double kNoDistance = 1e-9;

inline Contact prepare_contact(const Pair& pair, const Points& x, const Points& p, double recover) {
  const Proximity near = closest(places(pair, x), pair.edges ? 2 : 1);
  if (near.distance < kNoDistance) return {};
  Contact contact{true, false, offset(near.weights, places(pair, x)) / near.distance, near.weights, std::min(pair.keep, near.distance + recover)};
  contact.touches = contact.normal.dot(offset(near.weights, places(pair, p))) < contact.keep + 0.1 * pair.keep;
  return contact;
}

inline double contact_value(const Contact& contact, const Quad& p) { return contact.normal.dot(offset(contact.weights, p)) - contact.keep; }
inline Vector contact_gradient(const Contact& contact, int j) { return contact.weights[j] * contact.normal; }

/// What one contact gives its particles (kg m, along their weights). `split`: inverse masses of the copies that it moves.
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
  // No particle is pushed further than -c, however short the lever is that it has.
  const double give = std::max(weight, longest), lambda = -c / give;
  const Vector motion = offset(contact.weights, p) - offset(contact.weights, x);
  const Vector slip = motion - contact.normal * contact.normal.dot(motion);
  if (slip.norm() == 0) return {lambda, Vector::Zero()};
  return {lambda, -std::min(friction * lambda, slip.norm() / give) * slip.normalized()};
}

/// One Jacobi iteration over all contacts that touch. `friction`: one a particle; a pair's is the geometric mean of its sides'.
inline Points solve_contacts(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                             std::span<const double> inverse_masses, std::span<const double> friction) {
  std::vector<double> lacks(p.size());
  const auto lack = [&](std::size_t k, int j) { return std::abs(contacts[k].weights[j]) * std::max(0.0, -contact_value(contacts[k], places(pairs[k], p))); };
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (int j = 0; j < 4; ++j)
      if (contacts[k].touches) lacks[pairs[k].particle[j]] += lack(k, j);
  Points solved = p;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].touches) continue;
    Eigen::Vector4d split, own;
    for (int j = 0; j < 4; ++j) {
      own[j] = inverse_masses[pairs[k].particle[j]];
      split[j] = lack(k, j) > 0 ? own[j] * lacks[pairs[k].particle[j]] / lack(k, j) : own[j];
    }
    const double mu = std::sqrt(friction[pairs[k].particle[0]] * friction[pairs[k].first_of_b()]);
    const ContactImpulse impulse = contact_impulse(contacts[k], places(pairs[k], x), places(pairs[k], p), split, own, mu);
    for (int j = 0; j < 4; ++j)
      solved[pairs[k].particle[j]] += own[j] * (contact_gradient(contacts[k], j) * impulse.lambda + contacts[k].weights[j] * impulse.tangential);
  }
  return solved;
}

/// Of the distance to keep: what the limit leaves of the gap, or all of it if it is less.
constexpr double kLimitMargin = 0.1;
/// Of the largest coordinate: what it leaves at least, because positions are rounded.
constexpr double kLimitFloor = 0x1p-20;

/// Times the distance that a pair keeps: how far from its target it may hold an anchor, unless a scene says otherwise.
constexpr double kPatience = 8;

/// A pair seen along its normal: A above the middle at 0, B below it.
class Layers {
 public:
  Layers(const Pair& pair, const Vector& normal, const Points& x, const Points& p, std::span<const double> inverse_masses) : pair_(pair) {
    double size = 0;
    for (int j = 0; j < 4; ++j) {
      const Vector &from = x[pair.particle[j]], &to = p[pair.particle[j]];
      start_[j] = normal.dot(from - x[pair.particle[0]]);
      way_[j] = normal.dot(to - from);
      fixed_[j] = inverse_masses[pair.particle[j]] == 0;
      least_[j] = fixed_[j] ? std::max(0.0, 1 - kPatience * pair.keep / std::max((to - from).norm(), 1e-30)) : 0;
      size = std::max({size, from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff()});
    }
    const double low = lowest_of_a(start_), high = highest_of_b(start_);
    for (double& s : start_) s -= (low + high) / 2;
    half_gap_ = (low - high) / 2;
    margin_ = std::clamp(low - high, 0.0, std::max(kLimitMargin * pair.keep, kLimitFloor * size));
    slip_ = kLimitFloor * size / 4;
    // Parted to the margin they count as apart, whatever rounding does; a gap that is all that there is may not shrink.
    least_gap_ = margin_ - (low - high > margin_ + slip_ ? slip_ : 1e-4 * margin_);
  }

  bool crosses(const std::array<double, 4>& fractions) const {
    const auto end = ends(fractions);
    return lowest_of_a(end) - highest_of_b(end) < least_gap_;
  }

  /// The fractions to which a round lowers them: only those of a side that comes nearer.
  std::array<double, 4> yield(const std::array<double, 4>& fractions) const {
    const auto end = ends(fractions);
    const double a = std::max(0.0, half_gap_ - lowest_of_a(end)), b = std::max(0.0, highest_of_b(end) + half_gap_);
    if ((a > 0) == (b > 0)) return divide(a, b);
    return a > 0 ? stop(highest_of_b(end) + margin_, -margin_ / 2) : stop(margin_ / 2, lowest_of_a(end) - margin_);
  }

  /// The fractions with which each side keeps to its half of the free room, whatever the other does.
  std::array<double, 4> keep_apart() const { return divide(1, 1); }

 private:
  using Four = std::array<double, 4>;

  double lowest_of_a(const Four& h) const { return pair_.edges ? std::min(h[0], h[1]) : h[0]; }
  double highest_of_b(const Four& h) const { return pair_.edges ? std::max(h[2], h[3]) : std::max({h[1], h[2], h[3]}); }
  Four ends(const Four& fractions) const {
    Four end;
    for (std::size_t j = 0; j < 4; ++j) end[j] = start_[j] + fractions[j] * way_[j];
    return end;
  }
  /// The room between the sides, less the margin, in proportion to what they want. What anchors want comes before, and what they
  /// must have before that.
  Four divide(double a, double b) const {
    const double room = 2 * half_gap_ - margin_;
    if (room <= 0) return stop(margin_ / 2, -margin_ / 2);
    double share = a + b > 0 ? room * a / (a + b) : room / 2;
    for (const Four& fractions : {Four{1, 1, 1, 1}, least_}) {
      double taken_by_a = 0, taken_by_b = 0;
      for (int j = 0; j < 4; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (!fixed_[k]) continue;
        if (pair_.on_a(j)) taken_by_a = std::max(taken_by_a, half_gap_ - start_[k] - fractions[k] * way_[k]);
        else taken_by_b = std::max(taken_by_b, half_gap_ + start_[k] + fractions[k] * way_[k]);
      }
      share = std::min(std::max(share, taken_by_a), room - taken_by_b);
    }
    return stop(half_gap_ - share, room - share - half_gap_);
  }
  /// Nobody of A ends below `a`, nobody of B above `b`, unless it is led and must.
  Four stop(double a, double b) const {
    Four fractions{1, 1, 1, 1};
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      const double towards = pair_.on_a(j) ? 1 : -1, room = towards * (start_[k] - (pair_.on_a(j) ? a : b)), way = towards * way_[k];
      if (room + way >= 0 || way >= slip_) continue;
      fractions[k] = way < 0 ? std::clamp(-room / way, least_[k], 1.0) : 0;
    }
    return fractions;
  }

  const Pair& pair_;
  Four start_{}, way_{};   // m
  Four least_{};           // of its way that an anchor must go, so that it does not lag too far
  std::array<bool, 4> fixed_{};
  double half_gap_ = 0, margin_ = 0, slip_ = 0, least_gap_ = 0;   // m
};

struct Limit {
  std::vector<double> fractions;   // of each particle's way
  bool unsafe = false;             // the rounds were not enough: everybody keeps to its half
};

constexpr int kLastRound = WEFT_ROUNDS - 1;

inline Limit limit_motion(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                          std::span<const double> inverse_masses) {
  Limit limit{std::vector<double>(x.size(), 1.0), false};
  std::vector<double> apart = limit.fractions;
  bool lowered = true;
  for (int round = 0; round <= kLastRound && lowered; ++round) {
    std::vector<double> next = limit.fractions;
    lowered = false;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      std::array<double, 4> before, after;
      bool crosses = false;
      for (std::size_t j = 0; j < 4; ++j) before[j] = limit.fractions[pairs[k].particle[j]];
      if (!contacts[k].directed) {
        for (std::size_t j = 0; j < 4; ++j) after[j] = inverse_masses[pairs[k].particle[j]] == 0 ? 1 : 0;
      } else {
        const Layers layers(pairs[k], contacts[k].normal, x, p, inverse_masses);
        crosses = layers.crosses(before);
        after = round == kLastRound ? layers.keep_apart() : crosses ? layers.yield(before) : before;
      }
      for (std::size_t j = 0; j < 4; ++j) {
        double& fraction = (round == kLastRound ? apart : next)[pairs[k].particle[j]];
        const bool less = after[j] < before[j];
        if (round == kLastRound) limit.unsafe = limit.unsafe || (crosses && less);
        else lowered = lowered || less;
        fraction = std::min(fraction, after[j]);
      }
    }
    limit.fractions = next;
  }
  if (limit.unsafe)
    for (std::size_t i = 0; i < apart.size(); ++i) limit.fractions[i] = std::min(limit.fractions[i], apart[i]);
  return limit;
}

}  // namespace weft::reference
