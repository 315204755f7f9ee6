// Normals, texture coordinates and tangents for vertices that came without, and the transform of all of them.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "engine/mesh/parts.h"

namespace weft {

using Eigen::Vector2d;
using Eigen::Vector3d;
using parts::narrow;
using parts::wide;

std::vector<Vec3> smooth_normals(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<Vector3d> sums(positions.size(), Vector3d::Zero());
  for (const Triangle& t : triangles) {
    const Vector3d p[3] = {wide(positions[t[0]]), wide(positions[t[1]]), wide(positions[t[2]])};
    const Vector3d area = (p[1] - p[0]).cross(p[2] - p[0]);
    const double doubled = area.norm();
    if (!(doubled > 0)) continue;
    for (int k = 0; k < 3; ++k) {
      const double cosine_part = (p[(k + 1) % 3] - p[k]).dot(p[(k + 2) % 3] - p[k]);
      sums[t[k]] += std::atan2(doubled, cosine_part) / doubled * area;
    }
  }
  std::vector<Vec3> normals(positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = sums[i].norm();
    normals[i] = length > 1e-12 ? narrow(sums[i] / length) : Vec3{0, 1, 0};   // angles sum to radians: 1e-12 is opposite faces
  }
  return normals;
}

namespace parts {
namespace {

/// A unit vector at right angles to a unit vector; always the same one.
Vector3d any_perpendicular(const Vector3d& normal) {
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  return normal.cross(Vector3d::Unit(least)).normalized();
}

}   // namespace

void complete_normals(RenderMesh& render, std::span<const std::uint32_t> point_of, std::span<const Vec3> points,
                      std::span<const Triangle> triangles) {
  render.normals.resize(render.positions.size(), Vec3{});
  std::vector<Vec3> smooth;
  for (std::size_t v = 0; v < render.normals.size(); ++v) {
    Vec3& normal = render.normals[v];
    const double length = wide(normal).norm();
    if (finite(normal) && length > 0) {
      normal = narrow(wide(normal) / length);
      continue;
    }
    if (smooth.empty()) smooth = smooth_normals(points, triangles);
    normal = smooth[point_of[v]];
  }
}

void complete_uvs(RenderMesh& render) {
  const float missing = std::numeric_limits<float>::quiet_NaN();
  render.uvs.resize(render.positions.size(), Vec2{missing, missing});
  if (std::all_of(render.uvs.begin(), render.uvs.end(), [](Vec2 uv) { return finite(uv); })) return;

  Vector3d low = wide(render.positions.front()), high = low;
  for (const Vec3& p : render.positions) {
    low = low.cwiseMin(wide(p));
    high = high.cwiseMax(wide(p));
  }
  // The shortest axis is looked along; of two equally short ones the later, so a cube is seen from +z.
  const Vector3d extent = high - low;
  int along = 2;
  for (const int axis : {1, 0})
    if (extent[axis] < extent[along]) along = axis;
  const int across = along == 0 ? 2 : 0, up = along == 1 ? 2 : 1;
  const double scale = 1 / extent.maxCoeff();
  for (std::size_t v = 0; v < render.uvs.size(); ++v) {
    if (finite(render.uvs[v])) continue;
    const Vector3d p = wide(render.positions[v]);
    const double u = (p[across] - low[across]) * scale;
    const double t = (p[up] - low[up]) * scale;
    // Seen from above the top of the picture is -z, seen from the front or the side it is +y; as on a grid.
    render.uvs[v] = {static_cast<float>(u), static_cast<float>(along == 1 ? t : extent[up] * scale - t)};
  }
}

// Based on: Eric Lengyel, "Computing tangent space basis vectors for an arbitrary mesh" (2001); summed with the sign of the
// UV area instead of its inverse, so that a sliver in the picture does not outweigh its neighbours.
void complete_tangents(RenderMesh& render) {
  const auto given = [](Vec4 t) {
    return std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z) && (t.w == 1 || t.w == -1) && (t.x != 0 || t.y != 0 || t.z != 0);
  };
  render.tangents.resize(render.positions.size(), Vec4{});
  std::vector<Vector3d> rightward, upward;
  if (!std::all_of(render.tangents.begin(), render.tangents.end(), given)) {
    rightward.assign(render.positions.size(), Vector3d::Zero());
    upward.assign(render.positions.size(), Vector3d::Zero());
    for (const Triangle& t : render.triangles) {
      const Vector3d origin = wide(render.positions[t[0]]);
      const Vector3d e1 = wide(render.positions[t[1]]) - origin, e2 = wide(render.positions[t[2]]) - origin;
      const Vec2 o = render.uvs[t[0]], p = render.uvs[t[1]], q = render.uvs[t[2]];
      const Vector2d d1(double(p.x) - o.x, double(o.y) - p.y), d2(double(q.x) - o.x, double(o.y) - q.y);   // v turned to point up
      const double area = d1.x() * d2.y() - d2.x() * d1.y();
      if (area == 0) continue;
      const double sign = area > 0 ? 1 : -1;
      const Vector3d right = sign * (d2.y() * e1 - d1.y() * e2), up = sign * (d1.x() * e2 - d2.x() * e1);
      for (const std::uint32_t v : t) {
        rightward[v] += right;
        upward[v] += up;
      }
    }
  }
  for (std::size_t v = 0; v < render.tangents.size(); ++v) {
    const Vec4 file = render.tangents[v];
    const bool keep = given(file);
    const Vector3d normal = wide(render.normals[v]);
    const Vector3d raw = keep ? Vector3d(file.x, file.y, file.z) : rightward[v];
    Vector3d tangent = raw - normal * normal.dot(raw);
    tangent = tangent.norm() > 1e-6 * raw.norm() ? tangent.normalized() : any_perpendicular(normal);
    const double w = keep ? file.w : normal.cross(tangent).dot(upward[v]) < 0 ? -1 : 1;
    render.tangents[v] = {static_cast<float>(tangent.x()), static_cast<float>(tangent.y()), static_cast<float>(tangent.z()),
                          static_cast<float>(w)};
  }
}

}   // namespace parts

void transform_mesh(Mesh& mesh, const Transform& transform) {
  assert(transform.scale > 0);
  const Vector3d axis = wide(transform.axis).normalized();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(transform.degrees * std::numbers::pi / 180, axis).toRotationMatrix();
  const Vector3d shift = wide(transform.translate);
  const auto move = [&](Vec3& p) { p = narrow(turn * (transform.scale * wide(p)) + shift); };
  for (Vec3& p : mesh.points) move(p);
  for (Vec3& p : mesh.render.positions) move(p);
  for (Vec3& p : mesh.loose) move(p);
  for (Vec3& n : mesh.render.normals) n = narrow((turn * wide(n)).normalized());
  for (Vec4& t : mesh.render.tangents) {
    const Vec3 moved = narrow((turn * Vector3d(t.x, t.y, t.z)).normalized());
    t = {moved.x, moved.y, moved.z, t.w};
  }
  if (mesh.skin) {
    for (Skin::Morph& morph : mesh.skin->morphs) {
      for (Vec3& d : morph.deltas) d = narrow(turn * (transform.scale * wide(d)));
      for (Vec3& d : morph.normal_deltas) d = narrow(turn * wide(d));
    }
    mesh.skin->place = narrow(Eigen::Affine3d(Eigen::Translation3d(shift) * Eigen::Affine3d(turn) * Eigen::Scaling(transform.scale)) *
                              wide(mesh.skin->place));
  }
  mesh.weld_tolerance *= transform.scale;
}

}   // namespace weft
