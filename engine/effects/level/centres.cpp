// Forces act between centres of mass: handed on by shares, they turn nothing then. Lengths are measured between middles, means of fewer
// points: a mean that does not follow each point to and fro, but a wide one lies inside of a bend, and so deep by its width that two of
// unlike widths, as at a rim, are farther apart in bent cloth than in flat.
//
// A middle lies a little off its node. It is known by the nodes around, as every point is, by its place among them: the sum over points i
// of weights w_i times the sum over nodes k of s_ik x_k, and on coarser levels with middles in place of points.
#include "engine/effects/level/centres.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "shaders/shared.h"

namespace weft::cooking {
namespace {

// How many of a node's neighbours are known, and where nodes are many up to where, in lengths of the surface's edges: all that a link's
// middles depend on.
constexpr std::uint32_t kMostAround = 64;
constexpr std::size_t kManyNodes = 500;
constexpr double kAround = 3.6;

// A middle's weights are a share's power of this: it is half as wide as a centre's.
constexpr double kNarrow = 4;

// Nodes that are not known leave this much of a middle's weights, at most; else a link keeps its length.
constexpr double kUnknown = 1e-3;

void add(std::map<std::uint32_t, double>& sum, const Mean& mean, double weight) {
  for (const auto& [point, part] : mean) sum[point] += weight * part;
}

class Unrolled {
 public:
  explicit Unrolled(const IntrinsicSurface& surface, std::size_t nodes)
      : waves_(surface, kMostAround, nodes > kManyNodes ? reaches(surface, nodes) : std::vector<double>()) {
    for (std::uint32_t k = 0; k < nodes; ++k) {
      waves_.add(k);
      if (nodes > kManyNodes) waves_.run();
    }
    waves_.run();
  }

  // How far the places that two means tell of are apart, with node a at the origin of a plane, b on its first axis and a third node above.
  double between(std::uint32_t a, std::uint32_t b, double length, const Mean& from, const Mean& to) const {
    std::map<std::uint32_t, double> weights;
    add(weights, to, 1);
    add(weights, from, -1);
    const auto above = third(a, b, length);
    Eigen::Vector2d sum(0, 0);
    double unknown = 0;
    for (const auto& [k, weight] : weights) {
      const auto place = place_of(k, a, b, length, above);
      if (place) sum += weight * *place;
      else unknown += std::abs(weight);
    }
    const double apart = sum.norm();
    return unknown < kUnknown && apart > 0.03 * length && apart < 3 * length ? apart : length;
  }

 private:
  struct Third {
    std::uint32_t node;
    Eigen::Vector2d place;
  };

  static std::vector<double> reaches(const IntrinsicSurface& surface, std::size_t nodes) {
    std::vector<double> longest(nodes), reach(nodes);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const double length = (surface.flat[t].corners[(k + 1) % 3] - surface.flat[t].corners[k]).norm();
        for (const std::uint32_t p : {surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]}) longest[p] = std::max(longest[p], length);
      }
    for (const Triangle& t : surface.triangles)
      for (const std::uint32_t p : t) reach[p] = std::max({reach[p], kAround * longest[t[0]], kAround * longest[t[1]], kAround * longest[t[2]]});
    return reach;
  }

  std::optional<double> distance(std::uint32_t a, std::uint32_t b) const {
    for (const Waves::Arrived& arrived : waves_.at(a))
      if (arrived.source == b) return arrived.distance;
    return std::nullopt;
  }

  // With its second coordinate above 0.
  std::optional<Eigen::Vector2d> folded_up(std::uint32_t k, std::uint32_t a, std::uint32_t b, double length) const {
    const auto to_a = distance(k, a), to_b = distance(k, b);
    if (!to_a || !to_b) return std::nullopt;
    const double x = (*to_a * *to_a - *to_b * *to_b + length * length) / (2 * length);
    return Eigen::Vector2d(x, std::sqrt(std::max(0.0, *to_a * *to_a - x * x)));
  }

  // The node that tells best on which side of the link others are: far off the line, and near.
  std::optional<Third> third(std::uint32_t a, std::uint32_t b, double length) const {
    std::optional<Third> best;
    std::pair<double, double> most(1e-3, -INFINITY);   // off the line, but enough is enough; and near
    for (const Waves::Arrived& arrived : waves_.at(a)) {
      if (arrived.source == a || arrived.source == b) continue;
      const auto place = folded_up(arrived.source, a, b, length);
      if (!place) continue;
      const double far = arrived.distance + *distance(arrived.source, b);
      const std::pair off(std::min(place->y() / far, 0.2), -far);
      if (off > most) most = off, best = {arrived.source, *place};
    }
    return best;
  }

