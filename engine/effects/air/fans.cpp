// Fans: how wide the triangles are that the air meets at a particle.
//
// Over a wave of cloth the air has a pressure that grows with the wave's length (potential flow), so that short waves lean into the wind but
// little. Were the force that of each small triangle by itself, the shortest waves that a mesh has would grow fastest, and a flag would
// flap the more often the finer it is. So normals are those of triangles of a given size, whatever the mesh is: a quarter of the square root
// of the area of the piece of cloth. They go six even ways, whatever ways the mesh's edges go, and each particle's ways are turned by another
// angle, so that no direction of the wind is singled out.
//
// Round a border the air escapes: there the triangles reach no farther than the border is away, so that they lie evenly about the particle
// (a normal from one side alone is that of a place farther in, and comes too early or too late), but a quarter of the whole reach at least.
//
// Flags then have waves as long as they were measured to have: 1.87 times the flag (Raynaud and Mulleners, "On the wake and flapping
// dynamics of different aspect ratio flags", 2026).
#include "engine/effects/air/fans.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <span>
#include <utility>

namespace weft {

namespace {

using Fan = std::vector<gpu::uvec2>;

constexpr double kReach = 0.25;    // of the square root of the area
constexpr float kLeast = 0.25f;    // of that, at a border
constexpr int kWays = 6;           // of a whole turn
constexpr float kTurned = 0.5f;    // the cosine of the angle by which the cloth may turn within a fan
constexpr float kSliver = 0.05f;   // the sine of the angle between the sides of a triangle that tells no normal

// A fan begins where no triangle comes before, or anywhere.
Fan fan_of(std::vector<AirCorner> corners) {
  Fan fan;
  while (!corners.empty()) {
    const auto follows_none = [&](const AirCorner& corner) {
      return std::ranges::find(corners, corner.from, &AirCorner::to) == corners.end();
    };
    auto next = std::ranges::find_if(corners, follows_none);
    if (next == corners.end()) next = corners.begin();
    fan.push_back({next->from, 0});
    while (next != corners.end()) {
      const std::uint32_t to = next->to;
      fan.push_back({to, std::bit_cast<std::uint32_t>(next->third)});
      corners.erase(next);
      next = std::ranges::find(corners, to, &AirCorner::from);
    }
  }
  return fan;
}

// Every particle's neighbours, one list after another.
struct Rings {
  std::vector<std::size_t> first;      // of each particle, and the end
  std::vector<std::uint32_t> ends;
  std::span<const std::uint32_t> of(std::uint32_t i) const { return std::span(ends).subspan(first[i], first[i + 1] - first[i]); }
};

Rings rings_of(const std::vector<std::vector<AirCorner>>& corners) {
  Rings rings{{0}, {}};
  std::vector<std::uint32_t> ring;
  for (const std::vector<AirCorner>& own : corners) {
    ring.clear();
    for (const AirCorner& corner : own) ring.insert(ring.end(), {corner.from, corner.to});
    std::ranges::sort(ring);
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    rings.ends.insert(rings.ends.end(), ring.begin(), ring.end());
    rings.first.push_back(rings.ends.size());
  }
  return rings;
}

// m, for each particle: by the area of what hangs together with it.
std::vector<float> reaches_of(const std::vector<std::vector<AirCorner>>& corners, const Rings& rings) {
  std::vector<float> reaches(corners.size());
  std::vector<bool> is_seen(corners.size());
  for (std::uint32_t seed = 0; seed < corners.size(); ++seed) {
    if (is_seen[seed]) continue;
    is_seen[seed] = true;
    std::vector<std::uint32_t> piece{seed};
    double area = 0;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      for (const AirCorner& corner : corners[piece[k]]) area += double(corner.third);
      for (const std::uint32_t next : rings.of(piece[k]))
        if (!is_seen[next]) is_seen[next] = true, piece.push_back(next);
    }
    for (const std::uint32_t i : piece) reaches[i] = static_cast<float>(kReach * std::sqrt(area));
  }
  return reaches;
}

// m, of each particle to the nearest one of a border, straight: the same border particle is the nearest to a neighbour, or another's is.
std::vector<float> ways_to_border(const std::vector<Vec3>& places, const Rings& rings, const std::vector<Fan>& fans) {
  struct Reached {
    float far;
    std::uint32_t particle, from;
    bool operator>(const Reached& other) const { return std::pair(far, particle) > std::pair(other.far, other.particle); }
  };
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  for (std::uint32_t i = 0; i < fans.size(); ++i)
    if (!fans[i].empty() && fans[i].front().x != fans[i].back().x) next.push({0, i, i});
  std::vector<float> far(places.size(), std::numeric_limits<float>::infinity());
  while (!next.empty()) {
    const Reached nearest = next.top();
    next.pop();
    if (nearest.far >= far[nearest.particle]) continue;
    far[nearest.particle] = nearest.far;
    for (const std::uint32_t j : rings.of(nearest.particle))
      if (const float d = length(places[j] - places[nearest.from]); d < far[j]) next.push({d, j, nearest.from});
  }
  return far;
}

// A number from 0 to 1 for particle i, evenly spread also over neighbours (multiples of the golden ratio, modulo 1).
float dither(std::uint32_t i) { return static_cast<float>(std::fmod(0.6180339887498949 * i, 1.0)); }

class Sheet {
 public:
  // `longest`: of the reaches (m).
  Sheet(const std::vector<Vec3>& places, const Rings& rings, float longest) : places_(places), rings_(rings), ends_{rings.ends} {
    double edges = 0;
    for_each_way([&](std::uint32_t i, std::size_t k) { edges += double(length(places[rings.ends[k]] - places[i])); });
    const double mean = edges / double(std::max<std::size_t>(rings.ends.size(), 1));
    for (double step = 2 * mean; step < double(longest) && ends_.size() < kMostDoublings; step *= 2) double_steps();
  }

