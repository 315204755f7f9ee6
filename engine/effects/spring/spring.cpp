#include "engine/effects/spring/spring.h"

#include <algorithm>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::spring_rows, &buffers::spring_ends, &buffers::springs};

bool by_symplectic_euler(const Needs& needs) { return !needs.has(EffectId::implicit); }

constexpr Pass kPasses[] = {
    {.name = "spring", .stage = Stage::iteration, .threads = threads::particles, .changes = Changes::iterate, .when = by_symplectic_euler},
};

// The scene's springs, or springs with the energy of the cloth's links and bending stencils.
Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  const Method method = state.scene().solver.method;
  if (!on_springs(method)) return {};
  CookedFabric& fabric = state.fabric();
  const auto particle_of = state.particle_of();
  const bool only_pulls = method == Method::verlet, straight = method != Method::implicit;
  if (input.cloth.springs) {
    for (const auto& [a, b, rest, kind] : cooking::neighbour_springs(input.mesh, *input.cloth.springs, straight))
      fabric.springs.push_back({particle_of[a], particle_of[b], static_cast<float>(rest), static_cast<float>(kind.stiffness),
                                static_cast<float>(kind.damping), only_pulls});
    return {};
  }
  for (const StretchLink& link : std::span(fabric.links).subspan(input.first_link)) {
    if (!(link.compliance > 0)) return fail("a link of ", link.rest, " m has no compliance, and the method needs springs that give way");
    fabric.springs.push_back({link.a, link.b, link.rest, 1 / link.compliance, 0, link.only_pulls || only_pulls});
  }
  if (!only_pulls) cooking::add_bending_springs(std::span(fabric.bends).subspan(input.first_bend), fabric.springs);
  return {};
}

void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  if (!on_springs(state.scene().solver.method)) return;
  fabric.spring_rows = cooking::spring_rows(fabric.springs, fabric.positions.size());
  fabric.jacobi_weight = cooking::jacobi_weight(fabric.springs);
}

}  // namespace

constinit const Effect spring{
    .name = "spring",
    .called_for = [](const Scene& scene, const CookedFabric&) { return on_springs(scene.solver.method); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          constants[gpu::constant::has_damping] = std::any_of(s.fabric.springs.begin(), s.fabric.springs.end(),
                                                              [](const ParticleSpring& spring) { return spring.damping > 0; });
        },
    .reference = Reference::a_way_to,
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace weft::effects
