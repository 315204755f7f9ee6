#include "engine/effects/shift/shift.h"

#include <algorithm>
#include <utility>

#include "engine/cook/cook_state.h"
#include "engine/effects/gauss_seidel/gauss_seidel.h"
#include "engine/effects/strand/strand.h"

namespace weft::effects {
namespace {

// 1/s: how fast a shift follows the error, and how fast it is forgotten. Under a steady load links keep a quarter of their strain.
constexpr double kFollows = 2, kForgets = 0.7;
// s: in a longer frame a shift goes no farther than in one of these.
constexpr double kLongest = 0.02;

constexpr const Buffer* kBuffers[] = {&buffers::patch_shifted, &buffers::strand_shifted, &buffers::stretch_shifted,
                                      &buffers::patch_shifts,  &buffers::strand_shifts,  &buffers::stretch_shifts};

constexpr Pass kPasses[] = {
    {.name = "shift_patches",
     .stage = Stage::frame_begin,
     .threads = {lengths::shifted_patches},
     .when = [](const Needs& needs) { return needs.has(EffectId::gauss_seidel); }},
    {.name = "shift_strands",
     .stage = Stage::frame_begin,
     .threads = {lengths::shifted_strands},
     .when = [](const Needs& needs) { return needs.has(EffectId::strand); }},
    {.name = "shift_stretch",
     .stage = Stage::frame_begin,
     .threads = {lengths::shifted_stretch},
     .when = [](const Needs& needs) { return needs.has(EffectId::strand); }},
};

// `gives_way`: q of shift.glsl.
gpu::uvec4 shifted(std::uint32_t a, std::uint32_t b, std::uint32_t low, float rest, double gives_way, double frame) {
  const double dt = std::min(frame, kLongest), gain = dt * kFollows * (1 - gives_way), kept = 1 - dt * (kForgets + kFollows * gives_way);
  return gpu::pack_shifted_link({a, b, low, rest, static_cast<float>(gain), static_cast<float>(kept)});
}

void lay_out(cooking::CookState& state) {
  const Scene& scene = state.scene();
  if (!scene.solver.shifts) return;
  CookedFabric& fabric = state.fabric();
  const double h = solve_step(scene, fabric), frame = 1 / scene.solver.rate;
  const auto weight_of = [&](std::uint32_t i) { return double(fabric.positions[i].w); };
  ShiftLists& lists = fabric.own.of<ShiftLists>() = {};

  const PatchLists& patches = std::as_const(fabric.own).of<PatchLists>();
  for (const gpu::Patch& patch : patches.patches) {
    const std::uint32_t* const members = patches.members.data() + patch.first_member;
    const std::uint32_t* const ends = patches.colour_ends.data() + patch.first_colour;
    for (std::uint32_t k = ends[0]; k < ends[patch.colours]; ++k) {
      const gpu::PatchLink link = gpu::unpack_patch_link(patches.links[k]);
      const std::uint32_t a = members[link.a], b = members[link.b];
      const double softness = link.compliance / (h * h), whole = weight_of(a) + weight_of(b) + softness;
      lists.patches.push_back(shifted(a, b, link.only_pulls ? 1 : 0, link.rest, whole > 0 ? softness / whole : 1, frame));
    }
  }

  // What one iteration keeps of a compliance is the gain, 1 / (w + alpha / h^2).
  const auto of_gain = [&](std::uint32_t a, std::uint32_t y, const gpu::Link& link, double weight) {
    return shifted(a, link.other, y & 0xffu, link.rest, 1 - std::min(1.0, weight * link.response), frame);
  };
  const StrandLists& strands = std::as_const(fabric.own).of<StrandLists>();
  lists.strands.resize(strands.links.size());
  std::size_t first = 0;
  for (const Range& round : strands.rounds) {
    for (std::uint32_t s = 0; s < round.count; ++s) {
      std::uint32_t here = strands.starts[round.first + s];
      for (std::size_t k = first + s; k < first + std::size_t(round.count) * WEFT_STRAND_LINKS; k += round.count) {
        const gpu::Link link = gpu::unpack_link(strands.links[k].x, strands.links[k].y);
        if (link.rest == 0) break;
        lists.strands[k] = of_gain(here, strands.links[k].y, link, weight_of(here) + weight_of(link.other));
        here = link.other;
      }
    }
    first += std::size_t(round.count) * WEFT_STRAND_LINKS;
  }

  if (strands.links.empty()) return;
  const PairRows& rows = fabric.stretch;
  lists.stretch.resize(2 * rows.pairs.size());
  for (std::uint32_t i = 0; i < fabric.positions.size(); ++i) {
    const std::size_t begin = rows.stride > 0 ? std::size_t(i) * rows.stride : rows.rows[i].x;
    const std::size_t count = rows.stride > 0 ? rows.stride : (rows.rows[i].y + 1) / 2;
    for (std::size_t k = 2 * begin; k < 2 * (begin + count); ++k) {
      const gpu::uvec4& pair = rows.pairs[k / 2];
      const gpu::uvec2 packed = k % 2 == 0 ? gpu::uvec2{pair.x, pair.y} : gpu::uvec2{pair.z, pair.w};
      const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
      if (link.rest > 0) lists.stretch[k] = of_gain(i, packed.y, link, double(fabric.split_weights[i]) + fabric.split_weights[link.other]);
    }
  }
}

}  // namespace

constinit const Effect shift{
    .name = "shift",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.solver.shifts; },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::a_way_to,
    .lay_out = lay_out,
    .hold = [](cooking::CookState& state, std::span<const Mesh>) { lay_out(state); },
};

}  // namespace weft::effects
