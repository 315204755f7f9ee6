// Clusters of triangles, by recursive bisection at the median of their middles in the rest pose, along the longest side of what is left.
#include "engine/effects/contact/clusters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <span>

#include "engine/cook/parts.h"
#include "engine/effects/contact/smooth.h"

namespace weft::cooking {
namespace {

constexpr std::uint32_t kNoCluster = WEFT_NONE;

class Bisection {
 public:
  explicit Bisection(const CookedFabric& fabric) : fabric_(fabric), cluster_of_(fabric.triangles.size(), kNoCluster) {
    for (const Triangle& t : fabric.triangles) middles_.push_back((at(t[0]) + at(t[1]) + at(t[2])) / 3);
  }

  /// The cluster of each triangle.
  std::vector<std::uint32_t> clusters() {
    std::vector<std::uint32_t> order(fabric_.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    const auto body = [&](std::uint32_t t) { return body_of(fabric_, fabric_.triangles[t][0]); };
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return body(a) < body(b); });
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
      while (end < order.size() && body(order[end]) == body(order[first])) ++end;
      split(std::span(order).subspan(first, end - first));
    }
    return std::move(cluster_of_);
  }

 private:
  Eigen::Vector3d at(std::uint32_t i) const { return {fabric_.rest[i].x, fabric_.rest[i].y, fabric_.rest[i].z}; }

  void split(std::span<std::uint32_t> triangles) {
    if (triangles.size() <= WEFT_CLUSTER) {
      name_pieces(triangles);
      return;
    }
    Eigen::AlignedBox3d box;
    for (const std::uint32_t t : triangles) box.extend(middles_[t]);
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
    std::nth_element(triangles.begin(), middle, triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
      return middles_[a][axis] != middles_[b][axis] ? middles_[a][axis] < middles_[b][axis] : a < b;
    });
    split(triangles.first(triangles.size() / 2));
    split(triangles.subspan(triangles.size() / 2));
  }

  // What does not hang together may part, and one box about it would grow without need: a cluster for each piece.
  void name_pieces(std::span<const std::uint32_t> triangles) {
    for (const std::uint32_t first : triangles) {
      if (cluster_of_[first] != kNoCluster) continue;
      std::vector<std::uint32_t> piece{first};
      cluster_of_[first] = count_;
      for (std::size_t k = 0; k < piece.size(); ++k)
        for (const std::uint32_t t : triangles)
          if (cluster_of_[t] == kNoCluster && share_a_particle(t, piece[k])) {
            cluster_of_[t] = count_;
            piece.push_back(t);
          }
      ++count_;
    }
  }

  bool share_a_particle(std::uint32_t a, std::uint32_t b) const {
    const Triangle& s = fabric_.triangles[a];
    return std::ranges::any_of(fabric_.triangles[b], [&](std::uint32_t i) { return i == s[0] || i == s[1] || i == s[2]; });
  }

  const CookedFabric& fabric_;
  std::vector<Eigen::Vector3d> middles_;
  std::vector<std::uint32_t> cluster_of_;
  std::uint32_t count_ = 0;
};

template <class T>
void sort_by_cluster(std::vector<T>& members, std::uint32_t T::*cluster) {
  std::stable_sort(members.begin(), members.end(), [&](const T& a, const T& b) { return a.*cluster < b.*cluster; });
}

std::vector<std::uint32_t> memberships(const ClusterLists& lists, const std::vector<std::uint32_t>& owner) {
  std::vector<std::vector<std::uint32_t>> clusters(owner.size());
  for (std::uint32_t i = 0; i < owner.size(); ++i) clusters[i].push_back(owner[i]);
  for (std::uint32_t k = 0; k + 1 < lists.clusters.size(); ++k)
    for (std::uint32_t h = lists.clusters[k].z; h < lists.clusters[k + 1].z; ++h)
      if (owner[lists.hulls[h]] != k) clusters[lists.hulls[h]].push_back(k);
  std::vector<std::uint32_t> list{static_cast<std::uint32_t>(owner.size() + 1)};
  for (const auto& of_particle : clusters) list.push_back(list.back() + static_cast<std::uint32_t>(of_particle.size()));
  for (const auto& of_particle : clusters) list.insert(list.end(), of_particle.begin(), of_particle.end());
  return list;
}

}  // namespace

