// Strands: straight lines of links, each solved one link after another by one thread.
#pragma once

#include <array>
#include <vector>

#include "engine/cook/parts.h"
#include "engine/effects/effect.h"

namespace weft {

/// Rounds of strands; those of a round share no particle. A round's strands lie beside each other: the first particle of strand s is
/// starts[first + s], its k-th link links[first_link + k * strands + s].
struct StrandLists {
  std::vector<Range> rounds;               // into `starts`
  std::vector<std::uint32_t> starts;       // particles
  std::vector<gpu::uvec2> links;           // gpu::pack_link to the next particle; rest 0 where the strand has ended
};

namespace cooking {

/// A cloth's strands: particles in a row, round by round.
using Strand = std::vector<std::uint32_t>;
inline constexpr std::uint32_t kStrandRounds = 2, kStrandLinks = WEFT_STRAND_LINKS;

/// Chooses them among the springs of a mesh: see engine/effects/strand/strands.cpp. Every point is in a strand of each round, if alone.
std::array<std::vector<Strand>, kStrandRounds> choose_strands(const Mesh& mesh, const std::vector<Spring>& springs);

}  // namespace cooking

namespace buffers {
inline constexpr Buffer strand_starts = own<gpu::uint, &StrandLists::starts>("strand_starts");
inline constexpr Buffer strand_links = own<gpu::uvec2, &StrandLists::links>("strand_links");
/// Multipliers of the links (kg m).
inline constexpr Buffer strand_lambda =
    scratch<float>("strand_lambda", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<StrandLists>().links.size()); });
}  // namespace buffers
}  // namespace weft
