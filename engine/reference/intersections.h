// Counts crossings of cloth with cloth, to check self-collision. It shares nothing with the passes that it checks: no hash, no
// shader, no tolerance. A tree of bounding boxes finds candidates, exact predicates decide.
//
// An edge and a triangle that share no vertex cross when the closed segment and the closed triangle have a point in common:
//
//        b                   touching counts: an end in the face, on a side or a corner, an edge that lies in the
//    p---|---q               triangle's plane and meets it. So no crossings at all is proof that no two parts of the
//     \  x  /                cloth meet, and no rounding can hide one: an edge through the side that two triangles
//      \ | /                 share counts with both.
//        a
//
// Triangles may be passive: a collider's, which may cross one another as its author likes. What counts is where cloth meets
// cloth or a passive triangle.
//
// A triangle without an area (corners in a line) has no face to be crossed; its edges are tested against all others.
// Limitations: only the given instant is looked at; cloth that passed through in between is not seen. Edges that share a
// vertex with the triangle are skipped, so a triangle folded onto its neighbour is not seen. What is counted are pairs,
// not places: a fold that passes through a sheet counts once for every edge and triangle that meet there.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mesh.h"
#include "engine/vector.h"

namespace weft {

struct Crossing {
  std::array<std::uint32_t, 2> edge;   // a < b, vertices
  std::uint32_t triangle;              // index into the triangles given
  auto operator<=>(const Crossing&) const = default;
};

/// The first `limit` crossings in the order of edge, then triangle. `triangles` may be those of several cloths; each pair of
/// vertices is one edge however many triangles have it. Indices must be in range. Triangles with a corner that is not finite
/// are left out, and so are their edges unless another triangle has them. One core; O(n log n) for cloth that is apart.
/// Triangles from `first_passive` on are passive: their edges, unless another triangle has them, are tested against the
/// others only.
std::vector<Crossing> find_crossings(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t limit,
                                     std::size_t first_passive = kNone);

/// How many there are.
std::uint64_t count_crossings(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t first_passive = kNone);

/// As count_crossings, in bounded time: gives up once more than `most_candidates` pairs of an edge and a triangle whose boxes meet have
/// been looked at, and has then counted some, not all. For meshes of long slivers, where nearly every box meets every other.
struct CrossingCount {
  std::uint64_t pairs = 0;
  bool all = true;
};
CrossingCount count_crossings_among(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::uint64_t most_candidates,
                                    std::size_t first_passive = kNone);

}  // namespace weft
