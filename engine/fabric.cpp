// Cooking: see fabric.h. This file puts the parts together and lays them out for the GPU.
#include "engine/fabric.h"

#include <algorithm>
#include <cmath>

#include "engine/fabric_parts.h"

namespace weft {
namespace {

using cooking::vector;

// 10 substeps keep a hung sheet of 200 x 200 vertices at 0.02 % mean and below 2 % largest strain, in the time of 28 plain C++
// passes over its links (README, "Speed").
constexpr std::uint32_t kDefaultSubsteps = 10;
// Implicit Euler is stable at any step and pays for one by its iterations: 8 ms, near the 10 ms of the system it grew out of.
constexpr std::uint32_t kImplicitSubsteps = 2;

// Substeps a frame, which springs that are too stiff for longer ones may ask for; as many as solver.substeps can say.
constexpr double kMostParts = 1000;

// Softer than this (m/N) pulls with nothing that could be seen, and its quotient by h^2 would not be finite any more: infinity
// times a multiplier of zero is no number, and takes a particle's other links along.
constexpr double kSoftest = 1e12;

// Single precision squares lengths: what is shorter counts as ends at one place (stretch.comp).
constexpr float kShortestLink = 1e-8f;   // m

// Rows of links are padded to one length where that adds no more than this: to fetch where a row begins costs as much.
constexpr double kMostPadding = 0.15;

// Mass of every point: a third of each triangle's around it.
std::vector<double> point_masses(const Mesh& mesh, double area_density) {
  std::vector<double> masses(mesh.points.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d x = vector(mesh.points[a]);
    const double area = 0.5 * (vector(mesh.points[b]) - x).cross(vector(mesh.points[c]) - x).norm();
    for (const std::uint32_t p : {a, b, c}) masses[p] += area_density * area / 3;
  }
  return masses;
}

class Cook {
 public:
  explicit Cook(const Scene& scene) : scene_(scene), softening_(relaxation_of(scene.solver) / (substep() * substep())) { fabric_.h = substep(); }

  Result<void> add(std::uint32_t index, const Mesh& mesh) {
    const Cloth& cloth = scene_.cloths[index];
    const auto first = static_cast<std::uint32_t>(fabric_.positions.size());
    if (first + mesh.points.size() > WEFT_MAX_PARTICLES)
      return fail("cloths[", index, "]: the scene's ", first + mesh.points.size(), " particles are more than ", WEFT_MAX_PARTICLES);
    auto anchors = cooking::choose_anchors(cloth, mesh);
    if (!anchors) return fail("cloths[", index, "].", anchors.error());
    const std::vector<std::uint32_t> order = cooking::locality_order(mesh);
    particle_of_.assign(mesh.points.size(), 0);
    for (std::uint32_t k = 0; k < order.size(); ++k) particle_of_[order[k]] = first + k;
    fabric_.cloths.push_back({cloth.name, first, static_cast<std::uint32_t>(mesh.points.size()),
                              static_cast<std::uint32_t>(fabric_.surface_rows.size()), static_cast<std::uint32_t>(mesh.point_of.size()),
                              static_cast<std::uint32_t>(fabric_.anchors.size()), static_cast<std::uint32_t>(anchors->size())});
    if (auto done = add_particles(index, mesh, order, *anchors); !done) return done;
    const std::size_t first_link = fabric_.links.size(), first_bend = fabric_.bends.size();
    add_links(cloth, mesh);
    if (cloth.bending && cloth.fabric.bend > 0) add_bends(cloth, mesh);
    if (on_springs(scene_.solver.method)) {
      if (auto done = add_springs(cloth, mesh, first_link, first_bend); !done) return fail("cloths[", index, "]: ", done.error());
    }
    if (cloth.tethers) add_tethers(cloth, mesh, *anchors);
    add_surface(mesh);
    fabric_.cloth_triangles = static_cast<std::uint32_t>(fabric_.triangles.size());
    return {};
  }

