#include "engine/effects/gauss_seidel/gauss_seidel.h"

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::coloured_links, &buffers::coloured_lambda};

// A dispatch a colour.
std::vector<Range> colours(const Cooked& s) {
  std::vector<Range> ranges;
  std::uint32_t first = 0;
  for (const std::uint32_t end : s.fabric.colour_ends) {
    ranges.push_back({first, end - first});
    first = end;
  }
  return ranges;
}

constexpr Pass kPasses[] = {
    {.name = "gauss_seidel", .stage = Stage::iteration, .threads = {lengths::coloured_links}, .ranges = colours},
};

}  // namespace

constinit const Effect gauss_seidel{
    .name = "gauss_seidel",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.solver.method == Method::gauss_seidel; },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::a_way_to,
    .lay_out =
        [](cooking::CookState& state) {
          if (state.scene().solver.method == Method::gauss_seidel) cooking::colour_links(state.fabric());
        },
};

}  // namespace weft::effects
