// Anchors: which points of a cloth are held, and where they are at a time.
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numbers>

#include "engine/cook/parts.h"

namespace weft {
namespace cooking {
namespace {

// Render vertices of the mesh's points, the first of each: points are chosen through what the author sees.
std::vector<std::uint32_t> vertex_of_point(const Mesh& mesh) {
  std::vector<std::uint32_t> vertex(mesh.points.size(), kNone);
  for (std::uint32_t v = 0; v < mesh.point_of.size(); ++v)
    if (vertex[mesh.point_of[v]] == kNone) vertex[mesh.point_of[v]] = v;
  return vertex;
}

bool inside(const Anchor::Box& box, Vec3 p) {
  return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y && p.z >= box.low.z && p.z <= box.high.z;
}

// Every n-th of the points along the longest side of their bounding box, and the last.
void thin_out(const Mesh& mesh, std::vector<std::uint32_t>& points, std::uint32_t every) {
  if (every <= 1 || points.size() < 2) return;
  Eigen::AlignedBox3d box;
  for (const std::uint32_t p : points) box.extend(vector(mesh.points[p]));
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  std::sort(points.begin(), points.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(vector(mesh.points[a])[axis], a) < std::pair(vector(mesh.points[b])[axis], b);
  });
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < points.size(); i += every) kept.push_back(points[i]);
  if (kept.back() != points.back()) kept.push_back(points.back());
  points = std::move(kept);
}

Result<std::vector<std::uint32_t>> chosen_points(const Cloth& cloth, const Anchor& anchor, const Mesh& mesh) {
  std::vector<std::uint32_t> points;
  for (const std::uint32_t v : anchor.vertices) {
    if (v >= mesh.point_of_source.size())
      return fail("vertex ", v, " is not below the mesh's ", mesh.point_of_source.size(), " vertices");
    if (mesh.point_of_source[v] == kNone) return fail("vertex ", v, " belongs to no triangle, or to dropped ones, and is not simulated");
    points.push_back(mesh.point_of_source[v]);
  }
  for (const Corner corner : anchor.corners) {
    if (!cloth.grid) return fail("corners belong to grids; choose a mesh's vertices by number, `top` or `box`");
    const std::uint32_t nx = cloth.grid->cells_x, ny = cloth.grid->cells_y;
    const bool high_x = corner == Corner::high_low || corner == Corner::high_high;
    const bool high_y = corner == Corner::low_high || corner == Corner::high_high;
    points.push_back(mesh.point_of[(high_y ? ny : 0) * (nx + 1) + (high_x ? nx : 0)]);
  }
  if (anchor.top || anchor.box) {
    float highest = -INFINITY;
    for (const Vec3 p : mesh.points) highest = std::max(highest, p.y);
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      const bool at_top = anchor.top && mesh.points[p].y >= highest - *anchor.top;
      if (at_top || (anchor.box && inside(*anchor.box, mesh.points[p]))) points.push_back(p);
    }
  }
  const auto map = mapped("map", anchor.map, mesh);
  if (!map) return map.why();
  for (std::uint32_t p = 0; p < map->size(); ++p)
    if ((*map)[p] >= 0.5f) points.push_back(p);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.empty()) return fail("it chooses none of the ", mesh.points.size(), " points");
  thin_out(mesh, points, anchor.every);
  return points;
}

}  // namespace

Result<std::vector<AnchorChoice>> choose_anchors(const Cloth& cloth, const Mesh& mesh) {
  const std::vector<std::uint32_t> vertices = vertex_of_point(mesh);
  std::map<std::uint32_t, std::uint32_t> entry_of;   // a point that two entries choose belongs to the later one
  for (std::uint32_t entry = 0; entry < cloth.anchors.size(); ++entry) {
    auto points = chosen_points(cloth, cloth.anchors[entry], mesh);
    if (!points) return fail("anchors[", entry, "]: ", points.why());
    for (const std::uint32_t p : *points) entry_of[p] = entry;
  }
  std::vector<AnchorChoice> choices;
  for (const auto& [point, entry] : entry_of) choices.push_back({entry, point, vertices[point]});
  return choices;
}

}  // namespace cooking

std::vector<Vec3> anchor_targets(const Scene& scene, const CookedFabric& fabric, double time) {
  // An entry's keys rotate its points about their centre.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<Eigen::Vector3d, int>> centres;
  for (const AnchorTarget& anchor : fabric.anchors) {
    auto& [sum, count] = centres.try_emplace({anchor.cloth, anchor.entry}, Eigen::Vector3d::Zero(), 0).first->second;
    sum += cooking::vector(anchor.rest);
    ++count;
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<Key, Eigen::Matrix3d>> poses;
  for (const auto& [which, centre] : centres) {
    const Key key = pose_at(scene.cloths[which.first].anchors[which.second].keys, time);
    const Eigen::AngleAxisd turn(key.degrees * std::numbers::pi / 180, cooking::vector(key.axis));
    poses.emplace(which, std::pair(key, turn.toRotationMatrix()));
  }
  std::vector<Vec3> targets;
  targets.reserve(fabric.anchors.size());
  for (const AnchorTarget& anchor : fabric.anchors) {
    if (scene.cloths[anchor.cloth].anchors[anchor.entry].keys.empty()) {
      targets.push_back(anchor.rest);
      continue;
    }
    const auto& [key, turn] = poses.at({anchor.cloth, anchor.entry});
    const auto& [sum, count] = centres.at({anchor.cloth, anchor.entry});
    const Eigen::Vector3d centre = sum / count;
    const Eigen::Vector3d p = centre + turn * (cooking::vector(anchor.rest) - centre) + cooking::vector(key.translate);
    targets.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
  return targets;
}

}  // namespace weft