ClusterLists make_clusters(const CookedFabric& fabric) {
  ClusterLists lists;
  const std::vector<std::uint32_t> cluster_of = Bisection(fabric).clusters();
  std::uint32_t count = cluster_of.empty() ? 0 : *std::ranges::max_element(cluster_of) + 1;
  std::vector<std::uint32_t> owner(fabric.positions.size(), kNoCluster);
  for (std::size_t t = 0; t < cluster_of.size(); ++t) {
    const Triangle& corner = fabric.triangles[t];
    lists.faces.push_back({corner[0], corner[1], corner[2], cluster_of[t]});
    for (const std::uint32_t i : corner) owner[i] = std::min(owner[i], cluster_of[t]);
  }
  // The cluster of an edge has one of its triangles, so its hull both ends: the least that both ends' triangles have in common.
  for (const gpu::uvec2 edge : fabric.edges) lists.edges.push_back({edge.x, edge.y, kNoCluster, 0});
  const auto key = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); };
  std::sort(lists.edges.begin(), lists.edges.end(), [&](const auto& a, const auto& b) { return key(a.x, a.y) < key(b.x, b.y); });
  std::vector<std::uint32_t> faces_of(lists.edges.size());
  for (const gpu::uvec4& face : lists.faces)
    for (const auto& [a, b, third] : {std::array{face.x, face.y, face.z}, {face.y, face.z, face.x}, {face.z, face.x, face.y}}) {
      const auto edge = std::lower_bound(lists.edges.begin(), lists.edges.end(), key(a, b),
                                         [&](const gpu::uvec4& e, std::uint64_t k) { return key(e.x, e.y) < k; });
      if (edge == lists.edges.end() || key(edge->x, edge->y) != key(a, b)) continue;
      edge->z = std::min(edge->z, face.w);
      edge->w = ++faces_of[static_cast<std::size_t>(edge - lists.edges.begin())] == 1 ? third + 1 : 0;
    }
  // Particles without a triangle, by locality.
  std::uint32_t loose = 0;
  for (std::uint32_t& cluster : owner)
    if (cluster == kNoCluster) cluster = count + loose++ / WEFT_CLUSTER;
  count += (loose + WEFT_CLUSTER - 1) / WEFT_CLUSTER;

  for (std::uint32_t i = 0; i < owner.size(); ++i) lists.searchers.push_back({i, owner[i]});
  sort_by_cluster(lists.faces, &gpu::uvec4::w);
  sort_by_cluster(lists.edges, &gpu::uvec4::z);
  sort_by_cluster(lists.searchers, &gpu::uvec2::y);
  std::size_t face = 0, edge = 0, searcher = 0;
  const auto begin_cluster = [&] {
    const auto number = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    lists.clusters.push_back({number(face), number(edge), number(lists.hulls.size()), 0});
  };
  for (std::uint32_t k = 0; k < count; ++k) {
    begin_cluster();
    std::vector<std::uint32_t> hull;
    for (; face < lists.faces.size() && lists.faces[face].w == k; ++face)
      hull.insert(hull.end(), {lists.faces[face].x, lists.faces[face].y, lists.faces[face].z});
    while (edge < lists.edges.size() && lists.edges[edge].z == k) ++edge;
    for (; searcher < lists.searchers.size() && lists.searchers[searcher].y == k; ++searcher) hull.push_back(lists.searchers[searcher].x);
    std::ranges::sort(hull);
    hull.erase(std::unique(hull.begin(), hull.end()), hull.end());
    lists.hulls.insert(lists.hulls.end(), hull.begin(), hull.end());
  }
  begin_cluster();
  lists.memberships = memberships(lists, owner);
  find_surroundings(fabric, lists);
  return lists;
}

}  // namespace weft::cooking
