// What the tests of contacts share: particles in tufts, with pairs of vertex and triangle and of two edges between them that share
// particles, and an exact test whether the sides of a pair meet on their way.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "shaders/contact/contact.ref.h"

namespace weft::reference {

struct Tufts {
  Points x, p;                          // m, floats' values, so that the GPU can be given the same
  std::vector<double> inverse_masses;   // 1/kg
  std::vector<Pair> pairs;
};

inline constexpr std::uint32_t kTuft = 8;   // particles
inline constexpr double kTuftSize = 0.05;   // m

/// Each tuft has that many pairs. Particles move by up to `violence` (m) a coordinate; one in `held` has no inverse mass.
inline Tufts tufts(std::mt19937_64& random, std::uint32_t count, int pairs_each, double violence, std::uint32_t held = 8) {
  const auto uniform = [&](double low, double high) {
    return static_cast<double>(static_cast<float>(std::uniform_real_distribution(low, high)(random)));
  };
  const auto anywhere = [&](double size) { return Vector(uniform(-size, size), uniform(-size, size), uniform(-size, size)); };
  Tufts t;
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vector middle = anywhere(1);
    for (std::uint32_t i = 0; i < kTuft; ++i) {
      t.x.push_back((middle + anywhere(kTuftSize / 2)).cast<float>().cast<double>());
      t.p.push_back((t.x.back() + anywhere(violence)).cast<float>().cast<double>());
      t.inverse_masses.push_back(random() % held == 0 ? 0 : uniform(1, 100));
    }
    for (int pair = 0; pair < pairs_each; ++pair) {
      std::array<std::uint32_t, kTuft> order;
      for (std::uint32_t i = 0; i < kTuft; ++i) order[i] = k * kTuft + i;
      std::shuffle(order.begin(), order.end(), random);
      t.pairs.push_back({{order[0], order[1], order[2], order[3]}, uniform(0.001, 0.01), random() % 2 == 0});
    }
  }
  return t;
}

inline std::vector<Contact> prepare(const Tufts& t, double recover, const Straying& straying = {}) {
  std::vector<Contact> contacts;
  for (const Pair& pair : t.pairs) contacts.push_back(prepare_contact(pair, t.x, t.p, recover, t.inverse_masses, straying));
  return contacts;
}

/// Whether the two sides meet while all four particles go straight and evenly. At that time the four lie in a plane, which makes
/// time the root of a cubic (Provot 1997); whether they meet there the distance tells, up to a nanometre.
inline bool sides_meet(const Quad& from, const Quad& to, bool edges) {
  const auto at = [&](double s) {
    Quad x;
    for (std::size_t j = 0; j < 4; ++j) x[j] = (1 - s) * from[j] + s * to[j];
    return x;
  };
  const auto volume = [&](double s) {
    const Quad x = at(s);
    return (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0]));
  };
  // The cubic through four values, and where it turns around.
  const double v0 = volume(0), v1 = volume(1), low = volume(-1), high = volume(2);
  const double c2 = (low + v1) / 2 - v0, c3 = (high - 3 * v1 + 3 * v0 - low) / 6, c1 = v1 - v0 - c2 - c3;
  std::vector<double> ends{0, 1};
  const double root = c2 * c2 - 3 * c1 * c3;
  if (root >= 0) {
    const double q = -(c2 + std::copysign(std::sqrt(root), c2));
    for (const double turn : {q / (3 * c3), c1 / q})
      if (turn > 0 && turn < 1) ends.push_back(turn);
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    double a = ends[k], b = ends[k + 1];
    const bool rises = volume(a) < 0;
    if (rises == (volume(b) < 0)) continue;
    for (int halving = 0; halving < 60; ++halving) ((volume((a + b) / 2) < 0) == rises ? a : b) = (a + b) / 2;
    if (closest(at(b), edges ? 2 : 1).distance < 1e-9) return true;
  }
  return false;
}

/// How many pairs meet on the way from `from` to `to`.
inline std::size_t meetings(const std::vector<Pair>& pairs, const Points& from, const Points& to) {
  return static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(), [&](const Pair& pair) { return sides_meet(places(pair, from), places(pair, to), pair.edges); }));
}

}  // namespace weft::reference
