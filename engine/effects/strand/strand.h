// Strands: straight lines of links, each solved one link after another by one thread.
#pragma once

#include <array>
#include <vector>

#include "engine/cook/parts.h"
#include "engine/effects/effect.h"
#include "engine/effects/tear/tear.h"

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
namespace detail {
/// A point that becomes two ends the strands through it, and begins others; and a split that parts cloth ends those that went across.
constexpr Buffer in_strands(Buffer row, std::uint64_t (*most)(const Cooked&)) {
  row.most = most;
  return row;
}
inline std::uint64_t most_strands(const Cooked& s) { return s.fabric.own.of<StrandLists>().starts.size() + 4 * spare_points(s.fabric); }
inline std::uint64_t most_strand_links(const Cooked& s) { return most_strands(s) * WEFT_STRAND_LINKS; }
}  // namespace detail
inline constexpr Buffer strand_starts = detail::in_strands(own<gpu::uint, &StrandLists::starts>("strand_starts"), detail::most_strands);
inline constexpr Buffer strand_links = detail::in_strands(own<gpu::uvec2, &StrandLists::links>("strand_links"), detail::most_strand_links);
/// Multipliers of the links (kg m).
inline constexpr Buffer strand_lambda = detail::in_strands(
    scratch<float>("strand_lambda", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<StrandLists>().links.size()); }),
    detail::most_strand_links);
}  // namespace buffers
}  // namespace weft
