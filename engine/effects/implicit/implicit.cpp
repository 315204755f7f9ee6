#include "engine/effects/implicit/implicit.h"

#include "compute/text.h"
#include "engine/effects/effect.h"
#include "engine/effects/implicit/levels.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::spring_blocks, &buffers::inverses, &buffers::exchanged, &buffers::solve_vectors,
                                      &buffers::partial_sums,  &buffers::linear,   &buffers::free_cloths, &buffers::collider_filters,
                                      &buffers::level_grips,   &buffers::level_residuals, &buffers::level_blocks, &buffers::level_changes};

bool by_jacobi(const Needs& needs) { return needs.constants[gpu::constant::linear_solver] == WEFT_LINEAR_JACOBI; }
bool by_conjugate_gradients(const Needs& needs) { return !by_jacobi(needs); }
bool on_levels(const Needs& needs) { return needs.has(EffectId::level); }
bool on_wide_levels(const Needs& needs) { return on_levels(needs) && levels::has_wide(needs); }
bool meets_colliders(const Needs& needs) { return needs.has(EffectId::collide); }

// A workgroup a cloth.
constexpr Threads kCloths{lengths::particles, [](const Cooked& s) { return std::uint64_t(s.fabric.cloths.size()); }};

constexpr Pass kPasses[] = {
    {.name = "implicit_assemble", .stage = Stage::assemble, .threads = threads::particles},
    {.name = "implicit_filter", .stage = Stage::assemble, .threads = threads::particles, .when = meets_colliders},
    {.name = "implicit_multiply", .stage = Stage::linear, .threads = threads::particles, .when = by_conjugate_gradients},
    {.name = "implicit_advance", .stage = Stage::linear, .threads = threads::particles, .when = by_conjugate_gradients},
    {.name = "implicit_mean", .stage = Stage::linear, .threads = {levels::nodes}, .when = on_levels, .ranges = levels::finest},
    {.name = "implicit_mean_wide",
     .stage = Stage::linear,
     .threads = {levels::nodes},
     .when = on_wide_levels,
     .ranges = levels::wide_but_finest},
    {.name = "implicit_low", .stage = Stage::linear, .threads = {levels::low, lengths::one}, .when = on_levels, .alone = true},
    {.name = "implicit_wide", .stage = Stage::linear, .threads = {levels::nodes}, .when = on_wide_levels, .ranges = levels::wide},
    {.name = "implicit_spread", .stage = Stage::linear, .threads = threads::particles, .when = on_levels},
    {.name = "implicit_relax", .stage = Stage::linear, .threads = threads::particles, .when = by_jacobi},
    {.name = "implicit_drift", .stage = Stage::iteration, .threads = kCloths},
    {.name = "implicit_step", .stage = Stage::iteration, .threads = threads::particles, .changes = Changes::iterate, .can_finalize = true},
};

constexpr Figure kFigures[] = {
    {.name = "linear.residual", .measured = [](const Counts& c) { return double(c.residual); }},
    {.name = "linear.unconverged", .counted = [](const Counts& c) { return std::uint64_t(c.unconverged); }},
    {.name = "linear.stopped", .counted = [](const Counts& c) { return std::uint64_t(c.stopped); }},
};

void remark(const Counts& counts, std::vector<std::string>& remarks) {
  if (counts.unconverged == 0) return;
  remarks.push_back(std::to_string(counts.unconverged) + " substeps were solved to worse than 1 % (the last to " +
                    rounded_text(100 * double(counts.residual), 2) + " %): more iterations or shorter substeps do better");
}

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
    .figures = kFigures,
    .remark = remark,
    .lay_out = grip_levels,
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { grip_levels(state); },   // free_cloths follow from the masses
};

}  // namespace weft::effects
