// Coarsening a surface by its own geodesics, so that it works on any mesh: over holes, seams and gaps there is no way, and no link.
//
// Nodes are chosen farthest point first (Gonzalez 1985; on surfaces Peyre and Cohen 2006), in units of the local length of edges, so that
// they are as dense as the mesh is. Or, where a mesh's edges follow threads, as grids' do, where about one in three threads crosses one in
// three (threads.cpp): then links lie along threads, and what is pulled along these is pulled straight.
//
// A point's share in the nodes comes from the smallest triangle of its nearest nodes that it lies in,
// laid flat by geodesic distances: barycentric coordinates, which carry a linear displacement exactly. Where the surface unrolls flat these
// triangles are Delaunay's. Their sides are the links of the level.
#include "engine/effects/level/coarsen.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <set>

#include "engine/cook/parts.h"
#include "engine/effects/level/threads.h"

namespace weft::cooking {
namespace {

// Lengths of local edges: nodes are chosen until every point is nearer to one. Where edges follow no threads a node has some 14 particles.
constexpr double kReach = 2.3;

// The same where nodes lie at crossings of threads, the farthest points in the middle between four.
constexpr double kReachWoven = 3.6;

// Nearest nodes of a point that are looked at, and a spare one (geodesic.cpp); and of many points how far, in lengths of local edges: on a
// flat surface the corners of the triangle that a point lies in are nearer than twice the reach, Delaunay's circles being empty.
constexpr std::uint32_t kNearest = 12, kSpare = 1;
constexpr std::size_t kMany = 5000;
constexpr double kSight = 3 * kReach, kSightWoven = 2.2 * kReachWoven;

// A point this far outside a triangle, in barycentric coordinates, still counts as inside: rounding, and surfaces that do not unroll.
constexpr double kInside = -1e-3;

// As far outside of all triangles a displacement is carried on; farther out it is that of the nearest place inside.
constexpr double kOutside = 1;

// How much farther outside a triangle may be for being smaller, over the radii of their circles.
constexpr double kSmaller = 0.1;

// Of the sum of the ways from a corner to its neighbours on the rim: it turns there by 45 degrees, or more.
constexpr double kCorner = 0.75;

// How much alike lengths of a rectangle may differ, relatively.
constexpr double kRectangle = 1e-3;

// Height over longest side: flatter triangles have no say.
constexpr double kFlattest = 0.05;

// The mean length of the edges at each point.
std::vector<double> local_lengths(const IntrinsicSurface& surface, std::size_t points) {
  std::vector<double> sum(points);
  std::vector<std::uint32_t> count(points);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const double length = (surface.flat[t].corners[(k + 1) % 3] - surface.flat[t].corners[k]).norm();
      for (const std::uint32_t p : {surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]}) sum[p] += length, ++count[p];
    }
  for (std::size_t p = 0; p < points; ++p) sum[p] = count[p] > 0 ? sum[p] / count[p] : 1;
  return sum;
}

// The surface in units of its local edges.
IntrinsicSurface in_edges(const IntrinsicSurface& surface, std::size_t points) {
  const std::vector<double> length = local_lengths(surface, points);
  IntrinsicSurface scaled{{}, surface.triangles, {}, static_cast<std::uint32_t>(points)};   // nodes of small pieces may have no triangle
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto side = [&](int from, int to) {
      const double unit = (length[surface.triangles[t][from]] + length[surface.triangles[t][to]]) / 2;
      return (surface.flat[t].corners[to] - surface.flat[t].corners[from]).norm() / std::max(unit, 1e-30);
    };
    scaled.flat.push_back({flat_triangle(side(0, 1), side(0, 2), side(1, 2)), Eigen::Vector2d::Zero()});
  }
  return scaled;
}

