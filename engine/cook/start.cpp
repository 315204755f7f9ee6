// Starting poses of cloths that do not start at rest: stretched, folded, thrown, or so far from rest that only a robust
// solver recovers. Everything else is cooked from the rest pose: a start changes positions and velocities, and nothing about
// the cloth.
//
// Poses are described along the axes of the rest pose's bounding box, the longest first. A fold bends that side round an arc:
//
//        __________            half the angle to either side of the middle; a radius of 0 is an edge
//       (__________
//
// A mesh that is not flat turns with it: particles keep their distance from the plane through the particle nearest to the middle.
//
// Cloth that is compressed buckles, but only out of a pose that is not exactly flat: on the plane every force lies in the plane, an
// equilibrium however unstable. So particles begin a fraction of the thickness off their places, as those of a real cloth do (a geometric
// imperfection, Koiter 1945). Across the cloth, where lengths change by its square alone: 40 um on links of 1 cm strain by 8e-6.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

using Eigen::Vector3d;

constexpr double kMostStretch = 0.3;
constexpr double kSteepest = 0.005;   // of an edge: steeper, an imperfection would show in the shading of a fine mesh

struct Box {
  Vector3d centre, half;
  std::array<int, 3> axes;   // by extent, the longest first; of equal ones the lower index first
};

Box box_of(std::span<const gpu::vec4> positions) {
  Vector3d low = Vector3d::Constant(INFINITY), high = -low;
  for (const gpu::vec4& p : positions) {
    low = low.cwiseMin(Vector3d(p.x, p.y, p.z));
    high = high.cwiseMax(Vector3d(p.x, p.y, p.z));
  }
  Box box{(low + high) / 2, (high - low) / 2, {0, 1, 2}};
  std::stable_sort(box.axes.begin(), box.axes.end(), [&](int a, int b) { return box.half[a] > box.half[b]; });
  return box;
}

// Uniform in -1 ... 1. The words of std::mt19937 are the same in every standard library, its distributions are not.
double random_part(std::mt19937& words) { return 2 * (words() / 4294967296.0) - 1; }

// The height of the particle nearest to the middle of the longest side.
double height_of_fold(std::span<const gpu::vec4> positions, const Box& box) {
  double nearest = INFINITY, height = 0;
  for (const gpu::vec4& p : positions) {
    const Vector3d place = Vector3d(p.x, p.y, p.z) - box.centre;
    if (std::abs(place[box.axes[0]]) < nearest) nearest = std::abs(place[box.axes[0]]), height = place[box.axes[2]];
  }
  return height;
}

Vector3d folded(Vector3d place, double fold, const Box& box, const Start& start) {
  const int along = box.axes[0], up = box.axes[2];
  const double turn = start.degrees * std::numbers::pi / 180 / 2, arc = start.radius * std::abs(turn);   // of one half
  const double s = place[along], bent = std::min(std::abs(s), arc), side = s < 0 ? -1 : 1;
  const double angle = arc > 0 ? std::abs(turn) * bent / arc : std::abs(turn), straight = std::abs(s) - bent, sign = turn < 0 ? -1 : 1;
  const double off = place[up] - fold;
  place[along] = side * (start.radius * (arc > 0 ? std::sin(angle) : 0) + straight * std::cos(angle) - sign * off * std::sin(angle));
  place[up] = fold + sign * (start.radius * (arc > 0 ? 1 - std::cos(angle) : 0) + straight * std::sin(angle)) + off * std::cos(angle);
  return place;
}

// Of a cloth: unit normals of its particles, 0 where there is none, and the mean edge of its triangles (m).
struct Surface {
  std::vector<Vector3d> normals;
  double mean_edge = 0;
};

Surface surface_of(const ClothRange& range, const CookedFabric& fabric) {
  Surface surface{std::vector<Vector3d>(range.particles, Vector3d::Zero())};
  const auto at = [&](std::uint32_t i) { return Vector3d(fabric.positions[i].x, fabric.positions[i].y, fabric.positions[i].z); };
  // Triangles stand cloth after cloth.
  const auto from = [&](std::uint32_t particle) {
    return std::partition_point(fabric.triangles.begin(), fabric.triangles.end(), [&](const Triangle& t) { return t[0] < particle; });
  };
  const auto begin = from(range.first_particle), end = from(range.first_particle + range.particles);
  for (auto triangle = begin; triangle != end; ++triangle) {
    const auto& [a, b, c] = *triangle;
    const Vector3d across = (at(b) - at(a)).cross(at(c) - at(a));
    for (const std::uint32_t i : {a, b, c}) surface.normals[i - range.first_particle] += across;
    surface.mean_edge += ((at(b) - at(a)).norm() + (at(c) - at(b)).norm() + (at(a) - at(c)).norm()) / (3 * double(end - begin));
  }
  for (Vector3d& normal : surface.normals)
    if (const double size = normal.norm(); size > 0) normal /= size;
  return surface;
}

void add_imperfection(const Cloth& cloth, const ClothRange& range, CookedFabric& fabric) {
  if (cloth.start.imperfection == 0) return;
  const auto [normals, mean_edge] = surface_of(range, fabric);
  const double most = std::min(cloth.start.imperfection * cloth.fabric.thickness, kSteepest * mean_edge);
  std::mt19937 words(cloth.start.seed);
  for (std::uint32_t k = 0; k < range.particles; ++k) {
    gpu::vec4& p = fabric.positions[range.first_particle + k];
    const Vector3d off = most * random_part(words) * normals[k];
    if (p.w == 0) continue;   // anchors
    p = {static_cast<float>(p.x + off.x()), static_cast<float>(p.y + off.y()), static_cast<float>(p.z + off.z()), p.w};
  }
}

}  // namespace

void take_start(const Cloth& cloth, const ClothRange& range, CookedFabric& fabric) {
  const Start& start = cloth.start;
  add_imperfection(cloth, range, fabric);
  const std::span<gpu::vec4> positions = std::span(fabric.positions).subspan(range.first_particle, range.particles);
  const std::span<gpu::vec4> velocities = std::span(fabric.velocities).subspan(range.first_particle, range.particles);
  const Box box = box_of(positions);
  const int longest = box.axes[0];
  const double fold = height_of_fold(positions, box);
  std::mt19937 words(start.seed);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    gpu::vec4 &p = positions[i], &v = velocities[i];
    Vector3d place = Vector3d(p.x, p.y, p.z) - box.centre;
    switch (start.pose) {
      case StartPose::rest: break;
      case StartPose::stretched: {
        // Strain grows evenly from one end to the other: x + k (x + half)^2 / (4 half).
        const double from_end = place[longest] + box.half[longest];
        if (box.half[longest] > 0) place[longest] += kMostStretch * from_end * from_end / (4 * box.half[longest]);
        break;
      }
      case StartPose::folded: place = folded(place, fold, box, start); break;
      case StartPose::flattened: place[longest] = 0; break;
      case StartPose::scrambled:
        for (int axis = 0; axis < 3; ++axis) place[axis] = box.half[longest] * random_part(words);
        break;
      case StartPose::collapsed: place.setZero(); break;
    }
    if (p.w == 0) continue;   // anchors; after the draw, so that they do not change what others draw
    if (start.pose != StartPose::rest) {
      place += box.centre;
      p = {static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z()), p.w};
    }
    v = {start.velocity.x, start.velocity.y, start.velocity.z, v.w};
  }
}

}  // namespace weft::cooking
