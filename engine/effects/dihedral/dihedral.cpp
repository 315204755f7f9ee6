#include "engine/effects/dihedral/dihedral.h"

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::hinges, &buffers::hinge_impulses, &buffers::hinge_use_rows, &buffers::hinge_uses};

constexpr Pass kPasses[] = {
    {.name = "dihedral", .stage = Stage::iteration, .threads = {lengths::hinges}},
    {.name = "dihedral_gather",
     .stage = Stage::iteration,
     .threads = threads::particles,
     .changes = Changes::iterate,
     .can_finalize = true},
};

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  const Cloth& cloth = input.cloth;
  if (!cloth.bending || !(cloth.fabric.bend > 0) || cloth.bend_rest != BendRest::mesh) return {};
  const auto softened = cooking::add_hinges(input.mesh, state.particle_of(), cloth.fabric.bend, input.factors.bend, state.fabric());
  if (softened > 0) state.note(cloth, softened, " hinges lie on slivers; their stiffness was limited");
  return {};
}

void lay_out(cooking::CookState& state) {
  if (!state.fabric().hinges.empty()) cooking::lay_out_hinges(state.scene().solver.averaging, state.may_pin(), state.fabric());
}

constexpr Figure kFigures[] = {{.name = "hinges", .cooked = [](const CookedFabric& f) { return std::uint64_t(f.hinges.size()); }}};

}  // namespace

constinit const Effect dihedral{
    .name = "dihedral",
    .key = "bend_rest",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.hinges.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::absent,
    .figures = kFigures,
    .cook = cook,
    .lay_out = lay_out,
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { lay_out(state); },
};

}  // namespace weft::effects