  // As wide as the reach, or half, a quarter and so on of that where the cloth bends too much; `border`: how far away it is (m).
  Fan widened(std::uint32_t i, const Fan& narrow, float reach, float border) const {
    const Round round = round_of(i, narrow);
    if (round.angles.empty()) return narrow;
    for (; reach > round.longest; reach /= 2) {
      const Fan wide = even(i, narrow, round, std::max(std::clamp(border, kLeast * reach, reach), round.longest));
      if (!wide.empty()) return wide;
    }
    return narrow;
  }

 private:
  static constexpr std::size_t kMostDoublings = 12;

  // How the neighbours of a fan lie about its particle.
  struct Round {
    std::vector<float> angles;   // rad, from the first; none if that cannot be told, or if there are several fans
    float longest = 0;           // m, of the edges
    float area = 0;              // m^2
  };
  struct Way {
    Vec3 way;             // unit
    std::size_t corner;   // of the narrow fan: that with the end before
    float part;           // of the way to the end from the one before
  };

  template <class Visit>
  void for_each_way(const Visit& visit) const {
    for (std::uint32_t i = 0; i + 1 < rings_.first.size(); ++i)
      for (std::size_t k = rings_.first[i]; k < rings_.first[i + 1]; ++k) visit(i, k);
  }

  Vec3 unit(std::uint32_t i, std::uint32_t j) const {
    const Vec3 edge = places_[j] - places_[i];
    return (1 / length(edge)) * edge;
  }

  Round round_of(std::uint32_t i, const Fan& narrow) const {
    Round round;
    for (std::size_t k = 0; k < narrow.size(); ++k) {
      const float far = length(places_[narrow[k].x] - places_[i]);
      if (!(far > 0) || (k > 0) != (narrow[k].y != 0)) return {};
      round.longest = std::max(round.longest, far);
      const float cosine = k > 0 ? dot(unit(i, narrow[k - 1].x), unit(i, narrow[k].x)) : 1;
      round.angles.push_back((k > 0 ? round.angles.back() : 0) + std::acos(std::clamp(cosine, -1.f, 1.f)));
      round.area += std::bit_cast<float>(narrow[k].y);
    }
    if (!(round.area > 0) || !(round.angles.back() > 0)) return {};
    return round;
  }

  Way way_at(std::uint32_t i, const Fan& narrow, const Round& round, float angle) const {
    std::size_t k = 1;
    while (k + 1 < narrow.size() && round.angles[k] < angle) ++k;
    const float from = round.angles[k - 1], whole = round.angles[k] - from;
    const float part = whole > 0 ? std::clamp((angle - from) / whole, 0.f, 1.f) : 0;
    const Vec3 a = unit(i, narrow[k - 1].x), between = a + part * (unit(i, narrow[k].x) - a);
    const float size = length(between);
    return {size > 0 ? (1 / size) * between : a, k, part};
  }

