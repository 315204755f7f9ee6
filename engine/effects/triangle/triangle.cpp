#include "engine/effects/triangle/triangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::collisions, &buffers::collision_list, &buffers::collision_sums, &buffers::ways_out};

constexpr Length kTriangles = [](const Cooked& s) { return std::uint64_t(s.fabric.cloth_triangles); };

constexpr Pass kPasses[] = {
    {.name = "triangle_search", .stage = Stage::iteration, .threads = {kTriangles}, .after_tethers = true},
    {.name = "triangle_collide",
     .stage = Stage::iteration,
     .threads = {kTriangles, nullptr, {&buffers::collisions, offsetof(gpu::Collisions, groups)}},
     .after_tethers = true},
};

// Fine cloth stays out of round bodies by its vertices alone, but for a little. Of a triangle whose corners are r + t from a core no point
// is nearer to it than the root of (r + t)^2 - l^2 / 3, l its longest edge: outside (1 - kSag) r while
// l^2 <= 3 ((r + t)^2 - ((1 - kSag) r)^2). Not 0: triangles make coarse cloth on a ball shiver.
constexpr double kSag = 0.02;

bool may_show_through(const Collider& collider, double edge, double thickness) {
  switch (collider.shape) {
    case ColliderShape::sphere:
    case ColliderShape::capsule: {
      if (collider.resizes) return true;   // to whatever size
      const double radius = collider.shape == ColliderShape::capsule ? std::min(collider.radius, radius_at_end(collider)) : collider.radius;
      const double from = radius + thickness, to = (1 - kSag) * radius;
      return edge * edge > 3 * (from * from - to * to);
    }
    case ColliderShape::box: return true;
    case ColliderShape::plane:   // where no vertex passes no triangle does
    case ColliderShape::mesh: return false;
  }
  return false;
}

// Of each cloth (m).
std::vector<double> longest_edges(const CookedFabric& fabric) {
  std::vector<double> longest(fabric.cloths.size());
  const auto length = [&](std::uint32_t i, std::uint32_t j) {
    const gpu::vec4 &a = fabric.positions[i], &b = fabric.positions[j];
    return std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
  };
  for (const auto& [a, b, c] : std::span(fabric.triangles).first(fabric.cloth_triangles)) {
    double& of_cloth = longest[body_of(fabric, a)];
    of_cloth = std::max({of_cloth, length(a, b), length(b, c), length(c, a)});
  }
  return longest;
}

// Of each cloth (m).
std::vector<double> least_thickness(const CookedFabric& fabric) {
  std::vector<double> least(fabric.cloths.size(), INFINITY);
  for (const gpu::Material& material : fabric.materials)
    if (const auto body = static_cast<std::size_t>(material.body); body < least.size())
      least[body] = std::min(least[body], double(material.thickness));
  return least;
}

void lay_out(cooking::CookState& state) {
  if (state.scene().colliders.empty()) return;
  CookedFabric& fabric = state.fabric();
  bool any = false, with_round = false;
  const std::vector<double> edges = longest_edges(fabric), thickness = least_thickness(fabric);
  for (const Collider& collider : state.scene().colliders)
    for (std::size_t k = 0; k < edges.size(); ++k)
      if (edges[k] > 0 && meet(state.scene().cloths[k], collider) && may_show_through(collider, edges[k], thickness[k])) {
        any = true;
        with_round = with_round || collider.shape != ColliderShape::box;
      }
  if (!any) return;
  std::vector<std::uint32_t> around(fabric.positions.size());
  for (std::uint32_t k = 0; k < fabric.cloth_triangles; ++k)
    for (const std::uint32_t i : fabric.triangles[k]) ++around[i];
  fabric.own.of<TriangleLists>() = {*std::ranges::max_element(around), with_round};
}

Contents settings(const Cooked& s) {
  gpu::CollisionSettings settings{};
  settings.quantum = static_cast<float>(std::ldexp(WEFT_FURTHEST_OUT * s.fabric.own.of<TriangleLists>().most_around, -30));
  return made(std::vector{settings});
}

void specialize(const Cooked& s, Constants& constants) {
  constants[gpu::constant::triangles_collide] = s.fabric.own.of<TriangleLists>().with_round ? 2 : 1;
}

}  // namespace

constinit const Effect triangle{
    .name = "triangle",
    .key = "colliders",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return fabric.own.of<TriangleLists>().most_around > 0; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = specialize,
    .slice = {"collision_settings", settings},
    .reference = Reference::absent,
    .lay_out = lay_out,
};

}  // namespace weft::effects
