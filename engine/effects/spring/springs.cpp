// Springs of the methods implicit, mass_spring and verlet.
//
//     o o o o o    Between neighbours: structural along edges, shear along both diagonals of quads (x), and bend (o) between
//     o x s x o    all points that are two of these apart. Inside a grid these are the 24 neighbours, 5 x 5, of the particle
//     o s . s o    system of 2006; on other meshes they follow the edges.
//     o x s x o
//     o o o o o
//
// Without `springs` in the scene: the energy that the other methods solve, every link as a spring, and the isometric bending
// energy, whose matrix M is constant. As its rows sum to zero,
//     1/2 sum M_ij x_i . x_j = 1/2 sum over i < j of -M_ij |x_i - x_j|^2:
// springs of rest length 0 and of either sign, together positive semidefinite.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/cook/parts.h"

namespace weft::cooking {

std::vector<NeighbourSpring> neighbour_springs(const Mesh& mesh, const weft::Springs& springs, bool straight) {
  std::vector<NeighbourSpring> made;
  std::vector<std::vector<std::uint32_t>> near(mesh.points.size());
  const auto add = [&](std::uint32_t a, std::uint32_t b, const weft::Springs::Kind& kind) {
    if (kind.stiffness > 0) made.push_back({a, b, (vector(mesh.points[a]) - vector(mesh.points[b])).norm(), kind});
  };
  std::vector<Spring> links = cooking::springs(mesh, {1, 1});
  for (const Spring& link : links) {
    if (link.kind == Spring::Kind::far) continue;
    near[link.a].push_back(link.b);
    near[link.b].push_back(link.a);
    add(link.a, link.b, link.kind == Spring::Kind::edge ? springs.structural : springs.shear);
  }
  if (straight) {
    // add_far_links wants the mesh's edges first; only the far links that it appends are used.
    std::vector<bool> is_diagonal;
    links.resize(mesh.edges.size());
    for (const Spring& edge : links) is_diagonal.push_back(edge.kind == Spring::Kind::diagonal);
    add_far_links(mesh, is_diagonal, 2, links);
    for (std::size_t k = mesh.edges.size(); k < links.size(); ++k) add(links[k].a, links[k].b, springs.bend);
    return made;
  }
  std::vector<std::uint32_t> two_on;
  for (std::uint32_t a = 0; a < near.size(); ++a) {
    two_on.clear();
    for (const std::uint32_t middle : near[a])
      for (const std::uint32_t b : near[middle])
        if (b > a && std::find(near[a].begin(), near[a].end(), b) == near[a].end()) two_on.push_back(b);
    std::sort(two_on.begin(), two_on.end());
    two_on.erase(std::unique(two_on.begin(), two_on.end()), two_on.end());
    for (const std::uint32_t b : two_on) add(a, b, springs.bend);
  }
  return made;
}

void add_bending_springs(std::span<const gpu::Bend> bends, std::vector<ParticleSpring>& springs) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> matrix;   // above the diagonal
  double largest = 0;
  for (const gpu::Bend& bend : bends)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        double& entry = matrix[std::minmax(bend.particle[i], bend.particle[j])];
        entry += double(bend.k[i]) * bend.k[j] / bend.compliance;
        largest = std::max(largest, std::abs(entry));
      }
  // Entries that cancel but for rounding, as on right angles, are left out.
  for (const auto& [pair, entry] : matrix)
    if (std::abs(entry) > 1e-9 * largest) springs.push_back({pair.first, pair.second, 0, static_cast<float>(-entry), 0, false});
}

// 4/3 over the bound on the eigenvalues, which is 4 with stencils of four particles and 2 without: see engine/reference/implicit.h.
double jacobi_weight(std::span<const ParticleSpring> springs) {
  const bool stencils = std::any_of(springs.begin(), springs.end(), [](const ParticleSpring& s) { return s.rest == 0; });
  return stencils ? 1.0 / 3 : 2.0 / 3;
}

SpringRows spring_rows(std::span<const ParticleSpring> springs, std::size_t particles) {
  std::vector<std::vector<std::pair<std::uint32_t, gpu::vec4>>> lists(particles);
  for (const ParticleSpring& spring : springs) {
    const gpu::vec4 figures{spring.rest, spring.stiffness, spring.damping, spring.only_pulls ? 1.0f : 0.0f};
    lists[spring.a].emplace_back(spring.b, figures);
    lists[spring.b].emplace_back(spring.a, figures);
  }
  SpringRows packed;
  for (std::uint32_t owner = 0; owner < particles; ++owner) {
    auto& list = lists[owner];
    // Sorted by the other end: neighbours in the cloth are neighbours in memory, so fetches go forward.
    std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    list.resize((list.size() + 3) / 4 * 4, {owner, {0, 0, 0, 0}});
    packed.rows.push_back({static_cast<std::uint32_t>(packed.ends.size()), static_cast<std::uint32_t>(list.size() / 4)});
    for (std::size_t k = 0; k < list.size(); k += 4) {
      packed.ends.push_back({list[k].first, list[k + 1].first, list[k + 2].first, list[k + 3].first});
      for (std::size_t c = k; c < k + 4; ++c) packed.springs.push_back(list[c].second);
    }
  }
  return packed;
}

}  // namespace weft::cooking
