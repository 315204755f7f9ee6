#include "engine/effects/chebyshev/chebyshev.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::stretch_steps, &buffers::bend_steps, &buffers::chebyshev_iterates, &buffers::acceleration};

constexpr Pass kPasses[] = {
    {.name = "chebyshev", .stage = Stage::iteration, .threads = threads::particles, .changes = Changes::iterate, .can_finalize = true},
};

constexpr Figure kFigures[] = {{.name = "unaccelerated", .counted = [](const Counts& c) { return std::uint64_t(c.unaccelerated); }}};

void remark(const Counts& counts, std::vector<std::string>& remarks) {
  remarks.push_back(std::to_string(counts.unaccelerated) + " substeps were finished without acceleration");
}

}  // namespace

constinit const Effect chebyshev{
    .name = "chebyshev",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.solver.method == Method::chebyshev; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::is_accelerated] = 1; },
    .reference = Reference::a_way_to,
    .figures = kFigures,
    .remark = remark,
};

}  // namespace weft::effects
