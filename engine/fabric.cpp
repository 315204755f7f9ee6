// Cooking: see fabric.h. Makes particles and their masses, then lets every effect cook its part.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "engine/cook/cook_state.h"
#include "engine/cook/given.h"
#include "engine/effects/effect.h"
#include "engine/effects/tear/tear.h"
#include "engine/scene/limits.h"

namespace weft {
namespace {

using cooking::CookState;
using cooking::vector;

// The most substeps a frame that stiff springs may ask for; the same limit as that of solver.substeps.
constexpr double kMostParts = 1000;

// Squares of shorter lengths are too small for single precision; stretch.comp treats such ends as coincident.
constexpr float kShortestLink = 1e-8f;   // m

// Mass of every point (kg): a third of each triangle around it, as heavy as the map says there.
std::vector<double> point_masses(const Mesh& mesh, double area_density, const std::vector<float>& factors) {
  std::vector<double> masses(mesh.points.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d x = vector(mesh.points[a]);
    const double area = 0.5 * (vector(mesh.points[b]) - x).cross(vector(mesh.points[c]) - x).norm();
    for (const std::uint32_t p : {a, b, c}) masses[p] += cooking::factor(factors, p) * area_density * area / 3;
  }
  return masses;
}

// Of a substep: exact in first order, and as the formula has it in second.
float damping_factor(const Cloth& cloth, const Scene& scene, const CookedFabric& fabric) {
  const double part = cloth.fabric.damping * solve_step(scene, fabric);
  return static_cast<float>(scene.solver.order == 2 ? 1 / (1 + part) : std::exp(-part));
}

// The materials of a cloth: one, or where maps vary it one of each kind of point.
class Materials {
 public:
  Materials(const Scene& scene, const Cloth& cloth, std::uint32_t index, const cooking::Factors& factors, CookedFabric& fabric)
      : scene_(scene), cloth_(cloth), factors_(factors), fabric_(fabric), body_(static_cast<float>(index)) {}

  /// Its index. Errors: a figure that is beyond its limit.
  Result<std::uint32_t> of(std::uint32_t point) {
    const double friction = cloth_.fabric.friction * cooking::factor(factors_.friction, point);
    const double thickness = cloth_.fabric.thickness * cooking::factor(factors_.thickness, point);
    if (const std::string fault = outside(friction, scene_fields::kFriction); !fault.empty())
      return fail("maps.friction: at point ", point, " ", fault);
    if (const std::string fault = outside(thickness, scene_fields::kThickness); !fault.empty())
      return fail("maps.thickness: at point ", point, " ", fault);
    const auto [known, is_new] =
        known_.try_emplace(std::pair(friction, thickness), static_cast<std::uint32_t>(fabric_.materials.size()));
    if (is_new)
      fabric_.materials.push_back({damping_factor(cloth_, scene_, fabric_), static_cast<float>(friction),
                                   static_cast<float>(thickness), body_});
    return known->second;
  }

