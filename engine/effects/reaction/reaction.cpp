#include "engine/effects/reaction/reaction.h"

#include <bit>
#include <cmath>

#include "engine/effects/effect.h"

namespace weft {

double reaction_quantum(const CookedFabric& fabric) {
  constexpr int kBits = 40;
  double mass = 0;
  for (const gpu::vec4& particle : fabric.positions)
    if (particle.w > 0) mass += 1 / static_cast<double>(particle.w);
  return mass > 0 ? std::ldexp(1, std::ilogb(mass) + 1 - kBits) : 1;
}

Reaction reaction_between(const gpu::Reaction& from, const gpu::Reaction& to, double quantum) {
  float parts[6];
  for (int k = 0; k < 6; ++k) {
    const auto sum = [&](const gpu::Reaction& r) { return std::uint64_t(r.high[k]) << 32 | r.low[k]; };
    parts[k] = static_cast<float>(quantum * static_cast<double>(std::bit_cast<std::int64_t>(sum(to) - sum(from))));
  }
  return {{parts[0], parts[1], parts[2]}, {parts[3], parts[4], parts[5]}};
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::reactions};

Contents settings(const Cooked& s) {
  gpu::ReactionSettings settings{};
  settings.quanta = static_cast<float>(1 / (s.fabric.h * reaction_quantum(s.fabric)));
  return made(std::vector{settings});
}

}  // namespace

constinit const Effect reaction{
    .name = "reaction",
    .key = "reactions",
    .called_for =
        [](const Scene& scene, const CookedFabric&) { return scene.reactions && scene.colliders.size() + scene.grabs > 0; },
    .buffers = kBuffers,
    .part_of_finalize = "+reaction",
    .specialize =
        [](const Cooked& s, Constants& constants) {
          constants[gpu::constant::reacts] = 1;
          constants[gpu::constant::first_mesh_body] =
              s.fabric.collider_meshes.empty() ? 0 : static_cast<std::uint32_t>(s.fabric.cloths.size());
        },
    .slice = {"reaction_settings", settings},
    .reference = Reference::absent,
};

}  // namespace effects
}  // namespace weft
