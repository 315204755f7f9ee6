// A surface as it is measured along itself: triangles by their sides' lengths, wherever they lie in space; and waves over it, which find
// the geodesic distances to the nearest of some sources. Internal.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <queue>
#include <span>
#include <vector>

#include "engine/mesh.h"

namespace weft::cooking {

struct IntrinsicSurface {
  struct Flat {
    std::array<Eigen::Vector2d, 3> corners;   // m, the triangle in a plane
    Eigen::Vector2d warp;                     // unit, the warp's direction there; zero where nothing tells
  };
  std::vector<Eigen::Vector3d> points;        // m, where they lie in space; empty: they lie nowhere
  std::vector<Triangle> triangles;
  std::vector<Flat> flat;                     // of each triangle
  std::uint32_t count = 0;                    // of points, where they lie nowhere: some may be of no triangle
};

IntrinsicSurface surface_of(const Mesh& mesh);

/// A triangle laid flat by its sides' lengths: a first, b along the first axis.
std::array<Eigen::Vector2d, 3> flat_triangle(double ab, double ac, double bc);

/// Waves that run out from sources over a surface (in Dijkstra's order); each point keeps the first few whose waves arrive.
///
/// Along edges alone distances would be up to 8 % too long on a grid. So a distance also propagates across triangles: with the distances
/// of a and b known, the source is unfolded into the triangle's plane and the distance of c measured straight from it, which is exact
/// wherever the surface unrolls flat.
///
///          c          This work is based on: Novotni and Klein 2002, "Computing geodesic distances on triangular
///         / \         meshes" (circular wavefronts); Kimmel and Sethian 1998.
///        a---b        Limitation: behind a hole or a corner, where the straight line leaves the surface, distances
///         \ /         follow edges and are a little too long, never too short.
///      (source)
class Waves {
 public:
  struct Arrived {
    std::uint32_t source;      // by the order of add
    double distance;           // m
    double along;              // cos^2 of the angle between the way, where it arrives, and the warp; 1 where nothing tells
    bool spread;               // it has been propagated at this distance
  };

  /// Of each point the nearest `kept` sources, those that are not farther than its `reach` (m); empty: however far.
  Waves(const IntrinsicSurface& surface, std::uint32_t kept, std::vector<double> reach = {});

  /// Adds a source, and lets the waves of those that were added run: all at once, so that they end where they meet, if only the nearest
  /// are asked for; or one by one, which goes easy on caches where they reach only so far.
  void add(std::uint32_t point);
  void run();

  /// Nearest first.
  std::span<const Arrived> at(std::uint32_t point) const { return {reached_.data() + std::size_t(point) * kept_, count_[point]}; }

 private:
  struct Arrival {
    double distance;
    std::uint32_t point, source;
    bool operator>(const Arrival& other) const;
  };

  // A triangle's side from a corner, and where the third corner is by it.
  struct Side {
    double length;        // m, > 0
    double along, off;    // m, of the third corner: along the side, and away from it
  };

  Arrived* find(std::uint32_t point, std::uint32_t source);
  Arrived* offer(std::uint32_t point, std::uint32_t source, double distance);
  void spread(const Arrival& from, std::uint32_t corner);

  const IntrinsicSurface& surface_;
  std::uint32_t kept_;
  std::vector<double> reach_;
  std::vector<std::uint32_t> sources_;
  std::vector<Arrived> reached_;                // of each point `kept_` places
  std::vector<std::uint32_t> count_;            // of them that are taken
  std::vector<std::uint32_t> first_, around_;   // corners of triangles at each point: three times the triangle's number, and which of it
  std::vector<Side> sides_;                     // two of each corner, to the next one and to the one after
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> front_;
};

}  // namespace weft::cooking
