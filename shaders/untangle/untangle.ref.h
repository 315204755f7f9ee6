// Twin of untangling: which ends of which edges are taken back through which triangles, from all crossings, over all pairs and with regions
// found by union and find.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>

#include "shaders/contact/proximity.ref.h"

namespace weft::reference {

using Corners = std::array<std::uint32_t, 3>;

struct Tangle {
  Points at;                                          // m
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Corners> triangles;
  std::vector<double> inverse_masses;                 // 1/kg; what cannot move on either side does not count as crossing
};

/// Where along the edge from a to b it goes through the triangle p, q, r (0 to 1); below 0: it does not.
inline double crossing_of(const Vector& a, const Vector& b, const Vector& p, const Vector& q, const Vector& r) {
  const Vector n = (q - p).cross(r - p), d = b - a;
  const double from = n.dot(a - p), to = n.dot(b - p);
  if ((from > 0) == (to > 0)) return -1;
  const double u = d.dot((p - a).cross(q - a)), v = d.dot((q - a).cross(r - a)), w = d.dot((r - a).cross(p - a));
  return (u > 0) == (v > 0) && (v > 0) == (w > 0) ? from / (from - to) : -1;
}

/// Of each edge: the triangles that it goes through, by where along it.
inline std::vector<std::map<double, std::uint32_t>> crossings(const Tangle& t) {
  std::vector<std::map<double, std::uint32_t>> found(t.edges.size());
  for (std::size_t e = 0; e < t.edges.size(); ++e)
    for (std::uint32_t k = 0; k < t.triangles.size(); ++k) {
      const std::uint32_t a = t.edges[e][0], b = t.edges[e][1];
      const auto& [p, q, r] = t.triangles[k];
      if (std::ranges::any_of(t.triangles[k], [&](std::uint32_t i) { return i == a || i == b; })) continue;
      if (t.inverse_masses[a] + t.inverse_masses[b] + t.inverse_masses[p] + t.inverse_masses[q] + t.inverse_masses[r] == 0) continue;
      if (const double s = crossing_of(t.at[a], t.at[b], t.at[p], t.at[q], t.at[r]); s >= 0) found[e].emplace(s, k);
    }
  return found;
}

/// Of each particle: the least number of one that it hangs together with by edges with an even number of crossings.
inline std::vector<std::uint32_t> regions(const Tangle& t, const std::vector<std::map<double, std::uint32_t>>& crossed) {
  std::vector<std::uint32_t> region(t.at.size());
  std::iota(region.begin(), region.end(), 0);
  const auto root = [&](std::uint32_t i) {
    while (region[i] != i) i = region[i];
    return i;
  };
  for (std::size_t e = 0; e < t.edges.size(); ++e) {
    if (crossed[e].size() % 2 == 1) continue;
    const std::uint32_t a = root(t.edges[e][0]), b = root(t.edges[e][1]);
    region[std::max(a, b)] = std::min(a, b);
  }
  for (std::uint32_t i = 0; i < region.size(); ++i) region[i] = root(i);
  return region;
}

/// A vertex and the corners of the triangle through which it is to go back, sorted.
using Back = std::pair<std::uint32_t, Corners>;

inline std::vector<Back> taken_back(const Tangle& t, const std::vector<std::map<double, std::uint32_t>>& crossed,
                                    const std::vector<std::uint32_t>& region) {
  std::vector<Back> backs;
  const auto size_of = [&](std::uint32_t r) { return std::ranges::count(region, r); };
  for (std::size_t e = 0; e < t.edges.size(); ++e) {
    const auto& [a, b] = t.edges[e];
    if (crossed[e].size() % 2 == 0 || region[a] == region[b]) continue;
    const auto size_a = size_of(region[a]), size_b = size_of(region[b]);
    const bool first = size_a != size_b ? size_a < size_b : region[a] > region[b];
    Corners corners = t.triangles[first ? crossed[e].begin()->second : crossed[e].rbegin()->second];
    std::ranges::sort(corners);
    backs.emplace_back(first ? a : b, corners);
  }
  std::ranges::sort(backs);
  return backs;
}

}  // namespace weft::reference
