#include "engine/effects/strand/strand.h"

#include <algorithm>

#include "engine/cook/cook_state.h"
#include "engine/effects/haste.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::strand_starts, &buffers::strand_links, &buffers::strand_lambda};

constexpr Pass kPasses[] = {
    {.name = "strand",
     .stage = Stage::iteration,
     .threads = {[](const Cooked& s) { return std::uint64_t(s.fabric.own.of<StrandLists>().starts.size()); }},
     .sweeps = sweeps_in_haste,
     .ranges = [](const Cooked& s) { return s.fabric.own.of<StrandLists>().rounds; }},
};

// As they were chosen: where who is held may change they are laid out again.
struct ChosenStrands {
  std::array<std::vector<cooking::CookState::StrandOfParticles>, 2> rounds;
};

// In rounds, over particles; longest first, so that neighbours among threads end together.
void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  StrandLists& lists = fabric.own.of<StrandLists>();
  const bool iterated = state.scene().solver.iterations > 1;
  for (auto& strands : state.strands) {
    if (strands.empty()) continue;
    std::stable_sort(strands.begin(), strands.end(), [](const auto& a, const auto& b) { return a.links.size() > b.links.size(); });
    const double h = solve_step(state.scene(), fabric);
    const std::size_t count = strands.size(), first = lists.links.size();
    lists.rounds.push_back({static_cast<std::uint32_t>(lists.starts.size()), static_cast<std::uint32_t>(count)});
    lists.links.resize(first + count * WEFT_STRAND_LINKS, gpu::uvec2{0, 0});
    for (std::size_t s = 0; s < count; ++s) {
      lists.starts.push_back(strands[s].start);
      for (std::size_t k = 0; k < strands[s].links.size(); ++k) {
        StretchLink& link = fabric.links[strands[s].links[k].link];
        const std::uint32_t next = strands[s].links[k].next;
        const double weight = double(fabric.positions[link.a].w) + fabric.positions[link.b].w;
        const double gain = weight > 0 ? 1 / (weight + link.own_compliance() / (h * h)) : 0;
        const gpu::uvec2 packed = gpu::pack_link({next, link.rest, iterated ? link.own_compliance() : static_cast<float>(gain), link.only_pulls});
        if (!iterated) link.gain = gpu::unpack_link(packed.x, packed.y).response;
        lists.links[first + k * count + s] = packed;
      }
    }
  }
  if (state.may_pin()) fabric.own.of<ChosenStrands>().rounds = std::move(state.strands);
  state.strands = {};
}

void hold(cooking::CookState& state, std::span<const Mesh>) {
  state.strands = std::move(state.fabric().own.of<ChosenStrands>().rounds);
  state.fabric().own.of<StrandLists>() = {};
  lay_out(state);
}

}  // namespace

constinit const Effect strand{
    .name = "strand",
    .called_for = [](const Scene& scene, const CookedFabric&) { return method_of(scene) == Method::strands; },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::a_way_to,
    .lay_out = lay_out,
    .hold = hold,
};

}  // namespace weft::effects
