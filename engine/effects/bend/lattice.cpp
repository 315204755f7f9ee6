// Bending where the mesh is a lattice: grids of either topology, and meshes of quads that were cut into triangles.
//
// A plate without Poisson's ratio has the energy 1/2 B (w_uu^2 + 2 w_uv^2 + w_vv^2) per area, which the squares of second differences
// give in all directions: along the lines of the lattice for w_uu and w_vv, over the corners of its quads for w_uv. It is the plate's
// finite differences over thirteen points (Timoshenko and Woinowsky-Krieger 1959, "Theory of plates and shells"), as a sum of squares.
// Each is a stencil of up to four particles, as hinges are (stencils.cpp).
//
//     p --- v --- q     A side (v, d) between two quads carries the line (p, v, q) that crosses it at v, and likewise the one at d.
//     |     |     |     Where the mesh is not quite a lattice, d takes a small part: the four points of a stencil have one sum
//     o --- d --- o     K . x, up to a factor, that is zero for every flat pose.
//
// A quad's area is shared among the lines that cross its sides, each direction's by itself: with a side at the rim, where no line
// crosses, the opposite side has it all. Curvature across a free rim is zero, so nothing is lost there, and quadratic
// heights have a plate's energy to the rim. A triangle at the rim that has no partner, as in grids with centres, counts as half a quad; its
// share of w_uv goes to the quads beside it.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

using Eigen::Vector2d;

// Of the angles of a lattice's quads: 70 to 110 degrees. Beyond, the directions of the three differences are too far from those that
// make the energy isotropic.
constexpr double kLargestCosine = 0.35;
// A line of three points is straight if a fourth would take less than this part. Points are floats.
constexpr double kStraight = 1e-5;

double angle(const Mesh& mesh, std::uint32_t at, std::uint32_t a, std::uint32_t b) {
  const Eigen::Vector3d u = vector(mesh.points[a]) - vector(mesh.points[at]), v = vector(mesh.points[b]) - vector(mesh.points[at]);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}
double distance(const Mesh& mesh, std::uint32_t a, std::uint32_t b) { return (vector(mesh.points[a]) - vector(mesh.points[b])).norm(); }
double area(const Mesh& mesh, const Triangle& t) {
  const Eigen::Vector3d a = vector(mesh.points[t[0]]);
  return 0.5 * (vector(mesh.points[t[1]]) - a).cross(vector(mesh.points[t[2]]) - a).norm();
}
bool right(double angle) { return std::abs(std::cos(angle)) < kLargestCosine; }

// A quad of two triangles that share their longest edge, or one triangle whose longest edge is at the rim.
struct Quad {
  // Round it: an end of the diagonal, the first triangle's corner, the other end, the second's corner or kNone.
  std::array<std::uint32_t, 4> corner;
  std::array<std::uint32_t, 2> triangle;   // the second may be kNone
  bool half() const { return triangle[1] == kNone; }
  double area = 0;                         // m^2
  bool serves = true;

  /// The corner beside `v` that is not `d`; kNone in a half.
  std::uint32_t beside(std::uint32_t v, std::uint32_t d) const {
    const auto at = static_cast<std::size_t>(std::find(corner.begin(), corner.end(), v) - corner.begin());
    const std::uint32_t next = corner[(at + 1) % 4], before = corner[(at + 3) % 4];
    return next == d ? before : next;
  }
};

// The line (p, v, q) across a side (v, d).
struct Line {
  std::uint32_t p, q, v, d;
  double area = 0;
};

class Lattice {
 public:
  explicit Lattice(const Mesh& mesh)
      : mesh_(mesh), quad_of_(mesh.triangles.size(), kNone), at_rim_(mesh.points.size()), sides_(mesh.edges.size()) {
    for (const WingedEdge& edge : mesh.edges)
      if (edge.triangle[0] == kNone || edge.triangle[1] == kNone) at_rim_[edge.a] = at_rim_[edge.b] = true;
    for (const WingedEdge& edge : mesh.edges) add_quad(edge);
    if (quads_.empty()) return;
    sides_of_.resize(quads_.size());
    for (std::uint32_t e = 0; e < mesh.edges.size(); ++e) add_lines(e);
    find_which_serve();
    share();
  }

  bool has(std::uint32_t triangle) const { return quad_of_[triangle] != kNone && quads_[quad_of_[triangle]].serves; }