// Farthest point first: of the points that are held, of these and the corners, of these and the rim's, then of all. Crossings of threads
// that are held come before all, the others after what is held.
std::vector<std::uint32_t> choose_nodes(const IntrinsicSurface& surface, std::span<const Rank> ranks, Nodes where) {
  const auto points = static_cast<std::uint32_t>(ranks.size());
  const IntrinsicSurface scaled = in_edges(surface, points);
  const Crossings crossings = where == Nodes::along_threads ? crossings_of(surface, points) : no_crossings(points);
  Waves waves(scaled, 1);
  const auto distance = [&](std::uint32_t p) {
    return p < points && !waves.at(p).empty() ? waves.at(p).front().distance : INFINITY;
  };
  std::vector<std::uint32_t> nodes;
  const auto add_crossings = [&](bool held) {
    const std::size_t before = nodes.size();
    // Not where something is held right beside that lies at no crossing.
    const auto is_free = [&](std::uint32_t p) {
      return distance(p) > kThreadsApart / 2.0 || crossings.is_on[nodes[waves.at(p).front().source]];
    };
    for (std::uint32_t p = 0; p < points; ++p)
      if (crossings.is_on[p] && (ranks[p] == Rank::held) == held && is_free(p)) nodes.push_back(p);
    for (std::size_t n = before; n < nodes.size(); ++n) waves.add(nodes[n]);
    waves.run();
  };
  add_crossings(true);
  for (const Rank least : {Rank::held, Rank::corner, Rank::rim, Rank::inner}) {
    if (least == Rank::corner) add_crossings(false);
    std::priority_queue<std::pair<double, std::uint32_t>> farthest;   // with distances as they once were: they only shrink
    for (std::uint32_t p = points; p-- > 0;)
      if (ranks[p] >= least) farthest.emplace(INFINITY, p);
    while (!farthest.empty()) {
      const auto [then, p] = farthest.top();
      farthest.pop();
      const double now = distance(p);
      if (now <= (crossings.is_woven[p] && ranks[p] == Rank::inner ? kReachWoven : kReach)) continue;
      if (now < then) {
        farthest.emplace(now, p);
        continue;
      }
      nodes.push_back(p);
      waves.add(p);
      waves.run();
    }
  }
  return nodes;
}

class Coarsening {
 public:
  Coarsening(const IntrinsicSurface& fine, std::vector<std::uint32_t> nodes, std::size_t points, Nodes where)
      : nodes_(where), waves_(fine, kNearest + kSpare, points > kMany ? sights(fine, points, where) : std::vector<double>()) {
    coarse_.points = std::move(nodes);
    for (const std::uint32_t p : coarse_.points) {
      waves_.add(p);
      if (points > kMany) waves_.run();
    }
    waves_.run();
    for (std::uint32_t p = 0; p < points; ++p) coarse_.shares.push_back(share_of(p));
  }

  Coarse finish(const IntrinsicSurface& fine, std::span<const Vec2> uvs) {
    for (const Triangle& t : fine.triangles) keep_corner(t);
    if (nodes_ == Nodes::along_threads) cross_diagonals();
    for (const auto& [ends, link] : sides_) coarse_.links.push_back(link);
    IntrinsicSurface& surface = coarse_.surface;
    for (const std::uint32_t p : coarse_.points)
      if (!fine.points.empty()) surface.points.push_back(fine.points[p]);
    for (Three nodes : triangles_) {
      if (nodes_ == Nodes::along_threads && is_mirrored(nodes, uvs)) std::swap(nodes[1], nodes[2]);
      const auto side = [&](int i, int j) { return between(nodes[i], nodes[j])->distance; };
      const auto corners = flat_triangle(side(0, 1), side(0, 2), side(1, 2));
      surface.triangles.push_back({nodes[0], nodes[1], nodes[2]});
      surface.flat.push_back({corners, warp_in(corners, nodes, uvs)});
    }
    return std::move(coarse_);
  }

