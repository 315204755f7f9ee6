// The triangles around a point, from one to the next.
#include <algorithm>
#include <map>

#include "engine/effects/tear/tear.h"

namespace weft::cooking {

Fans::Fans(const Mesh& mesh) : mesh_(mesh), first_(mesh.points.size() + 1), corners_(3 * mesh.triangles.size()) {
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t p : triangle) ++first_[p + 1];
  for (std::size_t p = 0; p < mesh.points.size(); ++p) first_[p + 1] += first_[p];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t corner = 0; corner < corners_.size(); ++corner) corners_[next[mesh.triangles[corner / 3][corner % 3]]++] = corner;
}

std::vector<Fan> Fans::of(std::uint32_t point) const {
  const auto around = std::span(corners_).subspan(first_[point], first_[point + 1] - first_[point]);
  const auto from = [&](std::uint32_t corner) { return mesh_.triangles[corner / 3][(corner % 3 + 1) % 3]; };
  const auto to = [&](std::uint32_t corner) { return mesh_.triangles[corner / 3][(corner % 3 + 2) % 3]; };
  std::map<std::uint32_t, std::uint32_t> leaving;   // the triangle that begins at a point of the rim
  std::map<std::uint32_t, std::uint32_t> arriving;
  for (const std::uint32_t corner : around) leaving.emplace(from(corner), corner), arriving.emplace(to(corner), corner);
  std::vector<Fan> fans;
  std::vector<std::uint32_t> left(around.begin(), around.end());
  const auto take = [&](std::uint32_t corner) {
    const auto at = std::ranges::find(left, corner);
    if (at == left.end()) return false;
    left.erase(at);
    return true;
  };
  while (!left.empty()) {
    // One that nothing arrives at begins an open fan; else all that are left are closed.
    const auto open = std::ranges::find_if(left, [&](std::uint32_t corner) { return !arriving.contains(from(corner)); });
    std::uint32_t corner = open == left.end() ? left.front() : *open;
    Fan& fan = fans.emplace_back();
    while (take(corner)) {
      fan.corners.push_back(corner);
      fan.rim.push_back(from(corner));
      const auto next = leaving.find(to(corner));
      if (next == leaving.end()) break;
      corner = next->second;
    }
    if (to(fan.corners.back()) != fan.rim.front()) fan.rim.push_back(to(fan.corners.back()));
  }
  return fans;
}

}  // namespace weft::cooking
