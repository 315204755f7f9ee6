#include "engine/effects/motion_constraint/motion_constraint.h"

#include <algorithm>

#include "engine/effects/effect.h"
#include "engine/finite.h"

namespace weft {

std::vector<gpu::MotionLimits> motion_limits_of(const Scene& scene) {
  std::vector<gpu::MotionLimits> limits;
  for (const Cloth& cloth : scene.cloths)
    limits.push_back({1, static_cast<float>(cloth.motion_constraints ? cloth.motion_constraints->stiffness : 0)});
  return limits;
}

bool has_backstops(const Scene& scene) {
  return std::ranges::any_of(scene.cloths, [](const Cloth& c) { return c.motion_constraints && c.motion_constraints->backstop_radius > 0; });
}

std::vector<gpu::vec4> no_motion_targets(const CookedFabric& fabric) {
  std::vector<gpu::vec4> targets(4 * std::size_t{cloth_particles(fabric)});
  for (std::size_t k = 0; k < targets.size(); k += 4) targets[k].w = kTooLarge;
  return targets;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::motion_targets, &buffers::motion_limits};

constexpr Pass kPasses[] = {
    {.name = "motion_constraint",
     .stage = Stage::force,
     .threads = {lengths::cloth_particles},
     .changes = Changes::velocity,
     .when = [](const Needs& needs) { return needs.has(EffectId::contact); }},
};

}  // namespace

constinit const Effect motion_constraint{
    .name = "motion_constraint",
    .key = "motion_constraints",
    .called_for =
        [](const Scene& scene, const CookedFabric&) {
          return std::ranges::any_of(scene.cloths, [](const Cloth& c) { return c.motion_constraints.has_value(); });
        },
    .buffers = kBuffers,
    .passes = kPasses,
    .part_of_finalize = "+motion_constraint",
    .specialize =
        [](const Cooked& s, Constants& constants) { constants[gpu::constant::motion_constraints] = has_backstops(s.scene) ? 2 : 1; },
    .reference = Reference::absent,
};

}  // namespace effects
}  // namespace weft
