// Which triangle of its cloth each vertex of a render mesh is bound to: the nearest at rest, at the nearest point of it.
#include "engine/effects/render_mesh/render_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <unsupported/Eigen/BVH>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"
#include "shaders/render_mesh/render_mesh.ref.h"

namespace weft::effects {
namespace {

using Eigen::Vector3d;
using cooking::vector;

constexpr const Buffer* kBuffers[] = {&buffers::carried};

constexpr Pass kPasses[] = {
    {.name = "render_mesh",
     .stage = Stage::frame_end,
     .threads = {[](const Cooked& s) { return std::uint64_t(s.fabric.own.of<RenderMeshLists>().carried.size()); }}},
};

using Corners = std::array<Vector3d, 3>;

// Of a point's nearest point of a triangle, by weights of the corners. Source: Ericson, Real-Time Collision Detection (2005), 5.1.5.
Vector3d nearest_weights(const Corners& t, const Vector3d& p) {
  const Vector3d ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (const double e = d4 - d3, f = d5 - d6; va <= 0 && e >= 0 && f >= 0) return {0, 1 - e / (e + f), e / (e + f)};
  const double whole = va + vb + vc;
  return whole > 0 ? Vector3d(va, vb, vc) / whole : Vector3d(1, 0, 0);
}

Vector3d at(const Corners& t, const Vector3d& weights) { return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2]; }

// The triangle of a cloth that is nearest to a point; of several equally near the first.
class Nearest {
 public:
  using Scalar = double;
  Nearest(const std::vector<Corners>& triangles, const Vector3d& p) : triangles_(triangles), p_(p) {}
  double minimumOnVolume(const Eigen::AlignedBox3d& box) const { return box.squaredExteriorDistance(p_); }
  double minimumOnObject(std::uint32_t triangle) {
    const Vector3d weights = nearest_weights(triangles_[triangle], p_);
    const double squared = (at(triangles_[triangle], weights) - p_).squaredNorm();
    if (squared < least_ || (squared == least_ && triangle < found_)) least_ = squared, found_ = triangle, weights_ = weights;
    return squared;
  }
  std::uint32_t found() const { return found_; }
  const Vector3d& weights() const { return weights_; }
  double distance() const { return std::sqrt(least_); }

 private:
  const std::vector<Corners>& triangles_;
  Vector3d p_, weights_{1, 0, 0};
  double least_ = INFINITY;
  std::uint32_t found_ = 0;
};

using Tree = Eigen::KdBVH<double, 3, std::uint32_t>;

// Of each triangle of a mesh at rest.
std::vector<Corners> corners_of(const Mesh& mesh) {
  std::vector<Corners> corners;
  for (const auto& [a, b, c] : mesh.triangles) corners.push_back({vector(mesh.points[a]), vector(mesh.points[b]), vector(mesh.points[c])});
  return corners;
}

Tree tree_of(const std::vector<Corners>& corners) {
  std::vector<std::uint32_t> triangles;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Corners& t : corners) {
    triangles.push_back(static_cast<std::uint32_t>(triangles.size()));
    boxes.emplace_back().extend(t[0]).extend(t[1]).extend(t[2]);
  }
  return Tree(triangles.begin(), triangles.end(), boxes.begin(), boxes.end());
}

// Of each point, as surface.comp has them at rest.
std::vector<Vector3d> normals_of(const Mesh& mesh, const std::vector<Corners>& corners) {
  std::vector<Vector3d> normals(mesh.points.size(), Vector3d::Zero());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    const Vector3d area = (corners[t][1] - corners[t][0]).cross(corners[t][2] - corners[t][0]);
    for (const std::uint32_t p : mesh.triangles[t]) normals[p] += area;
  }
  for (Vector3d& n : normals) n = n.norm() > 1e-20 ? n.normalized() : Vector3d::UnitY();
  return normals;
}

void put(const Vector3d& v, gpu::vec3& to) { to = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}; }

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (input.render_mesh == nullptr) return {};
  CookedFabric& fabric = state.fabric();
  const Mesh& mesh = input.mesh;
  if (mesh.render.triangles.size() != mesh.triangles.size()) return fail("render_mesh: the cloth's own mesh has no render triangles");
  auto& carried = fabric.own.of<RenderMeshLists>().carried;
  const std::vector<Corners> corners = corners_of(mesh);
  const std::vector<Vector3d> normals = normals_of(mesh, corners);
  const Tree tree = tree_of(corners);
  const RenderMesh& fine = input.render_mesh->render;
  fabric.render_meshes.push_back({static_cast<std::uint32_t>(fabric.cloths.size() - 1), static_cast<std::uint32_t>(carried.size()),
                                  static_cast<std::uint32_t>(fine.positions.size())});
  for (std::size_t v = 0; v < fine.positions.size(); ++v) {
    Nearest nearest(corners, vector(fine.positions[v]));
    Eigen::BVMinimize(tree, nearest);
    const std::uint32_t t = nearest.found();
    reference::CurvedTriangle curved;
    for (int k = 0; k < 3; ++k) curved.corners[k] = corners[t][k], curved.normals[k] = normals[mesh.triangles[t][k]];
    gpu::Carried bound{};
    for (int k = 0; k < 3; ++k) bound.corners[k] = fabric.cloths.back().first_vertex + mesh.render.triangles[t][k];
    for (int k = 0; k < 2; ++k) bound.weights[k] = static_cast<float>(nearest.weights()[k]);
    const auto place = reference::place_on(curved, {bound.weights[0], bound.weights[1], 1.0 - bound.weights[0] - bound.weights[1]});
    put(place.axes.transpose() * (vector(fine.positions[v]) - place.place), bound.offset);
    put(place.axes.transpose() * vector(fine.normals[v]), bound.normal);
    carried.push_back(bound);
  }
  return {};
}

// Their vertices come after all others.
void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  if (fabric.render_meshes.empty()) return;
  const auto first = static_cast<std::uint32_t>(fabric.surface_rows.size());
  for (CarriedMesh& mesh : fabric.render_meshes) mesh.first_vertex += first;
  std::uint32_t vertex = first;
  for (gpu::Carried& bound : fabric.own.of<RenderMeshLists>().carried) bound.vertex = vertex++;
}

}  // namespace

constinit const Effect render_mesh{
    .name = "render_mesh",
    .key = "render_mesh",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.render_meshes.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::modelled,   // which particles they move it does not ask
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace weft::effects
