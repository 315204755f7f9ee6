// Bending about the dihedral angles that a mesh has at rest (Bridson et al. 2003).
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

struct DihedralLists {
  PairRows uses;   // entries: (4 hinge + which of its particles, w bits)
};

namespace lengths {
inline std::uint64_t hinges(const Cooked& s) { return s.fabric.hinges.size(); }
}  // namespace lengths

namespace buffers {
/// Dihedral elements, one an inner edge (the hinge).
inline constexpr Buffer hinges = cooked<gpu::Hinge, &CookedFabric::hinges>("hinges");
/// Four a dihedral element, one for each of its particles: xyz gradient times change of the multiplier; w of the first: the
/// multiplier.
inline constexpr Buffer hinge_impulses = scratch<gpu::vec4>("hinge_impulses", [](const Cooked& s) { return 4 * lengths::hinges(s); });
/// Of each particle: first pair of uses, number of uses.
inline constexpr Buffer hinge_use_rows = own<gpu::uvec2, &DihedralLists::uses, &PairRows::rows>("hinge_use_rows");
/// (4 x element + which of its particles, inverse mass as float bits) twice.
inline constexpr Buffer hinge_uses = own<gpu::uvec4, &DihedralLists::uses, &PairRows::pairs>("hinge_uses");
}  // namespace buffers
}  // namespace weft
