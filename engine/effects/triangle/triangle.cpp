#include "engine/effects/triangle/triangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/cook/cook_state.h"
#include "engine/effects/collide/weave.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::collisions, &buffers::collision_list, &buffers::collision_sums, &buffers::collision_depths,
                                      &buffers::ways_out};

constexpr Length kTriangles = [](const Cooked& s) { return std::uint64_t(s.fabric.cloth_triangles); };

constexpr Pass kPasses[] = {
    {.name = "triangle_search", .stage = Stage::iteration, .threads = {kTriangles}, .after_tethers = true},
    {.name = "triangle_collide",
     .stage = Stage::iteration,
     .threads = {kTriangles, nullptr, {&buffers::collisions, offsetof(gpu::Collisions, groups)}},
     .after_tethers = true},
};

// Of a triangle whose corners are R from a core no point is nearer to it than the root of R^2 - c^2, c the radius of the smallest circle about
// the triangle. So cloth stays out of a round body of radius r by its vertices alone while these keep the root of r^2 + c^2 from the core, if
// that is more than their thickness asks for anyway. Where they would stand off by more than this part of r, triangles collide by themselves.
// They do not where they need not: triangles make coarse cloth on a ball shiver.
constexpr double kFurthestOff = 0.02;
// Cloth that strikes a body is stretched, and its triangles are larger for a moment: by so much more than at rest.
constexpr double kStretched = 1.1;
// A body with less than this part of the cloth's width, the root of its area, for its radius carries it by a few edges. Those a strike
// stretches, and friction then holds them: triangles collide by themselves where so much larger ones would have to.
constexpr double kThin = 0.05, kCaught = 3;

// How far vertices keep off beyond their thickness (m).
double stand_off(const Collider& collider, const Weave& weave, double stretched) {
  const double r = radius_of(collider);
  return std::max(0.0, std::hypot(r, stretched * weave.circle) - (r + weave.thickness));
}

bool may_show_through(const Collider& collider, const Weave& weave) {
  if (collider.shape == ColliderShape::box) return true;
  // What resizes may get whatever size. Where no vertex passes a plane no triangle does, and meshes are for contacts.
  const double r = radius_of(collider), stretched = is_thin(collider, weave, kThin) ? kCaught : kStretched;
  return is_round(collider) && (collider.resizes || stand_off(collider, weave, stretched) > kFurthestOff * r);
}

void lay_out(cooking::CookState& state) {
  const std::vector<Collider>& colliders = state.scene().colliders;
  if (colliders.empty()) return;
  CookedFabric& fabric = state.fabric();
  TriangleLists& lists = fabric.own.of<TriangleLists>();
  const std::vector<Weave> weaves = weaves_of(fabric);
  std::vector<float> stand_offs(colliders.size());
  bool any = false;
  for (std::size_t c = 0; c < colliders.size(); ++c)
    for (std::size_t k = 0; k < weaves.size(); ++k) {
      if (weaves[k].circle == 0 || !meet(state.scene().cloths[k], colliders[c])) continue;
      const bool shows = may_show_through(colliders[c], weaves[k]);
      any = any || shows;
      lists.with_round = lists.with_round || (shows && is_round(colliders[c]));
      if (!is_round(colliders[c])) continue;
      stand_offs[c] = std::max(stand_offs[c], static_cast<float>(stand_off(colliders[c], weaves[k], kStretched)));
    }
  // Where triangles meet round bodies, they do so by themselves.
  if (!lists.with_round && std::ranges::any_of(stand_offs, [](float off) { return off > 0; })) lists.stand_offs = std::move(stand_offs);
  if (!any) return;
  std::vector<std::uint32_t> around(fabric.positions.size());
  for (std::uint32_t k = 0; k < fabric.cloth_triangles; ++k)
    for (const std::uint32_t i : fabric.triangles[k]) ++around[i];
  lists.most_around = *std::ranges::max_element(around);
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
