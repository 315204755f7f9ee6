#include "engine/effects/stretch/stretch.h"

#include <algorithm>
#include <map>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"
#include "engine/effects/haste.h"
#include "engine/effects/strand/strand.h"
#include "engine/effects/tear/tear.h"

namespace weft::effects {
namespace {

// Rows of links are padded to one length where that adds no more than this fraction: fetching a row's start costs as much.
constexpr double kMostPadding = 0.15;

constexpr const Buffer* kBuffers[] = {&buffers::stretch_rows, &buffers::stretch_links, &buffers::stretch_lambda};

constexpr Pass kPasses[] = {
    {.name = "stretch",
     .stage = Stage::iteration,
     .threads = threads::particles,
     .changes = Changes::iterate,
     .can_finalize = true,
     .sweeps = sweeps_in_haste},
};

// The strands of a cloth whose links begin at `first`, in the order of `springs`.
void add_strands(cooking::CookState& state, const Mesh& mesh, const std::vector<cooking::Spring>& springs, std::size_t first) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> spring_of;
  for (std::uint32_t k = 0; k < springs.size(); ++k) spring_of[std::minmax(springs[k].a, springs[k].b)] = k;
  const auto rounds = cooking::choose_strands(mesh, springs);
  for (std::size_t round = 0; round < rounds.size(); ++round)
    for (const cooking::Strand& strand : rounds[round]) {
      auto& made = state.strands[round].emplace_back();
      made.start = state.particle_of()[strand.front()];
      for (std::size_t k = 1; k < strand.size(); ++k) {
        const auto link = static_cast<std::uint32_t>(first + spring_of.at(std::minmax(strand[k - 1], strand[k])));
        state.fabric().links[link].in_strand = true;
        made.links.push_back({link, state.particle_of()[strand[k]]});
      }
    }
}

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  const auto particle_of = state.particle_of();
  const std::size_t first = state.fabric().links.size();
  const auto springs = cooking::springs(input.mesh, {input.cloth.fabric.stretch, input.cloth.fabric.shear}, !state.has_levels);
  for (const cooking::Spring& s : springs) {
    // What the GPU will read, so that strain and reference see the same link.
    const double compliance = s.compliance > 0 ? s.compliance / cooking::in_series(input.factors.stretch, s.a, s.b) : 0;
    const gpu::uvec2 packed =
        gpu::pack_link({0, static_cast<float>(s.rest), static_cast<float>(std::min(compliance, cooking::kSoftest)), s.only_pulls});
    const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
    state.fabric().links.push_back({particle_of[s.a], particle_of[s.b], link.rest, link.response, s.only_pulls});
    if (state.has_levels) state.fabric().links.back().part = static_cast<float>(state.own_part);
  }
  if (method_of(state.scene()) == Method::strands) add_strands(state, input.mesh, springs, first);
  return {};
}

// Split masses, the responses that follow from them, and rows of links.
void lay_out(cooking::CookState& state) {
  const SolverSettings& solver = state.scene().solver;
  CookedFabric& fabric = state.fabric();
  std::vector<std::uint32_t> uses(fabric.positions.size());
  for (const StretchLink& link : fabric.links)
    if (!link.in_strand) ++uses[link.a], ++uses[link.b];
  const bool split = solver.averaging == Averaging::mass_split, iterated = solver.iterations > 1;
  const bool alone = method_of(state.scene()) == Method::gauss_seidel || on_springs(solver.method);   // no masses are split
  fabric.split_weights.clear();
  fabric.iterate_weights.clear();
  for (std::size_t i = 0; i < uses.size(); ++i)
    fabric.split_weights.push_back((split ? std::max<float>(1, static_cast<float>(uses[i])) : 1) * fabric.positions[i].w);
  std::vector<std::vector<gpu::uvec2>> lists(fabric.positions.size());
  for (StretchLink& link : fabric.links) {
    if (link.in_strand) continue;
    const double weight = double(fabric.split_weights[link.a]) + fabric.split_weights[link.b];
    const double gain = weight > 0 ? 1 / (weight + link.own_compliance() * state.softening()) : 0;
    const float response = iterated ? link.own_compliance() : static_cast<float>(gain);
    const gpu::uvec2 to_b = gpu::pack_link({link.b, link.rest, response, link.only_pulls});
    lists[link.a].push_back(to_b);
    lists[link.b].push_back(gpu::pack_link({link.a, link.rest, response, link.only_pulls}));
    if (!iterated) link.gain = gpu::unpack_link(to_b.x, to_b.y).response;
  }
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const float weight = fabric.split_weights[i], count = std::max<float>(1, static_cast<float>(uses[i]));
    fabric.iterate_weights.push_back(alone ? fabric.positions[i].w : iterated ? weight : split ? fabric.positions[i].w : weight / count);
  }
  fabric.stretch = cooking::pack_rows(lists, cooking::Padding::owner, iterated || tears(state.scene()) ? 0 : kMostPadding);
}

}  // namespace

constinit const Effect stretch{
    .name = "stretch",
    .called_for =
        [](const Scene& scene, const CookedFabric&) {
          const Method method = method_of(scene);
          return method == Method::jacobi || method == Method::strands || method == Method::chebyshev;
        },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked& s, Constants& constants) { constants[gpu::constant::stretch_stride] = s.fabric.stretch.stride; },
    .reference = Reference::modelled,
    .cook = cook,
    .lay_out = lay_out,
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { lay_out(state); },
};

}  // namespace weft::effects
