// Distance constraints, solved by Gauss-Seidel in patches.
#pragma once

#include <vector>

#include "engine/effects/effect.h"

namespace weft {

/// What patches.cpp makes: patches round after round, and what they have, patch after patch.
struct PatchLists {
  std::vector<gpu::Patch> patches;
  std::vector<Range> rounds;               // into `patches`
  std::vector<std::uint32_t> members;      // particles
  std::vector<std::uint32_t> colour_ends;  // into `links`; in front of all others a 0
  std::vector<gpu::uvec2> links;           // gpu::pack_patch_link, without those between two particles that are held for good
};

namespace cooking {
/// Cuts the links into patches: see engine/effects/gauss_seidel/patches.cpp.
void make_patches(CookedFabric& fabric);
}  // namespace cooking

namespace lengths {
inline std::uint64_t patch_links(const Cooked& s) { return s.fabric.own.of<PatchLists>().links.size(); }
}  // namespace lengths

namespace buffers {
inline constexpr Buffer patches = own<gpu::Patch, &PatchLists::patches>("patches");
inline constexpr Buffer patch_members = own<gpu::uint, &PatchLists::members>("patch_members");
inline constexpr Buffer patch_colour_ends = own<gpu::uint, &PatchLists::colour_ends>("patch_colour_ends");
inline constexpr Buffer patch_links = own<gpu::uvec2, &PatchLists::links>("patch_links");
/// Multipliers of the links (kg m).
inline constexpr Buffer patch_lambda = scratch<float>("patch_lambda", lengths::patch_links);
}  // namespace buffers
}  // namespace weft
