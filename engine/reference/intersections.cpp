// Predicates first, then one pair, then the tree.
//
// Signs are right for all finite floats. A determinant is computed in double with a bound on its error; only where the bound
// leaves the sign open is it summed exactly. Products of two floats are exact in double, of three they are two doubles (by
// fma), and no float is so small or great that these leave the range of double. This file is compiled with
// -ffp-contract=off: a sum whose rounding error is taken must not be fused with the product before it.
// Source: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete &
// Computational Geometry 18, 1997: Grow-Expansion (theorem 10), ORIENT2D and ORIENT3D stage A (figures 21 and 23).
#include "engine/reference/intersections.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <compare>
#include <limits>
#include <utility>

namespace weft {

namespace {

using Point = std::array<double, 3>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon() / 2;   // 2^-53, half a unit in the last place

int sign_of(double value) { return (value > 0) - (value < 0); }

// A sum without rounding: components that do not overlap, the smallest first, none zero.
class ExactSum {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = value + parts_[i];
      const double part = sum - value;
      const double error = (value - (sum - part)) + (parts_[i] - part);
      if (error != 0) parts_[kept++] = error;
      value = sum;
    }
    if (value != 0) parts_[kept++] = value;
    size_ = kept;
  }

  // x y must be exact in double, as it is for two floats.
  void add_product(double x, double y, double z) {
    const double xy = x * y;
    const double rounded = xy * z;
    add(std::fma(xy, z, -rounded));
    add(rounded);
  }

  void add_determinant(const Point& a, const Point& b, const Point& c, double factor) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      add_product(a[i], b[j], factor * c[k]);
      add_product(a[i], b[k], -factor * c[j]);
    }
  }

  int sign() const { return size_ == 0 ? 0 : sign_of(parts_[size_ - 1]); }

 private:
  std::array<double, 48> parts_;   // 24 products of three
  std::size_t size_ = 0;
};

// The sign of |a-d b-d c-d|: on which side of the plane through a, b, c the point d lies.
int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2];
  const double bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
  const double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
  const double bc = bx * cy, cb = cx * by, ca = cx * ay, ac = ax * cy, ab = ax * by, ba = bx * ay;
  const double determinant = az * (bc - cb) + bz * (ca - ac) + cz * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(az) + (std::abs(ca) + std::abs(ac)) * std::abs(bz) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cz);
  if (permanent == 0) return 0;   // a difference of doubles is 0 for equal ones only, and floats' products do not underflow
  if (std::abs(determinant) > (7 + 56 * kEpsilon) * kEpsilon * permanent) return sign_of(determinant);
  ExactSum sum;
  sum.add_determinant(a, b, c, 1);
  sum.add_determinant(a, b, d, -1);
  sum.add_determinant(a, c, d, 1);
  sum.add_determinant(b, c, d, -1);
  return sum.sign();
}

struct Flat {
  double x, y;
};

// Along `axis`, onto the plane of the other two.
Flat project(const Point& point, int axis) { return {point[(axis + 1) % 3], point[(axis + 2) % 3]}; }

// The sign of |a-c b-c| where double can tell it, else 0.
int likely_turn(Flat a, Flat b, Flat c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double determinant = left - right;
  const double bound = (3 + 16 * kEpsilon) * kEpsilon * (std::abs(left) + std::abs(right));
  return std::abs(determinant) > bound ? sign_of(determinant) : 0;
}

int exact_turn(Flat a, Flat b, Flat c) {
  if (const int sign = likely_turn(a, b, c); sign != 0) return sign;
  ExactSum sum;
  for (const double product : {a.x * b.y, -a.y * b.x, b.x * c.y, -b.y * c.x, c.x * a.y, -c.y * a.x}) sum.add(product);
  return sum.sign();
}

struct Corners {
  Point p, q, r;
};