  // After all cloths.
  Result<void> add_contacts(std::span<const std::uint32_t> colliders, std::span<const Mesh> meshes) {
    cooking::add_rest(fabric_);
    for (std::size_t k = 0; k < colliders.size(); ++k)
      if (auto added = cooking::add_collider_mesh(scene_, colliders[k], meshes[k], fabric_); !added) return added;
    cooking::add_edges(fabric_);
    return {};
  }

  Result<CookedFabric> finish() {
    if (scene_.solver.method == Method::mass_spring || scene_.solver.method == Method::verlet)
      if (auto fits = fit_step(); !fits) return fits.take_error();
    lay_out_links();
    if (scene_.solver.method == Method::gauss_seidel) cooking::colour_links(fabric_);
    if (!fabric_.bends.empty()) lay_out_bends();
    if (!fabric_.hinges.empty()) cooking::lay_out_hinges(scene_.solver.averaging, fabric_);
    lay_out_tethers();
    if (on_springs(scene_.solver.method)) lay_out_springs();
    for (const gpu::vec4& p : fabric_.positions)
      if (!std::isfinite(p.x + p.y + p.z + p.w)) return fail("a particle's position or inverse mass is not finite: the mesh or its mass is beyond single precision");
    for (const StretchLink& link : fabric_.links)
      if (!(link.rest > kShortestLink)) return fail("a link of ", link.rest, " m is not longer than ", kShortestLink, " m: scale the mesh up");
    for (std::size_t k = 0; k < scene_.cloths.size(); ++k) cooking::take_start(scene_.cloths[k], fabric_.cloths[k], fabric_);
    return std::move(fabric_);
  }

 private:
  double substep() const { return 1 / (scene_.solver.rate * substeps_of(scene_.solver)); }

  Result<void> add_particles(std::uint32_t index, const Mesh& mesh, std::span<const std::uint32_t> order,
                             std::span<const cooking::AnchorChoice> anchors) {
    const Cloth& cloth = scene_.cloths[index];
    std::vector<double> masses = point_masses(mesh, cloth.fabric.area_density);
    if (cloth.springs && cloth.springs->mass > 0) std::fill(masses.begin(), masses.end(), cloth.springs->mass);
    for (const std::uint32_t point : order) {
      const Vec3 x = mesh.points[point];
      if (!(masses[point] > 0)) return fail("cloths[", index, "]: point ", point, " has a mass of ", masses[point], " kg; it must be above 0");
      fabric_.positions.push_back({x.x, x.y, x.z, static_cast<float>(1 / masses[point])});
      fabric_.velocities.push_back({0, 0, 0, std::bit_cast<float>(index)});
    }
    for (const auto& [entry, point, vertex] : anchors) {
      fabric_.positions[particle_of_[point]].w = 0;
      fabric_.anchors.push_back({index, entry, particle_of_[point], vertex, mesh.points[point]});
    }
    fabric_.materials.push_back({static_cast<float>(std::exp(-cloth.fabric.damping * fabric_.h)), static_cast<float>(cloth.fabric.friction),
                                 static_cast<float>(cloth.fabric.thickness), 0});
    return {};
  }

  void add_links(const Cloth& cloth, const Mesh& mesh) {
    for (const cooking::Spring& s : cooking::springs(mesh, {cloth.fabric.stretch, cloth.fabric.shear})) {
      // What the GPU will read, so that strain and reference see the same link.
      const gpu::uvec2 packed = gpu::pack_link({0, static_cast<float>(s.rest), static_cast<float>(std::min(s.compliance, kSoftest)), s.only_pulls});
      const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
      fabric_.links.push_back({particle_of_[s.a], particle_of_[s.b], link.rest, link.response, s.only_pulls, 0});
    }
  }

