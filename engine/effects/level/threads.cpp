// Numbers threads: along an edge that lies along the warp the number of the thread of the weft grows by one, and the other way round. A
// piece is what such edges join.
//
// Limitations: where the warp turns at a seam numbers meet others, and the pieces on its sides have no threads together. So it is around
// a tube on coarser levels, where triangles reach across the seam of its UVs. Of cells ten times as long as wide the diagonals count as
// threads, and numbers meet, too.
#include "engine/effects/level/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace weft::cooking {
namespace {

// Of the angle to a thread, cos^2 from which on an edge follows it: those down a skirt are nearly, but not quite, at right angles to its
// rings.
constexpr double kAlong = 0.99;

// A piece has at least this part of the points of the rectangle that its numbers span. Edges that follow threads by chance make less.
constexpr double kWoven = 0.5;

// And at least this part of its points lie each at a crossing of its own.
constexpr double kApart = 0.98;

// And at most this part have nodes, or levels would hardly get coarser.
constexpr double kMostNodes = 0.45;

// Points of the smallest piece.
constexpr std::size_t kFewest = 9;

using Numbers = std::array<int, 2>;   // of the thread of the weft, and of that of the warp

struct Step {
  std::uint32_t from, to;
  Numbers growth;
  double length;   // m
};

// Along threads, by the points where they begin: each edge from both ends, and once for each of its triangles.
struct Steps {
  std::vector<Step> steps;
  std::vector<std::size_t> first;   // of each point, and one more

  std::span<const Step> from(std::uint32_t p) const { return {steps.data() + first[p], first[p + 1] - first[p]}; }
};

Steps steps_of(const IntrinsicSurface& surface, std::size_t points) {
  std::vector<Step> found;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [corners, warp] = surface.flat[t];
    if (warp.isZero()) continue;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d edge = corners[(k + 1) % 3] - corners[k], way = edge.normalized();
      const double along = way.dot(warp), across = warp.x() * way.y() - warp.y() * way.x();
      Numbers growth{};
      if (along * along > kAlong) growth[0] = along > 0 ? 1 : -1;
      else if (across * across > kAlong) growth[1] = across > 0 ? 1 : -1;
      else continue;
      const std::uint32_t from = surface.triangles[t][k], to = surface.triangles[t][(k + 1) % 3];
      found.push_back({from, to, growth, edge.norm()});
      found.push_back({to, from, {-growth[0], -growth[1]}, edge.norm()});
    }
  }
  Steps made{std::vector<Step>(found.size()), std::vector<std::size_t>(points + 1)};
  for (const Step& step : found) ++made.first[step.from + 1];
  for (std::size_t p = 0; p < points; ++p) made.first[p + 1] += made.first[p];
  std::vector<std::size_t> next(made.first.begin(), made.first.end() - 1);
  for (const Step& step : found) made.steps[next[step.from]++] = step;
  return made;
}

// Whether nodes lie along thread `number` of those from `first` to `last`, about every `apart` threads: it is one of round(k length /
// parts).
bool has_nodes(int number, int first, int last, double apart) {
  const int length = last - first, at = number - first;
  const auto parts = std::max(1l, std::lround(double(length) / std::max(1.0, apart) - 1e-3));   // no tie that rounding decides
  const auto k = std::lround(double(at) * double(parts) / std::max(1, length));
  return at == std::lround(double(k) * length / double(parts));
}

class Piece {
 public:
  Piece(const Steps& steps, std::uint32_t start, std::vector<Numbers>& numbers, std::vector<bool>& seen) : numbers_(numbers) {
    points_.push_back(start);
    seen[start] = true;
    for (std::size_t n = 0; n < points_.size(); ++n)
      for (const Step& step : steps.from(points_[n])) {
        const bool is_weft = step.growth[0] == 0;
        lengths_[is_weft] += step.length, ++counts_[is_weft];
        if (seen[step.to]) continue;
        seen[step.to] = true;
        for (int k = 0; k < 2; ++k) {
          numbers[step.to][k] = numbers[step.from][k] + step.growth[k];
          low_[k] = std::min(low_[k], numbers[step.to][k]);
          high_[k] = std::max(high_[k], numbers[step.to][k]);
        }
        points_.push_back(step.to);
      }
  }

  void choose(Crossings& made) const {
    const double size = double(points_.size()), spanned = (double(high_[0]) - low_[0] + 1) * (double(high_[1]) - low_[1] + 1);
    // A line along one thread is no piece: it has steps along both.
    if (points_.size() < kFewest || size < kWoven * spanned || std::min(counts_[0], counts_[1]) < size) return;
    const std::array<double, 2> apart = nodes_apart();
    std::vector<bool> taken(static_cast<std::size_t>(spanned));
    std::vector<std::uint32_t> on;
    std::size_t crossings = 0;
    for (const std::uint32_t p : points_) {
      const auto place = static_cast<std::size_t>(numbers_[p][0] - low_[0]) * static_cast<std::size_t>(high_[1] - low_[1] + 1) +
                         static_cast<std::size_t>(numbers_[p][1] - low_[1]);
      if (taken[place]) continue;
      taken[place] = true;
      ++crossings;
      if (has_nodes(numbers_[p][0], low_[0], high_[0], apart[0]) && has_nodes(numbers_[p][1], low_[1], high_[1], apart[1])) on.push_back(p);
    }
    if (double(crossings) < kApart * size || double(on.size()) > kMostNodes * size) return;
    for (const std::uint32_t p : points_) made.is_woven[p] = true;
    for (const std::uint32_t p : on) made.is_on[p] = true;
  }

 private:
  // Threads. As far apart along the weft as along the warp, so that a point's nearest nodes lie all around it, unless the piece is so
  // narrow that its rims alone have nodes.
  std::array<double, 2> nodes_apart() const {
    std::array<double, 2> apart{};
    for (int k = 0; k < 2; ++k) apart[k] = kThreadsApart * std::sqrt(lengths_[1 - k] / counts_[1 - k] / (lengths_[k] / counts_[k]));
    const std::array<double, 2> even = apart;
    for (int k = 0; k < 2; ++k)
      if (high_[1 - k] - low_[1 - k] < even[1 - k]) apart[k] = std::max<double>(even[k], kThreadsApart);
    return apart;
  }

  const std::vector<Numbers>& numbers_;   // of all points
  std::vector<std::uint32_t> points_;
  Numbers low_{}, high_{};
  std::array<double, 2> lengths_{}, counts_{};   // of steps along the warp, and along the weft
};

}  // namespace

Crossings crossings_of(const IntrinsicSurface& surface, std::size_t points) {
  Crossings made = no_crossings(points);
  const Steps steps = steps_of(surface, points);
  std::vector<Numbers> numbers(points);
  std::vector<bool> seen(points);
  for (std::uint32_t start = 0; start < points; ++start)
    if (!seen[start] && !steps.from(start).empty()) Piece(steps, start, numbers, seen).choose(made);
  // And what lies between their threads: the middles of a grid's cells.
  std::vector<bool> between = made.is_woven;
  for (const Triangle& t : surface.triangles)
    if (made.is_woven[t[0]] || made.is_woven[t[1]] || made.is_woven[t[2]]) between[t[0]] = between[t[1]] = between[t[2]] = true;
  made.is_woven = std::move(between);
  return made;
}

}  // namespace weft::cooking
