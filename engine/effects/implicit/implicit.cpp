#include "engine/effects/implicit/implicit.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::spring_blocks, &buffers::inverses, &buffers::exchanged, &buffers::solve_vectors,
                                      &buffers::partial_sums,  &buffers::linear,   &buffers::free_cloths, &buffers::collider_filters};

bool by_jacobi(const Needs& needs) { return needs.constants[gpu::constant::linear_solver] == WEFT_LINEAR_JACOBI; }
bool by_conjugate_gradients(const Needs& needs) { return !by_jacobi(needs); }
bool meets_colliders(const Needs& needs) { return needs.has(EffectId::collide); }

// A workgroup a cloth.
constexpr Threads kCloths{lengths::particles, [](const Cooked& s) { return std::uint64_t(s.fabric.cloths.size()); }};

constexpr Pass kPasses[] = {
    {.name = "implicit_assemble", .stage = Stage::assemble, .threads = threads::particles},
    {.name = "implicit_filter", .stage = Stage::assemble, .threads = threads::particles, .when = meets_colliders},
    {.name = "implicit_multiply", .stage = Stage::linear, .threads = threads::particles, .when = by_conjugate_gradients},
    {.name = "implicit_advance", .stage = Stage::linear, .threads = threads::particles, .when = by_conjugate_gradients},
    {.name = "implicit_relax", .stage = Stage::linear, .threads = threads::particles, .when = by_jacobi},
    {.name = "implicit_drift", .stage = Stage::iteration, .threads = kCloths},
    {.name = "implicit_step", .stage = Stage::iteration, .threads = threads::particles, .changes = Changes::iterate, .can_finalize = true},
};

}  // namespace

constinit const Effect implicit{
    .name = "implicit",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.solver.method == Method::implicit; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          constants[gpu::constant::linear_solver] = s.scene.solver.linear == Linear::jacobi ? WEFT_LINEAR_JACOBI : WEFT_LINEAR_CG;
        },
    .reference = Reference::a_way_to,
};

}  // namespace weft::effects
