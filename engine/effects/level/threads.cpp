// Numbers threads: along an edge that lies along the warp the number of the thread of the weft grows by one, and the other way round. A piece
// is what such edges join. Around a tube numbers meet others, and the first ones stay: there two threads are nearer to each other.
#include "engine/effects/level/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace weft::cooking {
namespace {

// Of the angle to a thread, cos^2 from which on an edge follows it: those down a skirt are nearly, but not quite, at right angles to its rings.
constexpr double kAlong = 0.99;

// A piece has at least this part of the points of the rectangle that its numbers span. Edges that follow threads by chance make less.
constexpr double kWoven = 0.5;

// And at least this part of its points lie each at a crossing of its own.
constexpr double kApart = 0.98;

// Points of the smallest piece.
constexpr std::size_t kFewest = 9;

using Numbers = std::array<int, 2>;   // of the thread of the weft, and of that of the warp

struct Step {
  std::uint32_t to;
  Numbers growth;
  double length;   // m
};

std::vector<std::vector<Step>> steps_of(const IntrinsicSurface& surface, std::size_t points) {
  std::vector<std::vector<Step>> steps(points);
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
      steps[from].push_back({to, growth, edge.norm()});
      steps[to].push_back({from, {-growth[0], -growth[1]}, edge.norm()});
    }
  }
  return steps;
}

// Whether nodes lie along thread `number` of those from `first` to `last`, about every `apart` threads: it is one of round(k length / parts).
bool has_nodes(int number, int first, int last, double apart) {
  const int length = last - first, at = number - first;
  const auto parts = std::max(1l, std::lround(double(length) / std::max(1.0, apart)));
  const auto k = std::lround(double(at) * double(parts) / std::max(1, length));
  return at == std::lround(double(k) * length / double(parts));
}

}  // namespace

Crossings crossings_of(const IntrinsicSurface& surface, std::size_t points) {
  Crossings made{std::vector<bool>(points), std::vector<bool>(points)};
  const std::vector<std::vector<Step>> steps = steps_of(surface, points);
  std::vector<Numbers> numbers(points);
  std::vector<bool> seen(points);
  for (std::uint32_t start = 0; start < points; ++start) {
    if (seen[start] || steps[start].empty()) continue;
    std::vector<std::uint32_t> piece{start};
    seen[start] = true;
    Numbers low{}, high{};
    std::array<double, 2> lengths{}, counts{};
    for (std::size_t n = 0; n < piece.size(); ++n)
      for (const Step& step : steps[piece[n]]) {
        const bool is_weft = step.growth[0] == 0;
        lengths[is_weft] += step.length, ++counts[is_weft];
        if (seen[step.to]) continue;
        seen[step.to] = true;
        for (int k = 0; k < 2; ++k) {
          numbers[step.to][k] = numbers[piece[n]][k] + step.growth[k];
          low[k] = std::min(low[k], numbers[step.to][k]);
          high[k] = std::max(high[k], numbers[step.to][k]);
        }
        piece.push_back(step.to);
      }
    std::set<Numbers> crossings;
    for (const std::uint32_t p : piece) crossings.insert(numbers[p]);
    const double spanned = (double(high[0]) - low[0] + 1) * (double(high[1]) - low[1] + 1), size = double(piece.size());
    if (piece.size() < kFewest || size < kWoven * spanned || double(crossings.size()) < kApart * size) continue;
    // As far apart along the weft as along the warp, whatever the cells are like: then a point's nearest nodes lie all around it.
    std::array<double, 2> apart{};
    for (int k = 0; k < 2; ++k) {
      const double own = lengths[k] / std::max(1.0, counts[k]), other = lengths[1 - k] / std::max(1.0, counts[1 - k]);
      apart[k] = own > 0 && other > 0 ? kThreadsApart * std::sqrt(other / own) : kThreadsApart;
    }
    const auto is_on = [&](std::uint32_t p, int k) { return has_nodes(numbers[p][k], low[k], high[k], apart[k]); };
    for (const std::uint32_t p : piece) {
      made.is_woven[p] = true;
      made.is_on[p] = is_on(p, 0) && is_on(p, 1) && crossings.erase(numbers[p]) > 0;
    }
  }
  // And what lies between their threads: the middles of a grid's cells.
  std::vector<bool> between = made.is_woven;
  for (const Triangle& t : surface.triangles)
    if (made.is_woven[t[0]] || made.is_woven[t[1]] || made.is_woven[t[2]]) between[t[0]] = between[t[1]] = between[t[2]] = true;
  made.is_woven = std::move(between);
  return made;
}

}  // namespace weft::cooking