// Whether a line along a side or along the edge has the edge strictly on one side and the triangle on the other. In the
// plane these four are enough: they are the sides of the triangle swept along the edge (its Minkowski sum). No answer
// ("false") for a triangle without an area.
template <class Turn>
bool separated(const Point& a, const Point& b, const Corners& corners, int axis, Turn&& turn) {
  const Flat u = project(a, axis), v = project(b, axis);
  const std::array<Flat, 3> t = {project(corners.p, axis), project(corners.q, axis), project(corners.r, axis)};
  const int winding = turn(t[0], t[1], t[2]);
  if (winding == 0) return false;
  for (int i = 0; i < 3; ++i)
    if (turn(t[i], t[(i + 1) % 3], u) == -winding && turn(t[i], t[(i + 1) % 3], v) == -winding) return true;
  const int first = turn(u, v, t[0]);
  return first != 0 && turn(u, v, t[1]) == first && turn(u, v, t[2]) == first;
}

bool meet_in_plane(const Point& a, const Point& b, const Corners& t) {
  for (int axis = 0; axis < 3; ++axis)
    if (exact_turn(project(t.p, axis), project(t.q, axis), project(t.r, axis)) != 0) return !separated(a, b, t, axis, exact_turn);
  return false;
}

int broad_axis(const Corners& t) {
  Point normal;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = std::abs((t.q[j] - t.p[j]) * (t.r[k] - t.p[k]) - (t.q[k] - t.p[k]) * (t.r[j] - t.p[j]));
  }
  return static_cast<int>(std::max_element(normal.begin(), normal.end()) - normal.begin());
}

bool meet(const Point& a, const Point& b, const Corners& t) {
  // Most candidates are neighbours in a nearly flat piece, where the orientations are close to 0 and dear, the shadows far apart.
  if (separated(a, b, t, broad_axis(t), likely_turn)) return false;
  const int from = orientation(t.p, t.q, t.r, a), to = orientation(t.p, t.q, t.r, b);
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return meet_in_plane(a, b, t);
  // The line meets the plane in one point, within the edge: it is in the triangle unless two sides see it turn differently.
  const int pq = orientation(a, b, t.p, t.q), qr = orientation(a, b, t.q, t.r);
  if (pq * qr < 0) return false;
  const int rp = orientation(a, b, t.r, t.p);
  return pq * rp >= 0 && qr * rp >= 0;
}

struct Box {
  std::array<float, 3> low, high;

  void add(const Box& box) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], box.low[i]);
      high[i] = std::max(high[i], box.high[i]);
    }
  }
  bool meets(const Box& box) const {
    return low[0] <= box.high[0] && box.low[0] <= high[0] && low[1] <= box.high[1] && box.low[1] <= high[1] &&
           low[2] <= box.high[2] && box.low[2] <= high[2];
  }
};

Box box_of(Vec3 v) { return {{v.x, v.y, v.z}, {v.x, v.y, v.z}}; }
Point point_of(Vec3 v) { return {v.x, v.y, v.z}; }
bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Halved at the median of the longest axis; depth first, so the left child follows its parent. Minima and maxima of floats
// are exact, so no box is too small.
class Tree {
 public:
  Tree(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::vector<std::uint32_t> order)
      : boxes_(triangles.size()), order_(std::move(order)) {
    for (const std::uint32_t t : order_) {
      boxes_[t] = box_of(positions[triangles[t][0]]);
      boxes_[t].add(box_of(positions[triangles[t][1]]));
      boxes_[t].add(box_of(positions[triangles[t][2]]));
    }
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
  }

  template <class F>
  void each(const Box& box, F&& visit) const {
    std::uint32_t node = 0;
    while (node < nodes_.size()) {
      const Node& at = nodes_[node];
      const bool inside = at.box.meets(box);
      if (inside)
        for (std::uint32_t i = at.first; i < at.last; ++i)
          if (boxes_[order_[i]].meets(box)) visit(order_[i]);
      node = inside ? node + 1 : at.next;
    }
  }

 private:
  static constexpr std::uint32_t kLeaf = 4;

  struct Node {
    Box box;
    std::uint32_t first = 0, last = 0;   // of order_; leaves only
    std::uint32_t next = 0;              // the node after all below this one
  };

