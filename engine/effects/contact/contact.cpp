// Contacts in a substep: pairs are searched for where they are due, the candidates that touch are solved in each iteration, and the
// substep's end lets no candidate cross.
#include "engine/effects/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft {

gpu::ContactSettings contact_settings(const Scene& scene, const CookedFabric& fabric) {
  gpu::ContactSettings told{};
  if (fabric.rest.empty()) return told;
  const Contacts& wanted = scene.contacts;
  float thickness = 0;
  for (const gpu::vec4& rest : fabric.rest) thickness = std::max(thickness, rest.w);
  const double edge = fabric.mean_edge > 0 ? fabric.mean_edge : 1e-3;
  // At first short against the edges, so that a flat sheet has no candidates, and against the distance of layers that lie on each other.
  const double reach = wanted.reach > 0 ? wanted.reach : std::min(0.1 * edge, thickness > 0 ? 0.25 * thickness : edge);
  told.reach_low = static_cast<float>(reach);
  told.reach_high = static_cast<float>(std::max(4 * reach, 0.1 * edge));
  // A box is an edge long and as much thicker as detection has to look around it.
  told.cell = static_cast<float>(wanted.cell > 0 ? wanted.cell : 1.5 * edge + 2 * reach + thickness);
  // A millionth of what a particle may stray at first; contact_solve.comp says how many of them a correction can be.
  told.quantum = static_cast<float>(std::ldexp(reach, -20));
  told.recover = static_cast<float>(wanted.recover * fabric.h);
  told.patience = static_cast<float>(wanted.patience);
  told.triangles = static_cast<std::uint32_t>(fabric.triangles.size());
  told.edges = static_cast<std::uint32_t>(fabric.edges.size());
  const std::size_t primitives = fabric.triangles.size() + fabric.edges.size();
  // Neighbours in the cloth share cells, so that half as many slots are seldom taken twice.
  told.slots = static_cast<std::uint32_t>(std::bit_ceil(std::max<std::size_t>(64, primitives / 2)));
  told.capacity = wanted.capacity > 0 ? wanted.capacity : static_cast<std::uint32_t>(std::max<std::size_t>(4096, 2 * fabric.positions.size()));
  return told;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {
    &buffers::triangles,       &buffers::edges,           &buffers::rest,           &buffers::detection,    &buffers::references,
    &buffers::paths,           &buffers::leashes,         &buffers::candidates,     &buffers::grid_counts,  &buffers::grid_starts,
    &buffers::grid_totals,     &buffers::grid_entries,    &buffers::contact_normals, &buffers::contact_weights, &buffers::near_edges,
    &buffers::near_faces,      &buffers::contact_list,    &buffers::contact_counts, &buffers::contact_sums, &buffers::contact_lacks,
    &buffers::fractions,
};

// Where a detection is due; where it found pairs that are near each other; where the last one found something; and those of its candidates
// that touch, and that could cross.
constexpr Threads kDetectedParticles{lengths::particles, nullptr, offsetof(gpu::Detection, particles)};
constexpr Threads kPrimitives{lengths::primitives, nullptr, offsetof(gpu::Detection, primitives)};
constexpr Threads kSlots{lengths::slots, nullptr, offsetof(gpu::Detection, blocks)};
constexpr Threads kNearFaces{buffers::near_faces.length, nullptr, offsetof(gpu::Detection, near_faces), true};
constexpr Threads kNearEdges{buffers::near_edges.length, nullptr, offsetof(gpu::Detection, near_edges), true};
constexpr Threads kCandidates{lengths::candidates, nullptr, offsetof(gpu::Detection, contacts), true};
constexpr Threads kTouchedParticles{lengths::particles, nullptr, offsetof(gpu::Detection, touched)};
constexpr Threads kContacts{lengths::candidates, nullptr, offsetof(gpu::Detection, listed), true};
constexpr Threads kOpenCandidates{lengths::candidates, nullptr, offsetof(gpu::Detection, listed) + WEFT_OPEN * sizeof(gpu::Groups), true};

constexpr Pass kPasses[] = {
    {.name = "detect_arm", .stage = Stage::detect, .threads = threads::once},
    {.name = "detect_path", .stage = Stage::detect, .threads = kDetectedParticles},
    {.name = "grid_count", .stage = Stage::detect, .threads = kPrimitives},
    {.name = "grid_total", .stage = Stage::detect, .threads = kSlots},
    {.name = "grid_scan", .stage = Stage::detect, .threads = kSlots},
    {.name = "grid_fill", .stage = Stage::detect, .threads = kPrimitives},
    {.name = "search_faces", .stage = Stage::detect, .threads = kDetectedParticles},
    {.name = "search_edges", .stage = Stage::detect, .threads = kPrimitives},
    {.name = "search_arm", .stage = Stage::detect, .threads = threads::once},
    {.name = "pair_faces", .stage = Stage::detect, .threads = kNearFaces},
    {.name = "pair_edges", .stage = Stage::detect, .threads = kNearEdges},
    {.name = "contact_arm", .stage = Stage::detect, .threads = threads::once},
    {.name = "contact_prepare", .stage = Stage::detect, .threads = kCandidates},
    {.name = "contact_weigh", .stage = Stage::contact, .threads = kContacts},
    {.name = "contact_solve", .stage = Stage::contact, .threads = kContacts},
    {.name = "contact_apply", .stage = Stage::contact, .threads = kTouchedParticles, .collides = true},
    {.name = "contact_open", .stage = Stage::substep_end, .threads = kCandidates},
    {.name = "contact_limit", .stage = Stage::substep_end, .threads = kOpenCandidates, .rounds = WEFT_ROUNDS},
    {.name = "contact_finalize", .stage = Stage::substep_end, .threads = threads::particles},
};

Result<void> cook_bodies(cooking::CookState& state, std::span<const Mesh> collider_meshes) {
  const Scene& scene = state.scene();
  if (!contacts_on(scene)) return {};
  cooking::add_rest(state.fabric());
  const std::vector<std::uint32_t> colliders = mesh_colliders(scene);
  for (std::size_t k = 0; k < colliders.size(); ++k)
    if (auto added = cooking::add_collider_mesh(scene, colliders[k], collider_meshes[k], state.fabric()); !added) return added;
  cooking::add_edges(state.fabric());
  return {};
}

}  // namespace

constinit const Effect contact{
    .name = "contact",
    .key = "contacts",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.rest.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::has_contacts] = 1; },
    .slice = {"contact_settings", [](const Cooked& s) { return made(std::vector{s.contacts}); }},
    .reference = Reference::absent,
    .cook_bodies = cook_bodies,
};

}  // namespace effects
}  // namespace weft
