#include "engine/effects/bdf2/bdf2.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::velocity_changes, &buffers::step_remainders, &buffers::velocities_before};

}  // namespace

constinit const Effect bdf2{
    .name = "bdf2",
    .key = "solver.order",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.solver.order == 2; },
    .buffers = kBuffers,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::is_second_order] = 1; },
    .reference = Reference::a_way_to,
};

}  // namespace weft::effects