  void add_bends(const Cloth& cloth, const Mesh& mesh) {
    if (cloth.bend_rest == BendRest::mesh) {
      if (const auto softened = cooking::add_hinges(mesh, particle_of_, cloth.fabric.bend, fabric_); softened > 0)
        note(cloth, softened, " hinges lie on slivers; their stiffness was limited");
      return;
    }
    std::uint32_t clamped = 0;
    for (gpu::Bend bend : cooking::bend_stencils(mesh, cloth.fabric.bend, clamped)) {
      for (std::uint32_t& p : bend.particle) p = particle_of_[p];
      bend.compliance = std::min(bend.compliance, static_cast<float>(kSoftest));
      fabric_.bends.push_back(bend);
    }
    if (clamped > 0) note(cloth, clamped, " bending stencils lie on slivers; their cotangents were limited");
  }

  // The springs of the scene, or what makes the same energy as the links and bends from the given ones on.
  Result<void> add_springs(const Cloth& cloth, const Mesh& mesh, std::size_t first_link, std::size_t first_bend) {
    const bool only_pulls = scene_.solver.method == Method::verlet, straight = scene_.solver.method != Method::implicit;
    if (cloth.springs) {
      for (const auto& [a, b, rest, kind] : cooking::neighbour_springs(mesh, *cloth.springs, straight))
        fabric_.springs.push_back({particle_of_[a], particle_of_[b], static_cast<float>(rest), static_cast<float>(kind.stiffness),
                                   static_cast<float>(kind.damping), only_pulls});
      return {};
    }
    for (const StretchLink& link : std::span(fabric_.links).subspan(first_link)) {
      if (!(link.compliance > 0)) return fail("a link of ", link.rest, " m has no compliance, and the method needs springs that give way");
      fabric_.springs.push_back({link.a, link.b, link.rest, 1 / link.compliance, 0, link.only_pulls || only_pulls});
    }
    if (!only_pulls) cooking::add_bending_springs(std::span(fabric_.bends).subspan(first_bend), fabric_.springs);
    return {};
  }

  void add_tethers(const Cloth& cloth, const Mesh& mesh, std::span<const cooking::AnchorChoice> anchors) {
    if (anchors.empty()) return;
    std::vector<std::uint32_t> points;
    for (const auto& anchor : anchors) points.push_back(anchor.point);
    const auto reaches = cooking::nearest_anchors(mesh, points, cloth.tethers_per_vertex);
    std::uint32_t unreached = 0;
    tethers_.resize(fabric_.positions.size());
    for (std::uint32_t point = 0; point < reaches.size(); ++point) {
      if (fabric_.positions[particle_of_[point]].w == 0) continue;
      unreached += reaches[point].empty();
      for (const auto& [anchor, distance] : reaches[point])
        tethers_[particle_of_[point]].push_back({particle_of_[points[anchor]], static_cast<float>(distance * (1 + cloth.tether_slack))});
    }
    if (unreached > 0) note(cloth, unreached, " particles are connected to no anchor and have no tether");
  }

  void add_surface(const Mesh& mesh) {
    std::vector<std::vector<gpu::uvec2>> corners(mesh.points.size());
    for (const auto& [a, b, c] : mesh.triangles) {
      corners[a].push_back({particle_of_[b], particle_of_[c]});
      corners[b].push_back({particle_of_[c], particle_of_[a]});
      corners[c].push_back({particle_of_[a], particle_of_[b]});
      fabric_.triangles.push_back({particle_of_[a], particle_of_[b], particle_of_[c]});
    }
    std::vector<std::uint32_t> first;
    for (const auto& list : corners) {
      first.push_back(static_cast<std::uint32_t>(fabric_.corners.size()));
      fabric_.corners.insert(fabric_.corners.end(), list.begin(), list.end());
    }
    for (const std::uint32_t p : mesh.point_of)
      fabric_.surface_rows.push_back({particle_of_[p], first[p], static_cast<std::uint32_t>(corners[p].size()), 0});
  }

