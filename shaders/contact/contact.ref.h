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

/// Ranks of particles, by which it is decided who gives way in contact_slide: told in an earlier round to get out of the way of one with a
/// rank; where a kinematic particle is going to be; kinematic. Others have 0.
constexpr std::uint32_t kRankTold = 1, kRankInTheWay = 2, kRankKinematic = 3;

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

  struct Slide {
    std::array<double, 4> by{};   // m, along the normal: by how much the ends of whole steps are to be raised to their planes
    bool drives[2] = {};          // whether side A, or B, has particles that the other one gives way to
  };
  /// `ranks`: of the particles (rank_particles).
  Slide slide(std::array<std::uint32_t, 4> ranks) const {
    const Four whole{1, 1, 1, 1}, end = ends(whole);
    Slide slide;
    if (!crosses(whole)) return slide;
    std::uint32_t of_sides[2] = {0, 0};
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (kinematic_[k]) ranks[k] = kRankKinematic;
      std::uint32_t& of_side = of_sides[pair_.on_a(j) ? 0 : 1];
      of_side = std::max(of_side, ranks[k]);
    }
    const auto pushes = [&](int j) {
      const auto k = static_cast<std::size_t>(j);
      return kinematic_[k] || (ranks[k] > 0 && (pair_.on_a(j) ? of_sides[0] > of_sides[1] : of_sides[1] > of_sides[0]));
    };
    auto [a, b] = planes(whole);
    // Cloth goes ahead of what pushes it.
    for (int j = 0; j < 4; ++j) {
      if (!pushes(j)) continue;
      const auto k = static_cast<std::size_t>(j);
      if (pair_.on_a(j)) b = std::min(b, end[k] - margin_);
      else a = std::max(a, end[k] + margin_);
      slide.drives[pair_.on_a(j) ? 0 : 1] = true;
    }
    for (int j = 0; j < 4; ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (pushes(j)) continue;
      slide.by[k] = pair_.on_a(j) ? std::max(0.0, a + 2 * rounding_ - end[k]) : std::min(0.0, b - 2 * rounding_ - end[k]);
    }
    return slide;
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

/// The ranks that contact_prepare gives: of particles that are where a kinematic one is going to be, as far as active contacts tell.
inline std::vector<std::uint32_t> rank_particles(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x,
                                                 const Points& p, std::span<const double> inverse_masses) {
  std::vector<std::uint32_t> ranks(x.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].touches) continue;
    double low = 1e30, high = -1e30, approach[2] = {0, 0};
    for (int j = 0; j < 4; ++j) {
      const std::uint32_t i = pairs[k].particle[static_cast<std::size_t>(j)];
      const bool on_a = pairs[k].on_a(j);
      const double height = contacts[k].normal.dot(x[i]), towards = (on_a ? -1 : 1) * contacts[k].normal.dot(p[i] - x[i]);
      if (on_a) low = std::min(low, height);
      else high = std::max(high, height);
      if (inverse_masses[i] == 0) approach[on_a ? 0 : 1] = std::max(approach[on_a ? 0 : 1], towards);
    }
    for (int j = 0; j < 4; ++j) {
      const std::uint32_t i = pairs[k].particle[static_cast<std::size_t>(j)];
      if (inverse_masses[i] > 0 && approach[pairs[k].on_a(j) ? 1 : 0] > low - high) ranks[i] = kRankInTheWay;
    }
  }
  return ranks;
}

/// One round of contact_slide: each particle takes the largest way asked of it, of each sign of each coordinate. `ranks`: one a particle;
/// those that this round gives are added.
inline Points slide(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                    std::span<const double> inverse_masses, std::vector<std::uint32_t>& ranks) {
  Points up(p.size(), Vector::Zero()), down = up, slid = p;
  std::vector<std::uint32_t> then = ranks;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].directed || !contacts[k].touches) continue;
    std::array<std::uint32_t, 4> own;
    for (std::size_t j = 0; j < 4; ++j) own[j] = ranks[pairs[k].particle[j]];
    const auto [by, drives] = Layers(pairs[k], contacts[k].normal, x, p, inverse_masses).slide(own);
    for (std::size_t j = 0; j < 4; ++j) {
      const Vector way = by[j] * contacts[k].normal;
      const std::uint32_t i = pairs[k].particle[j];
      up[i] = up[i].cwiseMax(way);
      down[i] = down[i].cwiseMin(way);
      if (by[j] != 0 && drives[pairs[k].on_a(static_cast<int>(j)) ? 1 : 0]) then[i] = std::max(then[i], kRankTold);
    }
  }
  ranks = then;
  for (std::size_t i = 0; i < p.size(); ++i) slid[i] += up[i] + down[i];
  return slid;
}

