// Edges from triangles: half-edges are matched by a counting sort, not by hashing, so the order never depends on a library's
// hash and the cost is linear. The same runs of half-edges serve the winged edges and the winding.
#include <algorithm>
#include <cassert>

#include "engine/mesh/parts.h"

namespace weft {
namespace parts {

std::vector<HalfEdge> half_edges(std::span<const Triangle> triangles) {
  std::uint32_t point_count = 0;
  for (const Triangle& t : triangles) point_count = std::max({point_count, t[0] + 1, t[1] + 1, t[2] + 1});

  std::vector<std::size_t> start(point_count + std::size_t{1}, 0);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++start[std::min(t[k], t[(k + 1) % 3]) + 1];
  for (std::size_t p = 0; p < point_count; ++p) start[p + 1] += start[p];

  std::vector<HalfEdge> halves(triangles.size() * 3);
  std::vector<std::size_t> next(start.begin(), start.end());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3], across = triangles[t][(k + 2) % 3];
      halves[next[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), t, across, a < b};
    }
  for (std::size_t p = 0; p < point_count; ++p)
    std::sort(halves.begin() + static_cast<std::ptrdiff_t>(start[p]), halves.begin() + static_cast<std::ptrdiff_t>(start[p + 1]),
              [](const HalfEdge& l, const HalfEdge& r) { return l.high != r.high ? l.high < r.high : l.triangle < r.triangle; });
  return halves;
}

std::size_t run_end(std::span<const HalfEdge> halves, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < halves.size() && halves[end].low == halves[begin].low && halves[end].high == halves[begin].high) ++end;
  return end;
}

Orientation orient(std::span<const Triangle> triangles) {
  // Neighbours over edges of exactly two triangles. An edge of three or more says nothing about which way is out.
  struct Link {
    std::uint32_t neighbour;
    bool against;   // the two run the same way along the edge, so one of them must turn
  };
  const std::vector<HalfEdge> halves = half_edges(triangles);
  std::vector<std::array<Link, 3>> links(triangles.size());
  std::vector<std::uint8_t> link_count(triangles.size(), 0);
  for (std::size_t i = 0; i < halves.size();) {
    const std::size_t end = run_end(halves, i);
    if (end - i == 2) {
      const HalfEdge &first = halves[i], &second = halves[i + 1];
      const bool against = first.forward == second.forward;
      links[first.triangle][link_count[first.triangle]++] = {second.triangle, against};
      links[second.triangle][link_count[second.triangle]++] = {first.triangle, against};
    }
    i = end;
  }

  Orientation result;
  std::vector<std::uint8_t> seen(triangles.size(), 0), turned(triangles.size(), 0);
  std::vector<std::uint32_t> piece;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (seen[seed]) continue;
    piece.assign(1, seed);
    seen[seed] = 1;
    std::size_t turned_count = 0;
    bool twisted = false;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const std::uint32_t t = piece[i];
      for (int k = 0; k < link_count[t]; ++k) {
        const auto [neighbour, against] = links[t][static_cast<std::size_t>(k)];
        const std::uint8_t wanted = turned[t] ^ static_cast<std::uint8_t>(against);
        if (seen[neighbour]) {
          twisted |= turned[neighbour] != wanted;
          continue;
        }
        seen[neighbour] = 1;
        turned[neighbour] = wanted;
        turned_count += wanted;
        piece.push_back(neighbour);
      }
    }
    result.twisted_pieces += twisted;
    const std::uint8_t minority = 2 * turned_count > piece.size() ? 0 : 1;   // at a tie the first triangle keeps its winding
    for (const std::uint32_t t : piece)
      if (turned[t] == minority) result.turn.push_back(t);
  }
  std::sort(result.turn.begin(), result.turn.end());
  return result;
}

}   // namespace parts

std::vector<WingedEdge> winged_edges(std::span<const Triangle> triangles, std::uint32_t* non_manifold) {
  const std::vector<parts::HalfEdge> halves = parts::half_edges(triangles);
  std::vector<WingedEdge> edges;
  edges.reserve(halves.size() / 2 + 1);
  std::uint32_t faulty = 0;
  for (std::size_t i = 0; i < halves.size();) {
    const std::size_t end = parts::run_end(halves, i);
    const parts::HalfEdge& first = halves[i];
    WingedEdge edge{
        first.forward ? first.low : first.high, first.forward ? first.high : first.low, {first.triangle, kNone}, {first.across, kNone}};
    for (std::size_t j = i + 1; j < end; ++j)
      if (halves[j].forward != first.forward) {
        edge.triangle[1] = halves[j].triangle;
        edge.across[1] = halves[j].across;
        break;
      }
    faulty += end - i > 2 || (end - i == 2 && edge.triangle[1] == kNone);
    edges.push_back(edge);
    i = end;
  }
  if (non_manifold) *non_manifold = faulty;
  return edges;
}

}   // namespace weft
