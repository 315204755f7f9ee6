// Morph targets of skins as the GPU has them: the deltas of each point one after another, only where there are any; and where points find
// their places in a host's buffer.
#include <algorithm>

#include "engine/effects/skin/skin.h"

namespace weft {

void add_deltas(const Mesh& mesh, const SkinnedMesh& skinned, std::span<const std::uint32_t> point_order, bool with_normals,
                SkinLists& lists) {
  struct Place {
    std::uint32_t morph;
    std::size_t delta;   // of its own
  };
  std::vector<std::vector<Place>> of_point(skinned.morphs > 0 ? mesh.points.size() : 0);
  for (std::uint32_t m = 0; m < skinned.morphs; ++m)
    for (std::size_t k = 0; k < mesh.skin->morphs[m].points.size(); ++k) of_point[mesh.skin->morphs[m].points[k]].push_back({m, k});
  for (const std::uint32_t point : point_order) {
    const auto first = static_cast<std::uint32_t>(lists.morph_deltas.size());
    for (const Place& place : of_point.empty() ? std::vector<Place>() : of_point[point]) {
      const Skin::Morph& morph = mesh.skin->morphs[place.morph];
      const Vec3 d = morph.deltas[place.delta];
      const Vec3 n = with_normals && !morph.normal_deltas.empty() ? morph.normal_deltas[place.delta] : Vec3{};
      lists.morph_deltas.push_back({skinned.first_morph + place.morph, {d.x, d.y, d.z}});
      lists.morph_normals.push_back({n.x, n.y, n.z});
    }
    lists.morph_rows.push_back({first, static_cast<std::uint32_t>(lists.morph_deltas.size()) - first});
  }
}

void add_targets(const Mesh& mesh, const SkinnedMesh& skinned, std::uint32_t number, std::span<const std::uint32_t> point_order,
                 SkinLists& lists) {
  std::vector<std::uint32_t> first(mesh.points.size());   // render vertex of each point
  for (std::size_t v = mesh.point_of.size(); v-- > 0;) first[mesh.point_of[v]] = static_cast<std::uint32_t>(v);
  for (const std::uint32_t point : point_order)
    lists.target_rows.push_back({skinned.targets > 0 ? skinned.first_target + first[point] : WEFT_NONE, number});
}

void keep(SkinLists& lists, bool (*is_kept)(const gpu::SkinPoint&)) {
  const SkinLists all = lists;
  lists.points.clear(), lists.morph_rows.clear(), lists.morph_deltas.clear(), lists.morph_normals.clear(), lists.target_rows.clear();
  for (std::size_t k = 0; k < all.points.size(); ++k) {
    if (!is_kept(all.points[k])) continue;
    const auto [from, count] = all.morph_rows[k];
    lists.points.push_back(all.points[k]);
    if (all.targets > 0) lists.target_rows.push_back(all.target_rows[k]);
    lists.morph_rows.push_back({static_cast<std::uint32_t>(lists.morph_deltas.size()), count});
    for (std::uint32_t at = from; at < from + count; ++at) {
      lists.morph_deltas.push_back(all.morph_deltas[at]);
      lists.morph_normals.push_back(all.morph_normals[at]);
    }
  }
  if (lists.morph_deltas.empty()) lists.morph_rows.clear();
  if (std::ranges::none_of(lists.morph_normals, [](const gpu::vec3& n) { return n.x != 0 || n.y != 0 || n.z != 0; }))
    lists.morph_normals.clear();
}

gpu::SkinPoint morphed(const SkinLists& lists, std::size_t point, std::span<const float> weights) {
  gpu::SkinPoint there = lists.points[point];
  if (lists.morph_rows.empty()) return there;
  const auto add = [](gpu::vec3& to, float weight, const gpu::vec3& delta) {
    to = {to.x + weight * delta.x, to.y + weight * delta.y, to.z + weight * delta.z};
  };
  const auto [first, count] = lists.morph_rows[point];
  for (std::uint32_t at = first; at < first + count; ++at) {
    const gpu::MorphDelta& delta = lists.morph_deltas[at];
    add(there.rest, weights[delta.morph], delta.position);
    if (!lists.morph_normals.empty()) add(there.normal, weights[delta.morph], lists.morph_normals[at]);
  }
  return there;
}

}  // namespace weft