  void add_stencils(double rigidity, std::vector<gpu::Bend>& bends) const {
    // Lines over the same three points, found across either side, are one. They lie beside each other: all of v's lie at sides of v.
    std::vector<std::vector<std::uint32_t>> at(mesh_.points.size());
    const auto add = [&](const std::array<std::uint32_t, 4>& points, const std::array<Vector2d, 4>& x, double part) {
      const gpu::Bend bend = stencil(points, x, rigidity, part);
      const std::uint32_t centre = points[2];
      if (bend.k[3] == 0)
        for (const std::uint32_t other : at[centre]) {
          gpu::Bend& same = bends[other];
          if (same.k[3] != 0 || std::minmax(same.particle[0], same.particle[1]) != std::minmax(points[0], points[1])) continue;
          same.compliance = 1 / (1 / same.compliance + 1 / bend.compliance);
          return;
        }
      at[centre].push_back(static_cast<std::uint32_t>(bends.size()));
      bends.push_back(bend);
    };
    for (std::size_t e = 0; e < sides_.size(); ++e)
      for (const std::optional<Line>& line : sides_[e]) {
        if (!line || !(line->area > 0)) continue;
        const auto [p, q, v, d, part] = *line;
        add({p, q, v, d}, {from(v, p, angle_beside(e, 0, v), 1), from(v, q, angle_beside(e, 1, v), -1), Vector2d::Zero(), from(v, d, 0, 1)},
            part);
      }
    for (std::size_t k = 0; k < quads_.size(); ++k) {
      if (!(twist_[k] > 0)) continue;
      const auto [a, c, b, d] = quads_[k].corner;
      add({a, b, c, d}, {Vector2d::Zero(), from(a, b, 0, 1), from(a, c, angle(mesh_, a, b, c), 1), from(a, d, angle(mesh_, a, b, d), -1)},
          twist_[k]);
    }
  }

 private:
  Vector2d from(std::uint32_t at, std::uint32_t to, double turn, double side) const {
    return distance(mesh_, at, to) * Vector2d(std::cos(turn), side * std::sin(turn));
  }
  // Of a quad at its corner v, unfolded into the plane.
  double corner_angle(const Quad& quad, std::uint32_t v) const {
    const auto [a, c, b, d] = quad.corner;
    if (v == c || v == d) return angle(mesh_, v, a, b);
    const std::uint32_t other = v == a ? b : a;
    return angle(mesh_, v, c, other) + (quad.half() ? 0 : angle(mesh_, v, d, other));
  }
  // At v, of the quad on one side of an edge.
  double angle_beside(std::size_t e, std::size_t side, std::uint32_t v) const {
    return corner_angle(quads_[quad_of_[mesh_.edges[e].triangle[side]]], v);
  }