  void build(std::uint32_t first, std::uint32_t last) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({boxes_[order_[first]], 0, 0, 0});
    Box box = boxes_[order_[first]];
    for (std::uint32_t i = first; i < last; ++i) box.add(boxes_[order_[i]]);
    nodes_[node].box = box;
    if (last - first <= kLeaf) {
      nodes_[node].first = first;
      nodes_[node].last = last;
    } else {
      int axis = 0;
      for (int i = 1; i < 3; ++i)
        if (box.high[i] - box.low[i] > box.high[axis] - box.low[axis]) axis = i;
      const std::uint32_t middle = first + (last - first) / 2;
      std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](std::uint32_t a, std::uint32_t b) {
        return double(boxes_[a].low[axis]) + boxes_[a].high[axis] < double(boxes_[b].low[axis]) + boxes_[b].high[axis];
      });
      build(first, middle);
      build(middle, last);
    }
    nodes_[node].next = static_cast<std::uint32_t>(nodes_.size());
  }

  std::vector<Box> boxes_;   // per triangle
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

struct Edge {
  std::uint32_t a, b;
  bool passive;   // no triangle of cloth has it
  auto operator<=>(const Edge&) const = default;
};

// Calls `found` with every crossing in order, until it returns false or there were more candidates than `most`. Whether it came to the end.
template <class F>
bool visit_crossings(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t first_passive, std::uint64_t most,
                     F&& found) {
  std::vector<std::uint32_t> cloth, passive;
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle& v = triangles[t];
    assert(v[0] < positions.size() && v[1] < positions.size() && v[2] < positions.size());
    if (!finite(positions[v[0]]) || !finite(positions[v[1]]) || !finite(positions[v[2]])) continue;
    (t < first_passive ? cloth : passive).push_back(t);
    for (int i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(v[i], v[(i + 1) % 3]);
      edges.push_back({a, b, t >= first_passive});
    }
  }
  // Of an edge that both have, cloth's comes first and stays.
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.a == f.a && e.b == f.b; }), edges.end());

  const Tree cloth_tree(positions, triangles, std::move(cloth)), passive_tree(positions, triangles, std::move(passive));
  std::vector<std::uint32_t> crossed;
  std::uint64_t candidates = 0;
  for (const auto& [a, b, is_passive] : edges) {
    const Point from = point_of(positions[a]), to = point_of(positions[b]);
    Box box = box_of(positions[a]);
    box.add(box_of(positions[b]));
    crossed.clear();
    const auto visit = [&, a = a, b = b](std::uint32_t t) {   // clang 14 captures no bindings by name
      const Triangle& v = triangles[t];
      ++candidates;
      for (const std::uint32_t corner : v)
        if (corner == a || corner == b) return;
      if (meet(from, to, {point_of(positions[v[0]]), point_of(positions[v[1]]), point_of(positions[v[2]])})) crossed.push_back(t);
    };
    cloth_tree.each(box, visit);
    if (!is_passive) passive_tree.each(box, visit);
    std::sort(crossed.begin(), crossed.end());
    for (const std::uint32_t t : crossed)
      if (!found(Crossing{{a, b}, t})) return false;
    if (candidates > most) return false;
  }
  return true;
}

constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::vector<Crossing> find_crossings(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t limit,
                                     std::size_t first_passive) {
  std::vector<Crossing> crossings;
  if (limit == 0) return crossings;
  visit_crossings(positions, triangles, first_passive, kAnyNumber, [&](const Crossing& crossing) {
    crossings.push_back(crossing);
    return crossings.size() < limit;
  });
  return crossings;
}

std::uint64_t count_crossings(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t first_passive) {
  return count_crossings_among(positions, triangles, kAnyNumber, first_passive).pairs;
}

CrossingCount count_crossings_among(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::uint64_t most_candidates,
                                    std::size_t first_passive) {
  CrossingCount count;
  count.all = visit_crossings(positions, triangles, first_passive, most_candidates, [&](const Crossing&) {
    ++count.pairs;
    return true;
  });
  return count;
}

}  // namespace weft