  // A fan of triangles that go even ways; they share the area as large as they are. None where one does not look the way in which the cloth
  // does between the neighbours.
  Fan even(std::uint32_t i, const Fan& narrow, const Round& round, float reach) const {
    const bool is_closed = narrow.front().x == narrow.back().x;
    const float whole = round.angles.back();
    const int count = is_closed ? kWays : std::max(1, static_cast<int>(std::lround(double(whole) * kWays / (2 * std::numbers::pi))));
    const float turn = is_closed ? whole / float(count) * dither(i) : 0;
    Fan wide;
    std::vector<float> sizes(1, 0.f);
    float all = 0;
    for (int k = 0; k <= count; ++k) {
      const auto at = [&](float way) {
        const float angle = turn + whole * way / float(count);
        return way_at(i, narrow, round, is_closed ? std::fmod(angle, whole) : angle);
      };
      wide.push_back({is_closed && k == count ? wide.front().x : walk(i, narrow, at(float(k)), reach), 0});
      if (k == 0) continue;
      const Vec3 a = places_[wide[k - 1].x] - places_[i], b = places_[wide[k].x] - places_[i], across = cross(a, b);
      const std::size_t corner = at(float(k) - 0.5f).corner;
      const Vec3 here = cross(places_[narrow[corner - 1].x] - places_[i], places_[narrow[corner].x] - places_[i]);
      const float size = length(across), least = kSliver * length(a) * length(b);
      if (size > least && !(dot(across, here) > kTurned * size * length(here))) return {};
      sizes.push_back(size > least ? size : 0);
      all += sizes.back();
    }
    if (!(all > 0)) return {};
    for (std::size_t k = 1; k < wide.size(); ++k) wide[k].y = std::bit_cast<std::uint32_t>(round.area * sizes[k] / all);
    return wide;
  }

  // Of the particles 2^level edges from p on, that which lies nearest to a way (unit) from i; p where none lies ahead.
  std::uint32_t ahead(std::uint32_t i, std::uint32_t p, Vec3 way, std::size_t level) const {
    float best = kTurned;
    std::uint32_t next = p;
    for (std::size_t k = rings_.first[p]; k < rings_.first[p + 1]; ++k) {
      const std::uint32_t q = ends_[level][k];
      const Vec3 on = places_[q] - places_[p], off = places_[q] - places_[i];
      if (!(dot(on, way) > kTurned * length(on))) continue;
      const float cosine = dot(off, way) / length(off);
      if (cosine > best) best = cosine, next = q;
    }
    return next;
  }

  // Two steps of the last level are one of the next, so that a walk takes as many steps as its length has binary digits.
  void double_steps() {
    const std::size_t level = ends_.size() - 1;
    std::vector<std::uint32_t> twice(rings_.ends.size());
    for_each_way([&](std::uint32_t i, std::size_t k) {
      const Vec3 edge = places_[rings_.ends[k]] - places_[i];
      const float far = length(edge);
      twice[k] = far > 0 ? ahead(i, ends_[level][k], (1 / far) * edge, level) : ends_[level][k];
    });
    ends_.push_back(std::move(twice));
  }

  // The particle about `reach` away from i along the cloth: from the neighbour that is nearest to the way on, step by step to that which is
  // nearest to it, until the cloth ends or turns. A long step may lead off the way, and needs room for those that lead back.
  std::uint32_t walk(std::uint32_t i, const Fan& narrow, const Way& to, float reach) const {
    std::uint32_t j = narrow[to.part < 0.5f ? to.corner - 1 : to.corner].x;
    float far = dot(places_[j] - places_[i], to.way);
    for (std::size_t level = ends_.size(); level-- > 0;) {
      const float room = level == 0 ? 0.5f : 4;   // in steps
      for (;;) {
        const std::uint32_t next = ahead(i, j, to.way, level);
        const float step = dot(places_[next] - places_[j], to.way);
        if (next == j || !(far + room * step < reach)) break;
        far += step;
        j = next;
      }
    }
    return j;
  }

  const std::vector<Vec3>& places_;
  const Rings& rings_;
  std::vector<std::vector<std::uint32_t>> ends_;   // of each level and way; the first are the neighbours
};

}  // namespace

std::vector<std::vector<gpu::uvec2>> fans_of(const AirSurface& surface) {
  const Rings rings = rings_of(surface.corners);
  const std::vector<float> reaches = reaches_of(surface.corners, rings);
  const Sheet sheet(surface.places, rings, reaches.empty() ? 0 : std::ranges::max(reaches));
  std::vector<Fan> fans;
  for (const std::vector<AirCorner>& corners : surface.corners) fans.push_back(fan_of(corners));
  const std::vector<float> borders = ways_to_border(surface.places, rings, fans);
  for (std::uint32_t i = 0; i < reaches.size(); ++i) fans[i] = sheet.widened(i, fans[i], reaches[i], borders[i]);
  return fans;
}

}  // namespace weft