  void add_quad(const WingedEdge& edge) {
    Quad quad{{edge.a, kNone, edge.b, kNone}, {kNone, kNone}};
    const double length = distance(mesh_, edge.a, edge.b);
    int sides = 0;
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t t = edge.triangle[static_cast<std::size_t>(side)], c = edge.across[static_cast<std::size_t>(side)];
      if (t == kNone) continue;
      const double sides_length = std::max(distance(mesh_, edge.a, c), distance(mesh_, edge.b, c));
      if (!(length > sides_length * (1 + 1e-6)) || !right(angle(mesh_, c, edge.a, edge.b))) return;
      quad.corner[static_cast<std::size_t>(1 + 2 * sides)] = c;
      quad.triangle[static_cast<std::size_t>(sides++)] = t;
      quad.area += area(mesh_, mesh_.triangles[t]);
    }
    if (sides == 0) return;
    if (sides == 2 &&
        (quad.corner[1] == quad.corner[3] || !right(corner_angle(quad, edge.a)) || !right(corner_angle(quad, edge.b))))
      return;
    for (const std::uint32_t t : quad.triangle)
      if (t != kNone) quad_of_[t] = static_cast<std::uint32_t>(quads_.size());
    quads_.push_back(quad);
  }

  void add_lines(std::uint32_t e) {
    const WingedEdge& edge = mesh_.edges[e];
    std::uint32_t quads[2];
    for (std::size_t side = 0; side < 2; ++side) {
      quads[side] = edge.triangle[side] == kNone ? kNone : quad_of_[edge.triangle[side]];
      if (quads[side] != kNone) sides_of_[quads[side]].push_back(e);
    }
    if (quads[0] == kNone || quads[1] == kNone || quads[0] == quads[1]) return;
    for (const bool second : {false, true}) {
      const std::uint32_t v = second ? edge.b : edge.a, d = second ? edge.a : edge.b;
      const std::uint32_t p = quads_[quads[0]].beside(v, d), q = quads_[quads[1]].beside(v, d);
      if (p != kNone && q != kNone && p != q && p != d && q != d) sides_[e][second] = Line{p, q, v, d};
    }
  }

  // Which way lines cross an edge of a quad: 0 across the sides of corners (0, 1) and (2, 3), 1 across the other two; none: its diagonal.
  std::optional<std::size_t> direction(const Quad& quad, const WingedEdge& edge) const {
    const auto place = [&](std::uint32_t v) {
      return static_cast<std::size_t>(std::find(quad.corner.begin(), quad.corner.end(), v) - quad.corner.begin());
    };
    const std::size_t a = place(edge.a), b = place(edge.b);
    if ((a + b) % 2 == 0) return std::nullopt;
    return std::min(a, b) == 0 && std::max(a, b) == 3 ? 1 : std::min(a, b) % 2;
  }

  template <class Visit>   // (line)
  void lines_across(std::uint32_t k, std::size_t wanted, Visit visit) {
    for (const std::uint32_t e : sides_of_[k])
      if (direction(quads_[k], mesh_.edges[e]) == wanted)
        for (std::optional<Line>& line : sides_[e])
          if (line) visit(*line);
  }

  // The whole quads beside the sides of a half.
  std::vector<std::uint32_t> beside(std::uint32_t k) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t e : sides_of_[k])
      for (const std::uint32_t t : mesh_.edges[e].triangle)
        if (t != kNone && quad_of_[t] != kNone && quad_of_[t] != k && !quads_[quad_of_[t]].half()) found.push_back(quad_of_[t]);
    return found;
  }

  // A quad serves if lines cross it both ways, but for where the cloth is as narrow as the quad.
  void find_which_serve() {
    for (std::uint32_t k = 0; k < quads_.size(); ++k) {
      Quad& quad = quads_[k];
      const bool narrow =
          std::all_of(quad.corner.begin(), quad.corner.end(), [&](std::uint32_t v) { return v == kNone || at_rim_[v]; });
      for (std::size_t way = 0; way < 2; ++way) {
        std::size_t lines = 0;
        lines_across(k, way, [&](const Line&) { ++lines; });
        quad.serves = quad.serves && (lines > 0 || narrow);
      }
      if (quad.half() && beside(k).empty()) quad.serves = false;
    }
  }

  void share() {
    twist_.resize(quads_.size());
    for (std::uint32_t k = 0; k < quads_.size(); ++k) {
      const Quad& quad = quads_[k];
      if (!quad.serves) continue;
      for (std::size_t way = 0; way < 2; ++way) {
        double lines = 0;
        lines_across(k, way, [&](const Line&) { ++lines; });
        lines_across(k, way, [&](Line& line) { line.area += quad.area / lines; });
      }
      if (!quad.half()) {
        twist_[k] += quad.area;
        continue;
      }
      const std::vector<std::uint32_t> others = beside(k);
      for (const std::uint32_t other : others) twist_[other] += quad.area / static_cast<double>(others.size());
    }
  }

  // The sum of the four points that no flat pose changes: each has the area of the other three. With c its value of the three second
  // differences (w_uu, sqrt 2 w_uv, w_vv), as that of quadratic heights, the energy is 1/2 B part (K . x)^2 / |c|^2.
  static gpu::Bend stencil(const std::array<std::uint32_t, 4>& points, const std::array<Vector2d, 4>& x, double rigidity, double part) {
    const auto twice = [&](std::size_t a, std::size_t b, std::size_t c) {
      const Vector2d u = x[b] - x[a], v = x[c] - x[a];
      return u.x() * v.y() - u.y() * v.x();
    };
    std::array<double, 4> k{twice(1, 2, 3), -twice(0, 2, 3), twice(0, 1, 3), -twice(0, 1, 2)};
    const double largest = std::max({std::abs(k[0]), std::abs(k[1]), std::abs(k[2]), std::abs(k[3])});
    if (std::abs(k[3]) < kStraight * largest) {
      const double p = (x[0] - x[2]).norm(), q = (x[1] - x[2]).norm();
      k = {q, p, -(p + q), 0};
    }
    double size = 0;
    for (const double value : k) size += std::abs(value);
    Eigen::Vector3d c = Eigen::Vector3d::Zero();
    for (std::size_t j = 0; j < 4; ++j) {
      k[j] *= 4 / size;
      c += 0.5 * k[j] * Eigen::Vector3d(x[j].x() * x[j].x(), std::sqrt(2.0) * x[j].x() * x[j].y(), x[j].y() * x[j].y());
    }
    gpu::Bend bend{};
    for (std::size_t j = 0; j < 4; ++j) {
      bend.particle[j] = points[j];
      bend.k[j] = static_cast<float>(k[j]);
    }
    bend.compliance = static_cast<float>(c.squaredNorm() / (rigidity * part));
    return bend;
  }

  const Mesh& mesh_;
  std::vector<Quad> quads_;
  std::vector<std::uint32_t> quad_of_;                           // of each triangle
  std::vector<bool> at_rim_;                                     // of each point
  std::vector<std::array<std::optional<Line>, 2>> sides_;        // of each edge: at either end
  std::vector<std::vector<std::uint32_t>> sides_of_;             // of each quad: its edges, the diagonal twice
  std::vector<double> twist_;                                    // m^2: of each quad, the area whose w_uv^2 it has
};

}  // namespace

std::vector<bool> add_lattice_stencils(const Mesh& mesh, double rigidity, std::vector<gpu::Bend>& bends) {
  const Lattice lattice(mesh);
  lattice.add_stencils(rigidity, bends);
  std::vector<bool> served(mesh.triangles.size());
  for (std::uint32_t t = 0; t < served.size(); ++t) served[t] = lattice.has(t);
  return served;
}

}  // namespace weft::cooking
