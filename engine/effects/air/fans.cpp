// Fans: how wide the triangles are that the air meets at a particle.
#include "engine/effects/air/fans.h"

#include <algorithm>
#include <bit>

namespace weft {

namespace {

using Fan = std::vector<gpu::uvec2>;
using Ring = std::vector<std::uint32_t>;   // a particle's neighbours

constexpr float kTurned = 0.5f;    // the cosine of the angle by which the cloth may turn within a fan
constexpr float kSliver = 0.05f;   // the sine of the angle between the sides of a triangle that tells no normal

// A fan begins where no triangle comes before, or anywhere.
Fan fan_of(std::vector<AirCorner> corners) {
  Fan fan;
  while (!corners.empty()) {
    const auto follows_none = [&](const AirCorner& corner) { return std::ranges::find(corners, corner.from, &AirCorner::to) == corners.end(); };
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

Ring ring_of(const std::vector<AirCorner>& corners) {
  Ring ring;
  for (const AirCorner& corner : corners) ring.insert(ring.end(), {corner.from, corner.to});
  std::ranges::sort(ring);
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return ring;
}

struct Sheet {
  const std::vector<Vec3>& places;
  const std::vector<Ring>& rings;

  // The particle `reach` away from i or the next beyond, along the cloth, the way that its neighbour j lies: step by step the one that lies nearest to
  // that way, until the cloth ends or turns.
  std::uint32_t walk(std::uint32_t i, std::uint32_t j, float reach) const {
    Vec3 step = places[j] - places[i];
    const float first = length(step);
    if (!(first > 0)) return j;
    const Vec3 way = (1 / first) * step;
    for (float far = first; far < reach; far += length(step)) {
      float best = kTurned;
      std::uint32_t next = j;
      for (const std::uint32_t k : rings[j]) {
        const Vec3 on = places[k] - places[j], off = places[k] - places[i];
        if (dot(on, way) <= kTurned * length(on)) continue;
        const float cosine = dot(off, way) / length(off);
        if (cosine > best) best = cosine, next = k;
      }
      if (next == j) break;
      step = places[next] - places[j];
      j = next;
    }
    return j;
  }

  // Whether every triangle of the fan still looks where that between the neighbours does.
  bool looks_alike(std::uint32_t i, const Fan& wide, const Fan& narrow) const {
    for (std::size_t k = 1; k < wide.size(); ++k) {
      if (wide[k].y == 0) continue;
      const auto across = [&](const Fan& fan) { return cross(places[fan[k - 1].x] - places[i], places[fan[k].x] - places[i]); };
      const Vec3 w = across(wide), n = across(narrow);
      const float sides = length(places[wide[k - 1].x] - places[i]) * length(places[wide[k].x] - places[i]);
      if (!(dot(w, n) > kTurned * length(w) * length(n)) || !(length(w) > kSliver * sides)) return false;
    }
    return true;
  }

  // Half as wide as long as it has to be.
  Fan widened(std::uint32_t i, const Fan& narrow, float reach) const {
    float longest = 0;
    for (const gpu::uvec2& end : narrow) longest = std::max(longest, length(places[end.x] - places[i]));
    for (; reach > longest; reach /= 2) {
      Fan wide = narrow;
      for (gpu::uvec2& end : wide) end.x = walk(i, end.x, reach);
      if (looks_alike(i, wide, narrow)) return wide;
    }
    return narrow;
  }
};

}  // namespace

std::vector<std::vector<gpu::uvec2>> fans_of(const AirSurface& surface) {
  std::vector<Ring> rings;
  for (const std::vector<AirCorner>& corners : surface.corners) rings.push_back(ring_of(corners));
  const Sheet sheet{surface.places, rings};
  std::vector<Fan> fans;
  for (std::uint32_t i = 0; i < surface.corners.size(); ++i) fans.push_back(sheet.widened(i, fan_of(surface.corners[i]), surface.reaches[i]));
  return fans;
}

}  // namespace weft
