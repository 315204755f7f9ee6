#include "engine/effects/gauss_seidel/gauss_seidel.h"

#include "engine/cook/cook_state.h"
#include "engine/effects/haste.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::patches, &buffers::patch_members, &buffers::patch_colour_ends, &buffers::patch_links,
                                      &buffers::patch_lambda};

constexpr Pass kPasses[] = {
    {.name = "gauss_seidel",
     .stage = Stage::iteration,
     .threads = {[](const Cooked& s) { return std::uint64_t(s.fabric.own.of<PatchLists>().patches.size()); }},
     .sweeps = sweeps_in_haste,
     .ranges = [](const Cooked& s) { return s.fabric.own.of<PatchLists>().rounds; },
     .a_workgroup_each = true},
};

}  // namespace

constinit const Effect gauss_seidel{
    .name = "gauss_seidel",
    .called_for = [](const Scene& scene, const CookedFabric&) { return method_of(scene) == Method::gauss_seidel; },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::a_way_to,
    .lay_out =
        [](cooking::CookState& state) {
          if (method_of(state.scene()) == Method::gauss_seidel) cooking::make_patches(state.fabric());
        },
};

}  // namespace weft::effects
