// See samples/godot/meshes.h.
#include "samples/godot/meshes.h"

#include <algorithm>
#include <map>

namespace weft_godot {
namespace {

using godot::Variant;
using weft::fail;
using weft::Mesh;
using weft::RenderMesh;
using weft::Result;
using weft::Triangle;
using weft::Vec3;
using weft::Vec4;

// Mesh::ArrayType
enum Slot {
  kVertex = 0,
  kNormal = 1,
  kTangent = 2,
  kColour = 3,
  kUv = 4,
  kCustom0 = 6,
  kBones = 10,
  kWeights = 11,
  kIndex = 12,
  kSlots = 13
};
constexpr std::int64_t kTriangles = 3;          // Mesh::PRIMITIVE_TRIANGLES
constexpr std::int64_t kOneFloat = 4ll << 13;   // ARRAY_CUSTOM_R_FLOAT in CUSTOM0

// Joints of vertices, four or eight each, of which the four with the largest weights count.
struct Joints {
  std::vector<std::array<std::uint16_t, weft::Skin::kInfluences>> of;
  std::vector<std::array<float, weft::Skin::kInfluences>> weights;
  std::size_t count = 0;   // of joints, as far as vertices name them

  void add(std::size_t vertices, const std::vector<std::int32_t>& bones, const std::vector<float>& given) {
    const std::size_t each = vertices > 0 ? bones.size() / vertices : 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      std::vector<std::pair<float, std::uint16_t>> all;
      for (std::size_t k = v * each; k < (v + 1) * each && k < given.size(); ++k)
        if (given[k] > 0 && bones[k] >= 0 && bones[k] < 65535) all.emplace_back(given[k], static_cast<std::uint16_t>(bones[k]));
      std::ranges::stable_sort(all, std::greater(), [](const auto& one) { return one.first; });
      all.resize(std::min(all.size(), weft::Skin::kInfluences));
      double sum = 0;
      for (const auto& [weight, joint] : all) sum += double(weight);
      auto& joints = of.emplace_back();
      auto& parts = weights.emplace_back();
      if (all.empty()) parts[0] = 1;   // with the first
      for (std::size_t k = 0; k < all.size(); ++k) {
        joints[k] = all[k].second;
        parts[k] = static_cast<float>(double(all[k].first) / sum);
        count = std::max<std::size_t>(count, all[k].second + 1);
      }
    }
  }
};

// What was said of vertices as the mesh has them, of its points: of several that became one the first says.
template <class T>
std::vector<T> of_points(const Mesh& mesh, const std::vector<T>& of_vertices) {
  std::vector<T> values(mesh.points.size());
  for (std::size_t v = mesh.point_of_source.size(); v-- > 0;)
    if (const std::uint32_t point = mesh.point_of_source[v]; point != weft::kNone) values[point] = of_vertices[v];
  return values;
}

}  // namespace

Result<Mesh> mesh_of(const Variant& mesh) {
  if (mesh.to_object() == nullptr) return fail("there is no mesh");
  RenderMesh render;
  std::vector<Vec4> colours;
  bool has_colours = false;
  Joints joints;
  const std::int64_t surfaces = mesh.call("get_surface_count").to_int();
  for (std::int64_t s = 0; s < surfaces; ++s) {
    if (godot::is(mesh.to_object(), "ArrayMesh") && mesh.call("surface_get_primitive_type", s).to_int() != kTriangles)
      return fail("surface ", s, " of its mesh is not of triangles");
    const Variant arrays = mesh.call("surface_get_arrays", s);
    const auto at = [&](Slot slot) { return arrays.call("get", std::int64_t(slot)); };
    const std::vector<Vec3> positions = at(kVertex).to_vectors3();
    const std::uint32_t first = static_cast<std::uint32_t>(render.positions.size());
    if (first + positions.size() > weft::kMostVertices) return fail("its mesh has more than ", weft::kMostVertices, " vertices");
    const std::size_t end = first + positions.size();
    render.positions.insert(render.positions.end(), positions.begin(), positions.end());
    // Of lists that only some surfaces have, the others' entries are made by weld_mesh.
    const std::vector<Vec3> normals = at(kNormal).to_vectors3();
    render.normals.insert(render.normals.end(), normals.begin(), normals.end());
    render.normals.resize(end);
    const std::vector<weft::Vec2> uvs = at(kUv).to_vectors2();
    render.uvs.insert(render.uvs.end(), uvs.begin(), uvs.end());
    if (render.uvs.size() != end) render.uvs.resize(end, {NAN, NAN});
    for (const godot::Colour& c : at(kColour).to_colours()) colours.push_back({c.r, c.g, c.b, c.a}), has_colours = true;
    colours.resize(end, {1, 1, 1, 1});
    joints.add(positions.size(), at(kBones).to_ints(), at(kWeights).to_floats());
    std::vector<std::int32_t> indices = at(kIndex).to_ints();
    if (indices.empty()) {
      indices.resize(positions.size());
      for (std::size_t k = 0; k < indices.size(); ++k) indices[k] = static_cast<std::int32_t>(k);
    }
    if (indices.size() % 3 != 0)
      return fail("surface ", s, " of its mesh has ", indices.size(), " indices, which is no whole number of triangles");
    for (std::size_t k = 0; k < indices.size(); k += 3) {
      const auto corner = [&](std::size_t i) { return first + static_cast<std::uint32_t>(indices[k + i]); };
      render.triangles.push_back({corner(0), corner(2), corner(1)});
      render.material_of.push_back(static_cast<std::uint32_t>(s));
    }
  }
  if (render.triangles.empty()) return fail("its mesh has no triangle");
  auto materials = std::make_shared<weft::Materials>();
  materials->count = static_cast<std::size_t>(surfaces);
  render.materials = std::move(materials);
  auto welded = weft::weld_mesh(std::move(render));
  if (!welded) return welded;
  if (has_colours) welded->attributes["COLOR_0"] = of_points(*welded, colours);
  if (joints.count > 0) {
    welded->skin.emplace();
    welded->skin->joints.resize(joints.count);
    welded->skin->joints_of = of_points(*welded, joints.of);
    welded->skin->weights = of_points(*welded, joints.weights);
  }
  return welded;
}