 private:
  static std::vector<double> sights(const IntrinsicSurface& fine, std::size_t points, Nodes where) {
    const double sight = where == Nodes::along_threads ? kSightWoven : kSight;
    const std::vector<double> lengths = local_lengths(fine, points);
    std::vector<double> sights(points);
    for (const Triangle& t : fine.triangles)
      for (const std::uint32_t p : t)
        sights[p] = std::max({sights[p], sight * lengths[t[0]], sight * lengths[t[1]], sight * lengths[t[2]]});
    return sights;
  }

  using Three = std::array<std::uint32_t, 3>;
  using Diagonal = std::pair<std::uint32_t, std::uint32_t>;   // nodes, the lower first

  std::span<const Waves::Arrived> near(std::uint32_t p) const {
    return p == kNone ? std::span<const Waves::Arrived>() : waves_.at(p).first(std::min<std::size_t>(kNearest, waves_.at(p).size()));
  }

  // How far two nodes are apart, if either knows and they are.
  std::optional<Waves::Arrived> between(std::uint32_t a, std::uint32_t b) const {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
      for (const Waves::Arrived& arrived : near(coarse_.points[from]))
        if (arrived.source == to && arrived.distance > 0) return arrived;
    return std::nullopt;
  }

  using Apart = std::array<std::array<double, kNearest>, kNearest>;   // m; not a number where unknown