  void lay_out_links() {
    std::vector<std::uint32_t> uses(fabric_.positions.size());
    for (const StretchLink& link : fabric_.links) ++uses[link.a], ++uses[link.b];
    const bool split = scene_.solver.averaging == Averaging::mass_split, iterated = scene_.solver.iterations > 1;
    const bool alone = scene_.solver.method == Method::gauss_seidel || on_springs(scene_.solver.method);   // no masses are split
    for (std::size_t i = 0; i < uses.size(); ++i)
      fabric_.split_weights.push_back((split ? std::max<float>(1, static_cast<float>(uses[i])) : 1) * fabric_.positions[i].w);
    std::vector<std::vector<gpu::uvec2>> lists(fabric_.positions.size());
    for (StretchLink& link : fabric_.links) {
      const double weight = double(fabric_.split_weights[link.a]) + fabric_.split_weights[link.b];
      const double gain = weight > 0 ? 1 / (weight + link.compliance * softening_) : 0;
      const float response = iterated ? link.compliance : static_cast<float>(gain);
      const gpu::uvec2 to_b = gpu::pack_link({link.b, link.rest, response, link.only_pulls});
      lists[link.a].push_back(to_b);
      lists[link.b].push_back(gpu::pack_link({link.a, link.rest, response, link.only_pulls}));
      if (!iterated) link.gain = gpu::unpack_link(to_b.x, to_b.y).response;
    }
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const float weight = fabric_.split_weights[i], count = std::max<float>(1, static_cast<float>(uses[i]));
      fabric_.iterate_weights.push_back(alone ? fabric_.positions[i].w : iterated ? weight : split ? fabric_.positions[i].w : weight / count);
    }
    fabric_.stretch = cooking::pack_rows(lists, cooking::Padding::owner, iterated ? 0 : kMostPadding);
  }

  // Masses are split among a particle's bends as among its links; with plain averaging the counts stand in the gather alone.
  void lay_out_bends() {
    const bool split = scene_.solver.averaging == Averaging::mass_split;
    std::vector<std::uint32_t> uses(fabric_.positions.size());
    for (const gpu::Bend& bend : fabric_.bends)
      for (const std::uint32_t p : bend.particle) ++uses[p];
    std::vector<std::vector<gpu::uvec2>> shares(fabric_.positions.size());
    for (std::uint32_t e = 0; e < fabric_.bends.size(); ++e) {
      gpu::Bend& bend = fabric_.bends[e];
      double weight = 0;
      for (int j = 0; j < 4; ++j)
        weight += double(split ? uses[bend.particle[j]] : 1) * fabric_.positions[bend.particle[j]].w * bend.k[j] * bend.k[j];
      bend.split_weight = static_cast<float>(weight);
      for (int j = 0; j < 4; ++j) {
        const std::uint32_t p = bend.particle[j];
        const float share = bend.k[j] * fabric_.positions[p].w / static_cast<float>(split ? 1 : uses[p]);
        if (share != 0) shares[p].push_back({e, std::bit_cast<std::uint32_t>(share)});
      }
    }
    if (scene_.solver.iterations > 1) {
      fabric_.bend_uses = cooking::pack_rows(shares, cooking::Padding::repeated);
      return;
    }
    fabric_.bend = cooking::pack_rows(bend_matrix(shares), cooking::Padding::repeated);
  }

