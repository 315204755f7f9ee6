#include "engine/effects/bend/bend.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/cook/cook_state.h"
#include "engine/effects/bend/matrix.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::bend_rows,     &buffers::bend_entries, &buffers::bends,        &buffers::bend_lambda,
                                      &buffers::bend_impulses, &buffers::bend_uses,    &buffers::bend_use_rows};

bool iterated(const Needs& needs) { return needs.constants[gpu::constant::is_iterated] != 0; }
bool once(const Needs& needs) { return !iterated(needs); }

constexpr Pass kPasses[] = {
    {.name = "bend",
     .stage = Stage::iteration,
     .threads = threads::particles,
     .changes = Changes::iterate,
     .can_finalize = true,
     .when = once},
    {.name = "bend_lambda", .stage = Stage::iteration, .threads = {lengths::bends}, .when = iterated},
    {.name = "bend_gather",
     .stage = Stage::iteration,
     .threads = threads::particles,
     .changes = Changes::iterate,
     .can_finalize = true,
     .when = iterated},
};

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  const Cloth& cloth = input.cloth;
  if (!cloth.bending || !(cloth.fabric.bend > 0) || cloth.bend_rest != BendRest::flat) return {};
  std::uint32_t clamped = 0;
  for (gpu::Bend bend : cooking::bend_stencils(input.mesh, cloth.fabric.bend, cloth.bends_as_plate, clamped)) {
    bend.compliance /= static_cast<float>(cooking::factor(input.factors.bend, bend.particle[0], bend.particle[1]));
    for (std::uint32_t& p : bend.particle) p = state.particle_of()[p];
    bend.compliance = std::min(bend.compliance, static_cast<float>(cooking::kSoftest));
    state.fabric().bends.push_back(bend);
  }
  if (clamped > 0) state.note(cloth, clamped, " bending stencils lie on slivers; their cotangents were limited");
  return {};
}

// With iterations a particle's mass is split among its stencils as among its links; with plain averaging only the gather divides by the counts.
void lay_out_uses(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  const bool split = state.scene().solver.averaging == Averaging::mass_split;
  std::vector<std::uint32_t> uses(fabric.positions.size());
  for (const gpu::Bend& bend : fabric.bends)
    for (int j = 0; j < cooking::particles_of(bend); ++j) ++uses[bend.particle[j]];
  std::vector<std::vector<gpu::uvec2>> shares(fabric.positions.size());
  for (std::uint32_t e = 0; e < fabric.bends.size(); ++e) {
    gpu::Bend& bend = fabric.bends[e];
    double weight = 0;
    for (int j = 0; j < 4; ++j)
      weight += double(split ? uses[bend.particle[j]] : 1) * fabric.positions[bend.particle[j]].w * bend.k[j] * bend.k[j];
    bend.split_weight = static_cast<float>(weight);
    for (int j = 0; j < cooking::particles_of(bend); ++j) {
      const std::uint32_t p = bend.particle[j];
      const float share = bend.k[j] * fabric.positions[p].w / static_cast<float>(split ? 1 : uses[p]);
      if (share != 0 || (state.may_pin() && bend.k[j] != 0)) shares[p].push_back({e, std::bit_cast<std::uint32_t>(share)});
    }
  }
  fabric.bend_uses = cooking::pack_rows(shares, cooking::Padding::repeated);
}

void lay_out(cooking::CookState& state, bool is_first = true) {
  CookedFabric& fabric = state.fabric();
  if (fabric.bends.empty()) return;
  const SolverSettings& solver = state.scene().solver;
  if (is_first && solver.bend_steps > 1 && (solver.iterations > 1 || on_springs(solver.method)))
    fabric.notes.push_back("solver.bend_steps: " + std::to_string(solver.bend_steps) +
                           " has no effect: it takes one iteration and a method of constraints.");
  if (solver.iterations > 1) return lay_out_uses(state);
  cooking::BendSteps steps(fabric, solve_step(state.scene(), fabric), state.may_pin());
  std::vector<std::vector<gpu::uvec2>> matrix(fabric.positions.size());
  for (std::size_t k = 0; k < fabric.cloths.size(); ++k)
    if (!steps.add(solver.bend_steps, fabric.cloths[k], matrix) && is_first)
      state.note(state.scene().cloths[k], "so many triangles share a vertex that bending takes fewer than ", solver.bend_steps, " steps");
  fabric.bend = cooking::pack_rows(matrix, cooking::Padding::repeated);
}

constexpr Figure kFigures[] = {{.name = "bends", .cooked = [](const CookedFabric& f) { return std::uint64_t(f.bends.size()); }}};

}  // namespace

constinit const Effect bend{
    .name = "bend",
    .called_for = [](const Scene& scene, const CookedFabric& fabric) { return !fabric.bends.empty() && !on_springs(scene.solver.method); },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::modelled,
    .figures = kFigures,
    .cook = cook,
    .lay_out = [](cooking::CookState& state) { lay_out(state); },
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { lay_out(state, false); },
};

}  // namespace weft::effects