Result<Mesh> mesh_of_faces(std::span<const Vec3> corners, Vec3 scale) {
  if (corners.empty() || corners.size() % 3 != 0) return fail("its shape has no whole triangle");
  if (corners.size() > weft::kMostVertices) return fail("its shape has more than ", weft::kMostVertices / 3, " triangles");
  RenderMesh render;
  for (const Vec3 p : corners) render.positions.push_back({p.x * scale.x, p.y * scale.y, p.z * scale.z});
  for (std::uint32_t k = 0; k < corners.size(); k += 3) render.triangles.push_back({k, k + 2, k + 1});
  return weft::weld_mesh(std::move(render));
}

Variant drawn_mesh(const RenderMesh& mesh, std::vector<std::uint32_t>& surfaces) {
  surfaces.clear();
  std::map<std::uint32_t, std::vector<Triangle>> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    triangles[mesh.material_of.empty() ? 0 : mesh.material_of[t]].push_back(mesh.triangles[t]);
  const Variant drawn = godot::make("ArrayMesh");
  for (const auto& [surface, of_it] : triangles) {
    std::map<std::uint32_t, std::int32_t> own;   // a vertex's number within the surface
    std::vector<std::uint32_t> vertices;
    std::vector<std::int32_t> indices;
    for (const Triangle& t : of_it)
      for (const std::size_t k : {0, 2, 1}) {
        const auto [place, is_new] = own.try_emplace(t[k], static_cast<std::int32_t>(vertices.size()));
        if (is_new) vertices.push_back(t[k]);
        indices.push_back(place->second);
      }
    std::vector<Vec3> positions, normals;
    std::vector<weft::Vec2> uvs;
    std::vector<float> tangents, numbers;
    for (const std::uint32_t v : vertices) {
      positions.push_back(mesh.positions[v]), normals.push_back(mesh.normals[v]), uvs.push_back(mesh.uvs[v]);
      const Vec4 t = mesh.tangents[v];
      tangents.insert(tangents.end(), {t.x, t.y, t.z, t.w});
      numbers.push_back(static_cast<float>(v));
    }
    const Variant arrays = Variant::empty(GDEXTENSION_VARIANT_TYPE_ARRAY);
    arrays.call("resize", std::int64_t(kSlots));
    const auto put = [&](Slot slot, const Variant& list) { arrays.call("set", std::int64_t(slot), list); };
    put(kVertex, Variant::packed(std::span<const Vec3>(positions)));
    put(kNormal, Variant::packed(std::span<const Vec3>(normals)));
    put(kTangent, Variant::packed(std::span<const float>(tangents)));
    put(kUv, Variant::packed(std::span<const weft::Vec2>(uvs)));
    put(kCustom0, Variant::packed(std::span<const float>(numbers)));
    put(kIndex, Variant::packed(std::span<const std::int32_t>(indices)));
    drawn.call("add_surface_from_arrays", kTriangles, arrays, Variant::empty(GDEXTENSION_VARIANT_TYPE_ARRAY),
               Variant::empty(GDEXTENSION_VARIANT_TYPE_DICTIONARY), kOneFloat);
    surfaces.push_back(surface);
  }
  return drawn;
}

godot::Box box_of(std::span<const Vec3> points) {
  if (points.empty()) return {};
  Vec3 low = points[0], high = low;
  for (const Vec3 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high - low};
}

}  // namespace weft_godot