/// Of the separation: how far sides must be apart along a turned normal (parting.glsl).
constexpr double kParted = 0.5;

/// The normal, unless the direction between the closest points at the end, or that half-way to it, parts the sides better where the steps
/// begin and end, and by enough.
inline Vector parting_normal(const Pair& pair, const Vector& normal, const Points& x, const Points& p) {
  const auto gap = [&](const Vector& n, const Points& at) {
    double low = 1e30, high = -1e30;
    for (int j = 0; j < 4; ++j) {
      const double height = n.dot(at[pair.particle[static_cast<std::size_t>(j)]] - x[pair.particle[0]]);
      if (pair.on_a(j)) low = std::min(low, height);
      else high = std::max(high, height);
    }
    return low - high;
  };
  const Quad end = places(pair, p);
  const Vector last = offset(closest(end, pair.edges ? 2 : 1).weights, end).normalized();
  Vector best = normal;
  double most = std::max(kParted * pair.separation, std::min(gap(normal, x), gap(normal, p)));
  for (const Vector& n : {Vector((normal + last).normalized()), last}) {
    const double throughout = std::min(gap(n, x), gap(n, p));
    if (throughout <= most) continue;
    best = n;
    most = throughout;
  }
  return best;
}

struct Limit {
  std::vector<double> fractions;   // of each particle's step
  int rounds = 0;
  bool falls_back = false;         // the rounds were not enough: the fallback applies to all
};

/// As contact_limit and contact_limit_rest do; all rounds fit into the workgroup.
inline Limit limit_motion(std::span<const Pair> pairs, std::span<const Contact> contacts, const Points& x, const Points& p,
                          std::span<const double> inverse_masses, std::span<const double> lags = {}) {
  Limit limit{std::vector<double>(x.size(), 1.0)};
  const auto fractions_of = [](const Pair& pair, const std::vector<double>& of) {
    std::array<double, 4> own;
    for (std::size_t j = 0; j < 4; ++j) own[j] = of[pair.particle[j]];
    return own;
  };
  const auto lower = [](const Pair& pair, const std::array<double, 4>& to, std::vector<double>& of) {
    for (std::size_t j = 0; j < 4; ++j) of[pair.particle[j]] = std::min(of[pair.particle[j]], to[j]);
  };
  const auto is_lower = [](const std::array<double, 4>& t, const std::array<double, 4>& before) {
    for (std::size_t j = 0; j < 4; ++j)
      if (t[j] < before[j]) return true;
    return false;
  };
  // Along the pair's normal, or along a better one if it seems to cross.
  const auto layers_of = [&](std::size_t k, const std::array<double, 4>& before) {
    const Layers layers(pairs[k], contacts[k].normal, x, p, inverse_masses, lags);
    if (!layers.crosses(before)) return layers;
    return Layers(pairs[k], parting_normal(pairs[k], contacts[k].normal, x, p), x, p, inverse_masses, lags);
  };
  bool changed = true;
  for (int& round = limit.rounds; changed && round < static_cast<int>(WEFT_LIMIT_ROUNDS); ++round) {
    std::vector<double> next = limit.fractions;
    changed = false;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::array<double, 4> before = fractions_of(pairs[k], limit.fractions);
      std::array<double, 4> t{1, 1, 1, 1};
      if (!contacts[k].directed) {
        for (std::size_t j = 0; j < 4; ++j) t[j] = inverse_masses[pairs[k].particle[j]] == 0 ? 1 : 0;
      } else {
        const Layers layers = layers_of(k, before);
        if (!layers.crosses(before)) continue;
        if (round < static_cast<int>(WEFT_LIMIT_ROUNDS / 2)) t = layers.yield(before);
        if (!is_lower(t, before)) t = layers.keep_apart();
      }
      changed = is_lower(t, before) || changed;
      lower(pairs[k], t, next);
    }
    limit.fractions = next;
  }
  if (!changed) return limit;
  std::vector<double> fallback(x.size(), 1.0);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!contacts[k].directed) continue;
    lower(pairs[k], layers_of(k, {1, 1, 1, 1}).keep_apart(), fallback);
    const std::array<double, 4> before = fractions_of(pairs[k], limit.fractions);
    const Layers layers = layers_of(k, before);
    limit.falls_back = limit.falls_back || (layers.crosses(before) && is_lower(layers.keep_apart(), before));
  }
  if (limit.falls_back)
    for (std::size_t i = 0; i < fallback.size(); ++i) limit.fractions[i] = std::min(limit.fractions[i], fallback[i]);
  return limit;
}

}  // namespace weft::reference
