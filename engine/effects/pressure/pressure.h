// Pressure: closed cloth holds a gas.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

/// What the gases of a scene act on. Rings are closed walks: of each particle of a cloth with a gas the particles about it, in the
/// winding order of its triangles, until the first again. Where the triangles about a particle are several fans that only meet in it, a
/// walk goes from the first of one ring to the first of the next and back the same way, so that what lies between cancels.
struct GasLists {
  std::vector<gpu::Gas> gases;        // `parts` are laid out when all particles are known
  std::vector<gpu::GasPart> parts;
  std::vector<gpu::uvec2> rows;       // first four of a ring, number of fours
  std::vector<gpu::uvec4> rings;      // the last repeats
};

/// The largest multiple of the scene's gas that a cloth may be given.
inline constexpr double kMostGas = 1e3;

namespace lengths {
inline std::uint64_t gases(const Cooked& s) { return s.fabric.own.of<GasLists>().gases.size(); }
inline std::uint64_t gas_rows(const Cooked& s) { return s.fabric.own.of<GasLists>().rows.size(); }
inline std::uint64_t gas_parts(const Cooked& s) { return s.fabric.own.of<GasLists>().parts.size(); }
}  // namespace lengths

namespace buffers {
inline constexpr Buffer gases = own<gpu::Gas, &GasLists::gases>("gases");
inline constexpr Buffer gas_parts = own<gpu::GasPart, &GasLists::parts>("gas_parts");
inline constexpr Buffer gas_rows = own<gpu::uvec2, &GasLists::rows>("gas_rows");
inline constexpr Buffer gas_rings = own<gpu::uvec4, &GasLists::rings>("gas_rings");
/// Of each cloth, for the frame: how much gas it has, as a multiple of the scene's.
inline constexpr Buffer gas_amounts = buffer<float>("gas_amounts", Lifetime::uploaded, [](const Cooked& s) {
  return std::uint64_t(s.scene.cloths.size());
});
/// Of each gas; 0: it has done nothing yet.
inline constexpr Buffer gas_states = buffer<gpu::GasState>("gas_states", Lifetime::persistent, lengths::gases);
/// Of each row: xyz the gradient of the volume by the particle's predicted place (m^2).
inline constexpr Buffer gas_gradients = scratch<gpu::vec4>("gas_gradients", lengths::gas_rows);
inline constexpr Buffer gas_sums = scratch<gpu::GasSum>("gas_sums", lengths::gas_parts);
}  // namespace buffers
}  // namespace weft