  Share share_of(std::uint32_t p) {
    const auto nodes = near(p);
    if (nodes.empty()) return {};
    Share best{{nodes[0].source, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    if (nodes[0].distance == 0) return best;
    double smallest = INFINITY, least_outside = INFINITY;
    Diagonal best_first;
    Apart apart;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t j = i + 1; j < nodes.size(); ++j) {
        const auto known = between(nodes[i].source, nodes[j].source);
        apart[i][j] = known ? known->distance : NAN;
      }
    // Nearly always the nearest node is a corner; farther ones are measured less well, and only tell whether there are others as good.
    for (std::size_t h = 0; h < nodes.size(); ++h) {
      const bool found = smallest < INFINITY;
      for (std::size_t i = h + 1; i < nodes.size(); ++i)
        for (std::size_t j = i + 1; j < nodes.size(); ++j)
          try_triangle({nodes[h], nodes[i], nodes[j]}, {apart[h][i], apart[h][j], apart[i][j]}, found, best, smallest, least_outside,
                       best_first);
    }
    if (smallest < INFINITY || least_outside < INFINITY) keep_triangle(best.node);
    else if (nodes.size() > 1) try_side(nodes[0], nodes[1], best);
    return best;
  }

  // The triangle of three nodes, if the point, with these distances from them, lies in it and it is the smallest so far; or outside of all
  // the one that it is least outside of.
  void try_triangle(const std::array<Waves::Arrived, 3>& to, const std::array<double, 3>& sides, bool found, Share& best, double& smallest,
                    double& least_outside, Diagonal& best_first) const {
    const auto& [ab, ac, bc] = sides;
    const double longest = std::max({ab, ac, bc});
    const auto corners = flat_triangle(ab, ac, bc);
    const double width = corners[1].x(), height = corners[2].y();
    if (!(width * height > kFlattest * longest * longest)) return;   // neither is one with a side that is not known
    const double x = (to[0].distance * to[0].distance + width * width - to[1].distance * to[1].distance) / (2 * width);
    double y = std::sqrt(std::max(0.0, to[0].distance * to[0].distance - x * x));
    // On the side that the third distance says.
    const double above = std::abs(std::hypot(x - corners[2].x(), y - height) - to[2].distance);
    if (std::abs(std::hypot(x - corners[2].x(), -y - height) - to[2].distance) < above) y = -y;
    const double c = y / height, b = (x - c * corners[2].x()) / width, a = 1 - b - c;
    const double outside = -std::min({a, b, c}), radius = ab * ac * bc / (2 * width * height);
    // Of triangles with that side in common the smallest, too.
    const double away = -width * height * std::min({a / bc, b / ac, c / ab}) + kSmaller * radius;
    const bool inside = outside < -kInside;
    if (!inside && smallest < INFINITY) return;
    // Of nodes on one circle all points take the triangles of the first, or triangles would overlap and leave gaps; at crossings of
    // threads those along the first of the diagonals, which leave none.
    const double size = inside ? radius : away, best_size = inside ? smallest : least_outside;
    const int opposite = ab >= std::max(ac, bc) ? 2 : ac >= bc ? 1 : 0;
    Diagonal first(std::min({to[0].source, to[1].source, to[2].source}), 0);
    if (nodes_ == Nodes::along_threads) first = std::minmax(to[(opposite + 1) % 3].source, to[(opposite + 2) % 3].source);
    const bool as_good = best_size < INFINITY && std::abs(size - best_size) < 1e-6 * best_size;
    if (as_good ? first >= best_first : found || size >= best_size) return;
    best_first = first;
    inside ? smallest = radius : least_outside = away;
    const double least = outside < kOutside ? -kOutside : 0;
    std::array<double, 3> parts{std::max(least, a), std::max(least, b), std::max(least, c)};
    const double sum = parts[0] + parts[1] + parts[2];
    for (double& part : parts) part /= sum;
    best = {{to[0].source, to[1].source, to[2].source}, parts, {a, b, c}};
  }

  // The same of a line between two nodes, where there is no triangle at all.
  void try_side(const Waves::Arrived& a, const Waves::Arrived& b, Share& best) {
    const auto side = between(a.source, b.source);
    if (!side) return;
    keep_side(a.source, b.source);
    const double squared = side->distance * side->distance;
    const double part = std::clamp((a.distance * a.distance + squared - b.distance * b.distance) / (2 * squared), 0.0, 1.0);
    best = {{a.source, b.source, 0}, {1 - part, part, 0}, {1 - part, part, 0}};
  }

  void keep_side(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto apart = between(a, b);
    sides_.try_emplace({a, b}, CoarseLink{a, b, apart->distance, apart->along});
  }

  void keep_triangle(Three nodes) {
    std::sort(nodes.begin(), nodes.end());
    if (!triangles_.insert(nodes).second) return;
    for (int k = 0; k < 3; ++k) keep_side(nodes[k], nodes[(k + 1) % 3]);
  }

  // Where the regions of three nodes meet they make a triangle, even if no point lies in it: without it the surface would have a hole.
  void keep_corner(const Triangle& t) {
    Three nodes;
    for (int k = 0; k < 3; ++k) {
      if (near(t[k]).empty()) return;
      nodes[k] = near(t[k]).front().source;
    }
    const auto& [a, b, c] = nodes;
    if (a == b || b == c || c == a || !between(a, b) || !between(b, c) || !between(c, a)) return;
    if (has_triangle(nodes)) return;
    if (nodes_ == Nodes::anywhere) return keep_triangle(nodes);
    // Four regions that meet in a point: a rectangle is covered along one diagonal.
    for (int k = 0; k < 3; ++k)
      for (const Waves::Arrived& other : near(coarse_.points[nodes[k]])) {
        const std::uint32_t corner = nodes[k], left = nodes[(k + 1) % 3], right = nodes[(k + 2) % 3], far = other.source;
        if (far == left || far == right || !is_rectangle(corner, far, left, right)) continue;
        if (!has_triangle({corner, left, far}) && !has_triangle({corner, right, far})) continue;
        keep_triangle({corner, left, far});
        keep_triangle({corner, right, far});
        return;
      }
    keep_triangle(nodes);
  }

  bool has_triangle(Three nodes) const {
    std::sort(nodes.begin(), nodes.end());
    return triangles_.contains(nodes);
  }

  // Whether a, c, b and d are the corners of one, one after another: opposite sides are as long, and so are both diagonals, the longest
  // of all.
  bool is_rectangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    const std::array lengths{between(a, b), between(c, d), between(a, c), between(b, d), between(a, d), between(b, c)};
    if (!std::ranges::all_of(lengths, [](const auto& length) { return length.has_value(); })) return false;
    const auto alike = [&](int k) { return std::abs(lengths[k]->distance - lengths[k + 1]->distance) < kRectangle * lengths[k]->distance; };
    const double diagonal = lengths[0]->distance;
    return alike(0) && alike(2) && alike(4) && diagonal > lengths[2]->distance && diagonal > lengths[4]->distance;
  }