  std::optional<Eigen::Vector2d> place_of(std::uint32_t k, std::uint32_t a, std::uint32_t b, double length, const std::optional<Third>& above) const {
    if (k == a) return Eigen::Vector2d(0, 0);
    if (k == b) return Eigen::Vector2d(length, 0);
    auto place = folded_up(k, a, b, length);
    if (!place || !above || place->y() < 1e-6 * length) return place;
    const auto to_third = distance(k, above->node);
    if (!to_third) return std::nullopt;
    const Eigen::Vector2d below(place->x(), -place->y());
    return std::abs((*place - above->place).norm() - *to_third) <= std::abs((below - above->place).norm() - *to_third) ? *place : below;
  }

  Waves waves_;
};

// The point's place first, which has all of the weight.
void only(std::uint32_t point, std::vector<Gathered>& gathers) {
  const auto place = std::ranges::find(gathers, point, &Gathered::point);
  std::rotate(gathers.begin(), place, place + 1);
  for (Gathered& gathered : gathers) gathered.in_centre = gathered.in_middle = 0;
  gathers.front().in_centre = gathers.front().in_middle = 1;
}

}  // namespace

Weighed weigh(const Coarse& level, std::span<const Share> shares, const Weights& points, std::span<const Mean> in_points,
              bool even_held, Middles middles) {
  const std::size_t nodes = level.points.size();
  const std::vector<double>& masses = points.masses;
  Weighed made{std::vector<double>(nodes), std::vector<bool>(nodes), std::vector<std::vector<Gathered>>(nodes), {}};
  std::vector<double> near(nodes);   // sums of the middles' weights
  for (std::uint32_t p = 0; p < shares.size(); ++p)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = shares[p].node[k];
      const double part = shares[p].part[k], mass = part * masses[p], narrow = std::pow(std::max(part, 0.0), kNarrow) * masses[p];
      if (even_held ? part == 0 : mass == 0) continue;
      made.masses[node] += mass;
      near[node] += narrow;
      made.gathers[node].push_back({p, mass, narrow});
    }
  for (std::uint32_t k = 0; k < nodes; ++k) {
    double& mass = made.masses[k];
    const std::uint32_t itself = level.points[k];
    const bool is_held = points.is_held(itself);
    if (is_held || !(mass > 0 && near[k] > 0)) {   // by parts below 0 it may be of no weight
      mass = 0;
      made.weightless[k] = !is_held;
      if (even_held) only(itself, made.gathers[k]);
      else made.gathers[k] = {{itself, 1, 1}};
    }
    std::map<std::uint32_t, double> in_nodes;
    const auto add_point = [&](std::uint32_t p, double part) {
      if (middles == Middles::unknown) return;
      for (int j = 0; j < 3; ++j)
        if (level.shares[p].place[j] != 0) in_nodes[level.shares[p].node[j]] += part * level.shares[p].place[j];
    };
    // Rounded as the GPU has them; the first has what the others leave.
    double in_centre = 1, in_middle = 1;
    for (auto gathered = made.gathers[k].rbegin(); gathered != made.gathers[k].rend(); ++gathered) {
      auto& [point, of_centre, of_middle] = *gathered;
      const auto weights = gpu::unpack_level_gather(gpu::pack_level_gather(
          {point, static_cast<float>(of_centre / std::max(mass, 1e-300)), static_cast<float>(of_middle / std::max(near[k], 1e-300))}));
      const bool first = &*gathered == &made.gathers[k].front();
      of_centre = first ? in_centre : double(weights.in_centre);
      of_middle = first ? in_middle : double(weights.in_middle);
      in_centre -= of_centre;
      in_middle -= of_middle;
      if (in_points.empty()) add_point(point, of_middle);
      else
        for (const auto& [p, part] : in_points[point]) add_point(p, of_middle * part);
    }
    if (middles == Middles::known) made.in_nodes.emplace_back(in_nodes.begin(), in_nodes.end());
  }
  return made;
}

void measure_between_middles(Coarse& level, std::span<const Mean> in_nodes) {
  const Unrolled unrolled(level.surface, level.points.size());
  for (CoarseLink& link : level.links) link.rest = unrolled.between(link.a, link.b, link.rest, in_nodes[link.a], in_nodes[link.b]);
}

}  // namespace weft::cooking
