#include "engine/effects/bend/bend.h"

#include <algorithm>
#include <cmath>

#include "engine/cook/cook_state.h"
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

// A line of a lattice has three; a hinge has four, but for some on slivers whose last counts nothing.
int particles_of(const gpu::Bend& bend) { return bend.k[3] == 0 ? 3 : 4; }

// Row i of the matrix in bend.comp: M_ij = sum over stencils e of share_i(e) K_j(e) / D_e.
std::vector<std::vector<gpu::uvec2>> bend_matrix(std::span<const std::vector<gpu::uvec2>> shares, const CookedFabric& fabric,
                                                 double softening, bool may_pin) {
  struct Entry {
    std::uint32_t other;
    double value, size;   // `size` tells whether the entry is there: that may not depend on who is held where the host may pin
  };
  std::vector<std::vector<gpu::uvec2>> rows(shares.size());
  std::vector<Entry> row;
  for (std::uint32_t i = 0; i < shares.size(); ++i) {
    row.clear();
    for (const auto& [e, share] : shares[i]) {
      const gpu::Bend& bend = fabric.bends[e];
      const double part = std::bit_cast<float>(share), scale = part == 0 ? 0 : part / (bend.split_weight + bend.compliance * softening);
      for (int j = 0; j < particles_of(bend); ++j)
        if (bend.particle[j] != i) row.push_back({bend.particle[j], scale * bend.k[j], may_pin ? std::abs(bend.k[j]) : scale * bend.k[j]});
    }
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.other < b.other; });
    double largest = 0;
    for (std::size_t k = 0; k < row.size();) {
      Entry sum{row[k].other, 0, 0};
      for (; k < row.size() && row[k].other == sum.other; ++k) sum.value += row[k].value, sum.size += row[k].size;
      largest = std::max(largest, std::abs(sum.size));
      // Entries that cancel but for rounding, as on right angles, are left out.
      if (std::abs(sum.size) > 1e-9 * largest) rows[i].push_back({sum.other, std::bit_cast<std::uint32_t>(static_cast<float>(sum.value))});
    }
  }
  return rows;
}

// A particle's mass is split among its stencils as among its links; with plain averaging only the gather divides by the counts.
void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  if (fabric.bends.empty()) return;
  const bool split = state.scene().solver.averaging == Averaging::mass_split;
  std::vector<std::uint32_t> uses(fabric.positions.size());
  for (const gpu::Bend& bend : fabric.bends)
    for (int j = 0; j < particles_of(bend); ++j) ++uses[bend.particle[j]];
  std::vector<std::vector<gpu::uvec2>> shares(fabric.positions.size());
  for (std::uint32_t e = 0; e < fabric.bends.size(); ++e) {
    gpu::Bend& bend = fabric.bends[e];
    double weight = 0;
    for (int j = 0; j < 4; ++j)
      weight += double(split ? uses[bend.particle[j]] : 1) * fabric.positions[bend.particle[j]].w * bend.k[j] * bend.k[j];
    bend.split_weight = static_cast<float>(weight);
    for (int j = 0; j < particles_of(bend); ++j) {
      const std::uint32_t p = bend.particle[j];
      const float share = bend.k[j] * fabric.positions[p].w / static_cast<float>(split ? 1 : uses[p]);
      if (share != 0 || (state.may_pin() && bend.k[j] != 0)) shares[p].push_back({e, std::bit_cast<std::uint32_t>(share)});
    }
  }
  if (state.scene().solver.iterations > 1) {
    fabric.bend_uses = cooking::pack_rows(shares, cooking::Padding::repeated);
    return;
  }
  fabric.bend = cooking::pack_rows(bend_matrix(shares, fabric, state.softening(), state.may_pin()), cooking::Padding::repeated);
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
    .lay_out = lay_out,
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { lay_out(state); },
};

}  // namespace weft::effects
