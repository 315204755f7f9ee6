// Fans: how wide the triangles are that the air meets at a particle.
//
// Over a wave of cloth the air has a pressure that grows with the wave's length (potential flow), so that short waves lean into the wind but
// little. Were the force that of each small triangle by itself, the shortest waves that a mesh has would grow fastest, and a flag would
// flap the more often the finer it is. So normals are those of triangles of a given size, whatever the mesh is: a fifth of the square root
// of the area of the piece of cloth. Flags then have waves as long as they were measured to have: 1.87 times the flag (Raynaud and
// Mulleners, "On the wake and flapping dynamics of different aspect ratio flags", 2026), on grids whose diagonals rise along the wind; on
// others they flap a third faster (engine/README.md, "Air").
#include "engine/effects/air/fans.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

namespace weft {

namespace {

using Fan = std::vector<gpu::uvec2>;

constexpr double kReach = 0.2;     // of the square root of the area
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

  // As wide as the reach, or half, a quarter and so on of that where the cloth bends too much.
  Fan widened(std::uint32_t i, const Fan& narrow, float reach) const {
    float longest = 0;
    for (const gpu::uvec2& end : narrow) longest = std::max(longest, length(places_[end.x] - places_[i]));
    for (; reach > longest; reach /= 2) {
      Fan wide = narrow;
      for (gpu::uvec2& end : wide) end.x = walk(i, end.x, reach);
      if (looks_alike(i, wide, narrow)) return wide;
    }
    return narrow;
  }

 private:
  static constexpr std::size_t kMostDoublings = 12;

  template <class Visit>
  void for_each_way(const Visit& visit) const {
    for (std::uint32_t i = 0; i + 1 < rings_.first.size(); ++i)
      for (std::size_t k = rings_.first[i]; k < rings_.first[i + 1]; ++k) visit(i, k);
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

  // The particle about `reach` away from i along the cloth, the way that its neighbour j lies: step by step the one nearest to that way, until
  // the cloth ends or turns. Of the last step some particles take the end and some the beginning, so that they reach as far in the mean.
  std::uint32_t walk(std::uint32_t i, std::uint32_t j, float reach) const {
    const Vec3 edge = places_[j] - places_[i];
    float far = length(edge);
    if (!(far > 0)) return j;
    const Vec3 way = (1 / far) * edge;
    for (std::size_t level = ends_.size(); level-- > 0;) {
      const float part = level == 0 ? dither(i) : 1;   // of a step that must fit
      for (;;) {
        const std::uint32_t next = ahead(i, j, way, level);
        const float step = length(places_[next] - places_[j]);
        if (next == j || !(far + part * step < reach)) break;
        far += step;
        j = next;
      }
    }
    return j;
  }

  // Whether every triangle of the fan still looks where that between the neighbours does.
  bool looks_alike(std::uint32_t i, const Fan& wide, const Fan& narrow) const {
    for (std::size_t k = 1; k < wide.size(); ++k) {
      if (wide[k].y == 0) continue;
      const auto across = [&](const Fan& fan) { return cross(places_[fan[k - 1].x] - places_[i], places_[fan[k].x] - places_[i]); };
      const Vec3 w = across(wide), n = across(narrow);
      const float sides = length(places_[wide[k - 1].x] - places_[i]) * length(places_[wide[k].x] - places_[i]);
      if (!(dot(w, n) > kTurned * length(w) * length(n)) || !(length(w) > kSliver * sides)) return false;
    }
    return true;
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
  for (std::uint32_t i = 0; i < reaches.size(); ++i) fans.push_back(sheet.widened(i, fan_of(surface.corners[i]), reaches[i]));
  return fans;
}

}  // namespace weft