  // Row i of the matrix in bend.comp: M_ij = sum over stencils e of share_i(e) K_j(e) / D_e.
  std::vector<std::vector<gpu::uvec2>> bend_matrix(std::span<const std::vector<gpu::uvec2>> shares) const {
    std::vector<std::vector<gpu::uvec2>> rows(shares.size());
    std::vector<std::pair<std::uint32_t, double>> row;
    for (std::uint32_t i = 0; i < shares.size(); ++i) {
      row.clear();
      for (const auto& [e, share] : shares[i]) {
        const gpu::Bend& bend = fabric_.bends[e];
        const double scale = std::bit_cast<float>(share) / (bend.split_weight + bend.compliance * softening_);
        for (int j = 0; j < 4; ++j)
          if (bend.particle[j] != i) row.emplace_back(bend.particle[j], scale * bend.k[j]);
      }
      std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      double largest = 0;
      for (std::size_t k = 0; k < row.size();) {
        const std::uint32_t other = row[k].first;
        double sum = 0;
        for (; k < row.size() && row[k].first == other; ++k) sum += row[k].second;
        largest = std::max(largest, std::abs(sum));
        // Stencils of right angles cancel to rounding: no entry.
        if (std::abs(sum) > 1e-9 * largest) rows[i].push_back({other, std::bit_cast<std::uint32_t>(static_cast<float>(sum))});
      }
    }
    return rows;
  }

  // Divides substeps that are too long for the springs.
  Result<void> fit_step() {
    fabric_.largest_step = cooking::largest_step(fabric_.springs, fabric_.positions);
    const double wanted = fabric_.h, parts = std::ceil(wanted / fabric_.largest_step - 1e-9), substeps = parts * substeps_of(scene_.solver);
    if (!(parts > 1)) return {};
    if (substeps > kMostParts)
      return fail("solver.method: the springs and masses of this scene are stable up to substeps of ", fabric_.largest_step, " s; that makes ", substeps,
                  " a frame, more than ", kMostParts, ": take softer springs, heavier particles, a coarser mesh or a higher solver.rate");
    fabric_.h = wanted / parts;
    softening_ = relaxation_of(scene_.solver) / (fabric_.h * fabric_.h);
    for (std::size_t k = 0; k < scene_.cloths.size(); ++k)
      fabric_.materials[k].keep = static_cast<float>(std::exp(-scene_.cloths[k].fabric.damping * fabric_.h));
    fabric_.notes.push_back(fail("solver: a substep of ", 1e3 * wanted, " ms is longer than ", 1e3 * fabric_.largest_step,
                                 " ms, up to which its springs are stable: each is taken in ", parts, " parts.").message);
    return {};
  }

  void lay_out_springs() {
    fabric_.spring_rows = cooking::spring_rows(fabric_.springs, fabric_.positions.size());
    fabric_.jacobi_weight = cooking::jacobi_weight(fabric_.springs);
  }

  void lay_out_tethers() {
    std::size_t longest = 0;
    for (const auto& list : tethers_) longest = std::max(longest, list.size());
    longest += longest % 2;   // two a fetch
    fabric_.tethers_per_particle = static_cast<std::uint32_t>(longest);
    if (longest == 0) return;
    tethers_.resize(fabric_.positions.size());
    for (const auto& list : tethers_) {
      fabric_.tether_count += list.size();
      for (std::size_t k = 0; k < longest; ++k) fabric_.tethers.push_back(k < list.size() ? list[k] : gpu::Tether{WEFT_NONE, 0});
    }
  }

  template <class... Parts>
  void note(const Cloth& cloth, const Parts&... parts) {
    fabric_.notes.push_back(fail(cloth.name, ": ", parts..., ".").message);
  }

  const Scene& scene_;
  // With one iteration a substep a pass moves particles by omega / (W + s) of what a constraint asks for. Over-relaxation is meant for
  // the masses that Jacobi splits, W, and not for the cloth's compliance: omega / (W + s) = 1 / (W / omega + alpha / h^2).
  double softening_;   // 1/s^2: s / alpha, omega / h^2
  CookedFabric fabric_;
  std::vector<std::uint32_t> particle_of_;             // of the cloth at hand: point -> particle
  std::vector<std::vector<gpu::Tether>> tethers_;
};

}  // namespace

