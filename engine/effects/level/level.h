// Coarse levels: what is long in a pull is carried over nodes that are far apart, level by level, before the links of the cloth.
#pragma once

#include <vector>

#include "engine/effects/buffer.h"
#include "engine/effects/effect.h"

namespace weft {

struct LevelLists {
  std::vector<gpu::uvec4> nodes;           // gpu::pack_level_node, coarsest level first; and one more, where the last one's gathers end
  std::vector<gpu::uvec2> gathers;         // gpu::pack_level_gather, of each node, one after another; the first has what the others leave
  std::vector<gpu::uvec4> node_shares;     // of each in the next coarser level's: gpu::pack_level_share; x WEFT_NONE: there is none
  std::vector<std::uint32_t> ends;         // of each level, into `nodes`
  std::vector<gpu::uvec4> links;           // gpu::pack_level_link, of each node, one after another: each link from both of its ends
  std::vector<gpu::uvec4> shares;          // of each particle in the finest level's nodes: gpu::pack_level_share
  std::uint32_t low = 0;                   // how many levels one workgroup does
};

/// Which nodes the passes of levels go through.
namespace levels {
std::uint64_t nodes(const Cooked& s);
std::uint64_t low(const Cooked& s);               // how many levels one workgroup does
bool has_wide(const Needs& needs);                // levels that it does not
std::vector<Range> finest(const Cooked& s);
std::vector<Range> wide(const Cooked& s);         // a range a level, coarsest first
std::vector<Range> wide_but_finest(const Cooked& s);   // finest first
}  // namespace levels

namespace buffers {
inline constexpr Buffer level_nodes = own<gpu::uvec4, &LevelLists::nodes>("level_nodes");
inline constexpr Buffer level_gathers = own<gpu::uvec2, &LevelLists::gathers>("level_gathers");
inline constexpr Buffer level_node_shares = own<gpu::uvec4, &LevelLists::node_shares>("level_node_shares");
inline constexpr Buffer level_ends = own<gpu::uint, &LevelLists::ends>("level_ends");
inline constexpr Buffer level_links = own<gpu::uvec4, &LevelLists::links>("level_links");
inline constexpr Buffer level_shares = own<gpu::uvec4, &LevelLists::shares>("level_shares");
/// xyz: the centre of mass of what each node carries (m); w: beside contacts, the part of what is near it that has candidates.
inline constexpr Buffer level_centres =
    scratch<gpu::vec4>("level_centres", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// The mean of the nearest of it, between which lengths are measured (m).
inline constexpr Buffer level_middles =
    scratch<gpu::vec4>("level_middles", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// How far coarser levels carry each node of the low levels (m).
inline constexpr Buffer level_carried = scratch<gpu::vec4>("level_carried", [](const Cooked& s) {
  const LevelLists& lists = s.fabric.own.of<LevelLists>();
  return std::uint64_t(lists.low > 0 ? lists.ends[lists.low - 1] : 1);
});
/// How far each node goes in this iteration, with what it was carried (m).
inline constexpr Buffer level_steps =
    scratch<gpu::vec4>("level_steps", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// Multipliers of `level_links` (kg m).
inline constexpr Buffer level_lambda =
    scratch<float>("level_lambda", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().links.size()); });
}  // namespace buffers
}  // namespace weft