  // Of four nodes that make a rectangle both diagonals are links, as on the mesh (stretch/links.cpp): one alone would let cloth shear the
  // other way.
  void cross_diagonals() {
    std::map<Diagonal, std::uint32_t> third;   // by a triangle's longest side
    for (const Three& nodes : triangles_) {
      const auto length = [&](int opposite) { return between(nodes[(opposite + 1) % 3], nodes[(opposite + 2) % 3])->distance; };
      int longest = 0;
      for (const int k : {1, 2})
        if (length(k) > length(longest)) longest = k;
      const Diagonal side = std::minmax(nodes[(longest + 1) % 3], nodes[(longest + 2) % 3]);
      const auto [known, is_first] = third.try_emplace(side, nodes[longest]);
      if (!is_first && is_rectangle(side.first, side.second, known->second, nodes[longest])) keep_side(known->second, nodes[longest]);
    }
  }

  bool is_mirrored(const Three& nodes, std::span<const Vec2> uvs) const {
    if (uvs.empty()) return false;
    const Vec2 a = uvs[coarse_.points[nodes[0]]], b = uvs[coarse_.points[nodes[1]]], c = uvs[coarse_.points[nodes[2]]];
    return (double(b.x) - a.x) * (double(c.y) - a.y) - (double(c.x) - a.x) * (double(b.y) - a.y) < 0;
  }

  Eigen::Vector2d warp_in(const std::array<Eigen::Vector2d, 3>& corners, const Three& nodes, std::span<const Vec2> uvs) const {
    if (uvs.empty()) return Eigen::Vector2d::Zero();
    const Vec2 a = uvs[coarse_.points[nodes[0]]], b = uvs[coarse_.points[nodes[1]]], c = uvs[coarse_.points[nodes[2]]];
    const double u1 = double(b.x) - a.x, u2 = double(c.x) - a.x, v1 = double(b.y) - a.y, v2 = double(c.y) - a.y;
    const Eigen::Vector2d along = (u1 * v2 - u2 * v1) * (v2 * corners[1] - v1 * corners[2]);
    const double length = along.norm();
    return length > 1e-30 && std::isfinite(length) ? Eigen::Vector2d(along / length) : Eigen::Vector2d::Zero();
  }

  Nodes nodes_;
  Waves waves_;
  Coarse coarse_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, CoarseLink> sides_;
  std::set<Three> triangles_;
};

}  // namespace

std::vector<Rank> ranks_of(const Mesh& mesh) {
  std::vector<Rank> ranks(mesh.points.size(), Rank::inner);
  std::vector<Eigen::Vector3d> turn(mesh.points.size(), Eigen::Vector3d::Zero());   // sum of the ways to both neighbours on the rim
  for (const WingedEdge& edge : mesh.edges) {
    if (edge.triangle[0] != kNone && edge.triangle[1] != kNone) continue;
    ranks[edge.a] = ranks[edge.b] = Rank::rim;
    const Eigen::Vector3d way = (vector(mesh.points[edge.b]) - vector(mesh.points[edge.a])).normalized();
    turn[edge.a] += way;
    turn[edge.b] -= way;
  }
  for (std::size_t p = 0; p < ranks.size(); ++p)
    if (ranks[p] == Rank::rim && turn[p].norm() > kCorner) ranks[p] = Rank::corner;
  return ranks;
}

Coarse coarsen(const IntrinsicSurface& fine, std::span<const Rank> ranks, std::span<const Vec2> uvs, Nodes where) {
  return Coarsening(fine, choose_nodes(fine, ranks, where), ranks.size(), where).finish(fine, uvs);
}

}  // namespace weft::cooking