 private:
  const Scene& scene_;
  const Cloth& cloth_;
  const cooking::Factors& factors_;
  CookedFabric& fabric_;
  float body_;
  std::map<std::pair<double, double>, std::uint32_t> known_;
};

Result<void> add_particles(CookState& state, std::uint32_t index, std::span<const std::uint32_t> order, const Mesh& mesh,
                           std::span<const cooking::AnchorChoice> anchors, const cooking::Factors& factors) {
  const Cloth& cloth = state.scene().cloths[index];
  CookedFabric& fabric = state.fabric();
  std::vector<double> masses = point_masses(mesh, cloth.fabric.area_density, factors.mass);
  if (cloth.springs && cloth.springs->mass > 0)
    for (std::uint32_t p = 0; p < masses.size(); ++p) masses[p] = cooking::factor(factors.mass, p) * cloth.springs->mass;
  Materials materials(state.scene(), cloth, index, factors, fabric);
  for (const std::uint32_t point : order) {
    const Vec3 x = mesh.points[point];
    if (!(masses[point] > 0))
      return fail("cloths[", index, "]: point ", point, " has a mass of ", masses[point], " kg; it must be above 0");
    fabric.positions.push_back({x.x, x.y, x.z, static_cast<float>(1 / masses[point])});
    const auto material = materials.of(point);
    if (!material) return fail("cloths[", index, "]: ", material.why());
    fabric.velocities.push_back({0, 0, 0, std::bit_cast<float>(*material)});
    if (state.may_pin()) fabric.inverse_masses.push_back(fabric.positions.back().w);
  }
  // Particles that are spare lie at the cloth's first.
  for (std::uint32_t k = 0; k < mesh.spare_points; ++k) {
    const gpu::vec4 x = fabric.positions[fabric.positions.size() - order.size() - k];
    fabric.positions.push_back({x.x, x.y, x.z, 0});
    fabric.velocities.push_back({0, 0, 0, fabric.velocities[fabric.velocities.size() - order.size() - k].w});
    if (state.may_pin()) fabric.inverse_masses.push_back(0);
  }
  for (const auto& [entry, point, vertex] : anchors) {
    fabric.positions[state.particle_of()[point]].w = 0;
    fabric.anchors.push_back({index, entry, state.particle_of()[point], vertex, mesh.points[point]});
  }
  return {};
}

// Anchors are chosen once: of two points that were one only the first is held.
Result<std::vector<cooking::AnchorChoice>> anchors_of(const Cloth& cloth, const Mesh& mesh, std::uint32_t index, const CookedFabric* whole) {
  if (whole == nullptr) return cooking::choose_anchors(cloth, mesh);
  const ClothRange& range = whole->cloths[index];
  const auto& order = whole->own.of<TearLists>().orders[index];
  std::vector<cooking::AnchorChoice> choices;
  for (std::uint32_t k = range.first_anchor; k < range.first_anchor + range.anchors; ++k) {
    const AnchorTarget& anchor = whole->anchors[k];
    const std::uint32_t own = anchor.particle - range.first_particle;
    choices.push_back({anchor.entry, own < order.size() ? order[own] : kNone, anchor.vertex});
  }
  return choices;
}

// Points in the order of their particles: as before the cloth was torn, and then those that are new.
std::vector<std::uint32_t> order_of(const Mesh& mesh, std::uint32_t index, const CookedFabric* whole) {
  if (whole == nullptr) return cooking::locality_order(mesh);
  std::vector<std::uint32_t> order = whole->own.of<TearLists>().orders[index];
  order.resize(std::min(order.size(), mesh.points.size()));
  for (auto p = static_cast<std::uint32_t>(order.size()); p < mesh.points.size(); ++p) order.push_back(p);
  return order;
}

Result<void> add_cloth(CookState& state, std::uint32_t index, const Mesh& mesh, const Mesh* render_mesh, const CookedFabric* whole) {
  const Cloth& cloth = state.scene().cloths[index];
  CookedFabric& fabric = state.fabric();
  const auto first = static_cast<std::uint32_t>(fabric.positions.size());
  const std::size_t particles = mesh.points.size() + mesh.spare_points;
  if (first + particles > WEFT_MAX_PARTICLES)
    return fail("cloths[", index, "]: the scene's ", first + particles, " particles are more than ", WEFT_MAX_PARTICLES);
  auto anchors = anchors_of(cloth, mesh, index, whole);
  if (!anchors) return fail("cloths[", index, "].", anchors.why());
  const auto factors = cooking::factors_of(cloth.maps, mesh);
  if (!factors) return fail("cloths[", index, "]: ", factors.why());
  const std::vector<std::uint32_t> order = order_of(mesh, index, whole);
  if (tears(state.scene())) fabric.own.of<TearLists>().orders.push_back(order);
  std::vector<std::uint32_t> particle_of(mesh.points.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) particle_of[order[k]] = first + k;
  state.set_particles(std::move(particle_of));
  fabric.cloths.push_back({cloth.name, first, static_cast<std::uint32_t>(particles),
                           static_cast<std::uint32_t>(fabric.surface_rows.size()), static_cast<std::uint32_t>(mesh.point_of.size()),
                           static_cast<std::uint32_t>(fabric.anchors.size()), static_cast<std::uint32_t>(anchors->size())});
  if (auto done = add_particles(state, index, order, mesh, *anchors, *factors); !done) return done;
  const cooking::ClothInput input{cloth, mesh, *anchors, *factors, render_mesh, fabric.links.size(), fabric.bends.size()};
  for (const Effect* effect : all_effects())
    if (effect->cook != nullptr)
      if (auto done = effect->cook(state, input); !done) return fail("cloths[", index, "]: ", done.why());
  return {};
}

// As they are while nothing is held, where the host may release all: the stiffest that the scene can be.
std::vector<gpu::vec4> all_free(const CookedFabric& fabric) {
  std::vector<gpu::vec4> positions = fabric.positions;
  for (std::size_t i = 0; i < fabric.inverse_masses.size(); ++i) positions[i].w = fabric.inverse_masses[i];
  return positions;
}

// Divides substeps that are too long for the springs.
Result<void> fit_substep(CookState& state) {
  const Scene& scene = state.scene();
  CookedFabric& fabric = state.fabric();
  if (scene.solver.method != Method::mass_spring && scene.solver.method != Method::verlet) return {};
  fabric.largest_step = cooking::largest_step(fabric.springs, all_free(fabric));
  const double wanted = fabric.h, parts = std::ceil(wanted / fabric.largest_step - 1e-9), substeps = parts * substeps_of(scene.solver);
  if (!(parts > 1)) return {};
  if (substeps > kMostParts)
    return fail("solver.method: the springs and masses of this scene are stable up to substeps of ", fabric.largest_step, " s; that makes ",
                substeps, " a frame, more than ", kMostParts,
                ": take softer springs, heavier particles, a coarser mesh or a higher solver.rate");
  fabric.h = wanted / parts;
  for (gpu::Material& material : fabric.materials)
    if (const auto body = static_cast<std::size_t>(material.body); body < scene.cloths.size())
      material.damping_factor = damping_factor(scene.cloths[body], scene, fabric);
  fabric.notes.push_back(fail("solver: a substep of ", 1e3 * wanted, " ms is longer than ", 1e3 * fabric.largest_step,
                               " ms, up to which its springs are stable: each is taken in ", parts, " parts.").message);
  return {};
}

Result<void> check(const CookedFabric& fabric) {
  for (const gpu::vec4& p : fabric.positions)
    if (!std::isfinite(p.x + p.y + p.z + p.w))
      return fail("a particle's position or inverse mass is not finite: the mesh or its mass is beyond single precision");
  for (const StretchLink& link : fabric.links)
    if (!(link.rest > kShortestLink))
      return fail("a link of ", link.rest, " m is not longer than ", kShortestLink, " m: scale the mesh up");
  return {};
}

Result<Mesh> grid_mesh(const Grid& grid) {
  if (const std::string fault = outside(double(grid.cells_x), scene_fields::kCells); !fault.empty()) return fail("cells[0]: ", fault);
  if (const std::string fault = outside(double(grid.cells_y), scene_fields::kCells); !fault.empty()) return fail("cells[1]: ", fault);
  if (!(grid.size.x > 0 && grid.size.y > 0)) return fail("size: ", grid.size.x, " x ", grid.size.y, " m is not above 0");
  return make_grid(grid);
}

constexpr std::uint64_t kMostImageBytes = std::uint64_t{1} << 30;

}  // namespace

Result<std::vector<Mesh>> make_meshes(const Scene& scene) { return make_meshes_with(scene, {}); }

Result<std::vector<Mesh>> make_meshes_with(const Scene& scene, const GivenMeshes& given) try {
  if (const std::string fault = size_fault(scene); !fault.empty()) return fail("cloths: ", fault);
  std::vector<Mesh> meshes;
  std::uint64_t vertices = 0;
  std::uint64_t image_bytes = 0;
  std::map<std::string, std::shared_ptr<const weft::Materials>> looks;   // of files: those who show the same one share its pictures
  const auto named = [&](const std::string& name) -> Result<Mesh> {
    const auto made = given.find(name);
    Result<Mesh> mesh = made != given.end() ? Result<Mesh>(Mesh(*made->second)) : load_mesh(scene.folder / name, scene.buffer_files);
    if (!mesh || !mesh->render.materials) return mesh;
    const auto [known, is_new] = looks.try_emplace(name, mesh->render.materials);
    mesh->render.materials = known->second;
    for (const std::string& image : known->second->images) image_bytes += is_new ? image.size() : 0;
    if (image_bytes > kMostImageBytes)
      return fail("the pictures of the scene's meshes have ", image_bytes, " bytes up to here; at most ", kMostImageBytes, " are held");
    return mesh;
  };
  // Each is looked at before the next is made.
  const auto add = [&](Mesh mesh) -> Result<void> {
    vertices += mesh.render.positions.size();
    if (double(vertices) > kMostSceneVertices)
      return fail("the scene's ", vertices, " vertices up to here are more than ", number_text(kMostSceneVertices));
    meshes.push_back(std::move(mesh));
    return {};
  };
  for (std::size_t index = 0; index < scene.cloths.size(); ++index) {
    const Cloth& cloth = scene.cloths[index];
    if (cloth.grid && !cloth.mesh.empty()) return fail("cloths[", index, "]: has both a grid and a mesh: give one of them");
    if (!cloth.grid && cloth.mesh.empty()) return fail("cloths[", index, "]: has neither a grid nor a mesh: give one of them");
    auto mesh = cloth.grid ? grid_mesh(*cloth.grid) : named(cloth.mesh);
    if (!mesh) return fail("cloths[", index, cloth.grid ? "].grid: " : "].mesh: ", mesh.why());
    if (auto added = add(std::move(*mesh)); !added) return fail("cloths[", index, "]: ", added.why());
    transform_mesh(meshes.back(), cloth.transform);
    if (auto read = cooking::add_pictures(scene.folder, cloth, meshes.back()); !read) return fail("cloths[", index, "].", read.why());
  }
  for (const std::uint32_t index : mesh_colliders(scene)) {
    const Collider& collider = scene.colliders[index];
    if (collider.mesh.empty()) return fail("colliders[", index, "]: has no \"mesh\": the file that it is made of");
    auto mesh = named(collider.mesh);
    if (!mesh) return fail("colliders[", index, "].mesh: ", mesh.why());
    if (auto added = add(std::move(*mesh)); !added) return fail("colliders[", index, "]: ", added.why());
    transform_mesh(meshes.back(), {.translate = {}, .axis = {0, 1, 0}, .degrees = 0, .scale = collider.scale});
  }
  for (const std::uint32_t index : render_meshes(scene)) {
    const Cloth& cloth = scene.cloths[index];
    auto mesh = named(cloth.render_mesh);
    if (!mesh) return fail("cloths[", index, "].render_mesh: ", mesh.why());
    if (auto added = add(std::move(*mesh)); !added) return fail("cloths[", index, "].render_mesh: ", added.why());
    transform_mesh(meshes.back(), cloth.transform);
  }
  return meshes;
} catch (...) {
  return caught("the scene's meshes");
}

// `whole`: what it was before it was torn; null: it is made for the first time.
static Result<CookedFabric> cooked(const Scene& scene, std::span<const Mesh> meshes, const CookedFabric* whole) {
  const std::vector<std::uint32_t> colliders = mesh_colliders(scene);
  const std::size_t cloths = scene.cloths.size();
  const std::vector<std::uint32_t> carriers = render_meshes(scene);
  if (meshes.size() != cloths + colliders.size() + carriers.size())
    return fail("the scene has ", cloths, " cloths, ", colliders.size(), " mesh colliders and ", carriers.size(), " render meshes but ",
                meshes.size(), " meshes were given");
  if (cloths == 0) return fail("the scene has no cloth");
  // A scene made by the host has not been checked by the reader.
  if (!(scene.solver.rate > 0) || !std::isfinite(scene.solver.rate))
    return fail("solver.rate: ", scene.solver.rate, " is not above 0 (Hz)");
  if (scene.solver.iterations < 1) return fail("solver.iterations: 0 is less than 1");
  if (const std::string fault = method_fault(scene); !fault.empty()) return fail("solver.method: ", fault);
  if (const std::string fault = order_fault(scene); !fault.empty()) return fail("solver.order: ", fault);
  if (const std::string fault = relaxation_fault(scene); !fault.empty()) return fail("solver.relaxation: ", fault);
  const auto part = [&](std::size_t k) {
    if (k < cloths) return fail("cloths[", k, "]: its mesh").message;
    if (k < cloths + colliders.size()) return fail("colliders[", colliders[k - cloths], "]: its mesh").message;
    return fail("cloths[", carriers[k - cloths - colliders.size()], "]: its render mesh").message;
  };
  for (std::size_t k = 0; k < meshes.size(); ++k)
    if (const auto good = check(meshes[k]); !good)
      return fail(part(k), ": ", good.why());
  CookState state(scene);
  const Mesh* carried = meshes.data() + cloths + colliders.size();
  for (std::uint32_t index = 0; index < cloths; ++index) {
    const Mesh* render_mesh = scene.cloths[index].render_mesh.empty() ? nullptr : carried++;
    if (auto added = add_cloth(state, index, meshes[index], render_mesh, whole); !added) return added.take_error();
  }
  for (const Effect* effect : all_effects())
    if (effect->cook_bodies != nullptr)
      if (auto added = effect->cook_bodies(state, meshes.subspan(cloths, colliders.size())); !added) return added.take_error();
  if (state.may_pin()) state.fabric().inverse_masses.resize(state.fabric().positions.size());
  if (auto fits = fit_substep(state); !fits) return fits.take_error();
  for (const Effect* effect : all_effects())
    if (effect->lay_out != nullptr) effect->lay_out(state);
  CookedFabric& fabric = state.fabric();
  if (auto good = check(fabric); !good) return good.take_error();
  for (std::size_t k = 0; k < cloths; ++k) cooking::take_start(scene.cloths[k], fabric.cloths[k], fabric);
  return std::move(fabric);
}

Result<CookedFabric> cook(const Scene& scene, std::span<const Mesh> meshes) try {
  return cooked(scene, meshes, nullptr);
} catch (...) {
  return caught("the scene's cloth");
}

Result<CookedFabric> torn_anew(const Scene& scene, std::span<const Mesh> meshes, const CookedFabric& fabric) try {
  return cooked(scene, meshes, &fabric);
} catch (...) {
  return caught("the torn cloth");
}

std::vector<std::uint32_t> render_meshes(const Scene& scene) {
  std::vector<std::uint32_t> carriers;
  for (std::uint32_t k = 0; k < scene.cloths.size(); ++k)
    if (!scene.cloths[k].render_mesh.empty()) carriers.push_back(k);
  return carriers;
}

std::uint32_t drawn_vertices(const CookedFabric& fabric) {
  std::size_t count = fabric.surface_rows.size();
  for (const CarriedMesh& mesh : fabric.render_meshes) count += mesh.vertices;
  return static_cast<std::uint32_t>(count);
}

std::uint32_t body_of(const CookedFabric& fabric, std::uint32_t particle) {
  return static_cast<std::uint32_t>(fabric.materials[std::bit_cast<std::uint32_t>(fabric.velocities[particle].w)].body);
}

std::vector<float> mean_links(const CookedFabric& fabric) {
  std::vector<double> lengths(fabric.cloths.size()), counts(fabric.cloths.size());
  for (const StretchLink& link : fabric.links) {
    const bool moves = fabric.positions[link.a].w > 0 || fabric.positions[link.b].w > 0 || !fabric.inverse_masses.empty();
    if (link.only_pulls || !moves) continue;
    const std::uint32_t cloth = body_of(fabric, link.a);
    lengths[cloth] += link.rest;
    ++counts[cloth];
  }
  std::vector<float> means;
  for (std::size_t k = 0; k < lengths.size(); ++k) means.push_back(static_cast<float>(lengths[k] / std::max(counts[k], 1.0)));
  return means;
}

CookedFabric held_anew(const Scene& scene, std::span<const Mesh> meshes, const CookedFabric& fabric, const std::vector<bool>& held) {
  CookState state(scene, fabric);
  for (std::size_t i = 0; i < held.size(); ++i) state.fabric().positions[i].w = held[i] ? 0 : fabric.inverse_masses[i];
  for (const Effect* effect : all_effects())
    if (effect->hold != nullptr) effect->hold(state, meshes);
  return std::move(state.fabric());
}

}  // namespace weft
