#include "engine/effects/grab/grab.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::grabs, &buffers::last_pulls};

constexpr Pass kPasses[] = {{.name = "grab", .stage = Stage::force, .threads = threads::once, .changes = Changes::velocity}};

}  // namespace

constinit const Effect grab{
    .name = "grab",
    .key = "grabs",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.grabs > 0; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked& s, Constants& constants) { constants[gpu::constant::grab_count] = 3 * s.scene.grabs; },
    .reference = Reference::absent,
};

}  // namespace weft::effects