namespace cooking {

PairRows pack_rows(std::span<const std::vector<gpu::uvec2>> lists, Padding padding, double most_padding) {
  PairRows packed;
  packed.rows.reserve(lists.size());
  std::size_t longest = 0, total = 0;
  for (const auto& list : lists) {
    longest = std::max(longest, (list.size() + 1) / 2);
    total += (list.size() + 1) / 2;
  }
  const bool even = static_cast<double>(longest * lists.size()) <= (1 + most_padding) * static_cast<double>(total);
  if (most_padding > 0 && even) packed.stride = static_cast<std::uint32_t>(longest);
  for (std::uint32_t owner = 0; owner < lists.size(); ++owner) {
    const auto& list = lists[owner];
    packed.rows.push_back({static_cast<std::uint32_t>(packed.pairs.size()), static_cast<std::uint32_t>(list.size())});
    for (std::size_t k = 0; k < list.size(); k += 2) {
      const gpu::uvec2 second = k + 1 < list.size() ? list[k + 1] : gpu::uvec2{padding == Padding::owner ? owner : list[k].x, 0};
      packed.pairs.push_back({list[k].x, list[k].y, second.x, second.y});
    }
    if (packed.stride > 0) packed.pairs.resize(std::size_t(owner + 1) * packed.stride, {owner, 0, owner, 0});
  }
  return packed;
}

}  // namespace cooking

std::uint32_t substeps_of(const SolverSettings& solver) {
  if (solver.substeps > 0) return solver.substeps;
  return solver.method == Method::implicit ? kImplicitSubsteps : kDefaultSubsteps;
}

Result<std::vector<Mesh>> make_meshes(const Scene& scene) {
  std::vector<Mesh> meshes;
  for (std::size_t index = 0; index < scene.cloths.size(); ++index) {
    const Cloth& cloth = scene.cloths[index];
    if (cloth.grid) {
      meshes.push_back(make_grid(*cloth.grid));
    } else {
      auto mesh = load_mesh(scene.folder / cloth.mesh);
      if (!mesh) return fail("cloths[", index, "].mesh: ", mesh.error());
      meshes.push_back(std::move(*mesh));
    }
    transform_mesh(meshes.back(), cloth.transform);
  }
  for (const std::uint32_t index : mesh_colliders(scene)) {
    const Collider& collider = scene.colliders[index];
    auto mesh = load_mesh(scene.folder / collider.mesh);
    if (!mesh) return fail("colliders[", index, "].mesh: ", mesh.error());
    meshes.push_back(std::move(*mesh));
    transform_mesh(meshes.back(), {.translate = {}, .axis = {0, 1, 0}, .degrees = 0, .scale = collider.scale});
  }
  return meshes;
}

Result<CookedFabric> cook(const Scene& scene, std::span<const Mesh> meshes) {
  const std::vector<std::uint32_t> colliders = mesh_colliders(scene);
  const std::size_t cloths = scene.cloths.size();
  if (meshes.size() != cloths + colliders.size())
    return fail("the scene has ", cloths, " cloths and ", colliders.size(), " mesh colliders but ", meshes.size(), " meshes were given");
  if (cloths == 0) return fail("the scene has no cloth");
  // A scene that a host made has passed no reader.
  if (!(scene.solver.rate > 0) || !std::isfinite(scene.solver.rate)) return fail("solver.rate: ", scene.solver.rate, " is not above 0 (Hz)");
  if (scene.solver.iterations < 1) return fail("solver.iterations: 0 is less than 1");
  if (const std::string fault = method_fault(scene); !fault.empty()) return fail("solver.method: ", fault);
  if (const std::string fault = relaxation_fault(scene); !fault.empty()) return fail("solver.relaxation: ", fault);
  Cook cook(scene);
  for (std::uint32_t index = 0; index < cloths; ++index)
    if (auto added = cook.add(index, meshes[index]); !added) return added.take_error();
  if (contacts_on(scene))
    if (auto added = cook.add_contacts(colliders, meshes.subspan(cloths)); !added) return added.take_error();
  return cook.finish();
}

}  // namespace weft
