// The contact passes of a substep. Detection (broad and narrow phase) runs where candidates are needed anew; active
// candidates are solved in each iteration; at the substep's end conservative advancement lets no candidate cross.
#include "engine/effects/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "compute/text.h"
#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft {

constexpr std::size_t kUsualRoom = 2'000'000;   // candidate pairs: a hundred megabytes

gpu::ContactSettings contact_settings(const Scene& scene, const CookedFabric& fabric) {
  gpu::ContactSettings settings{};
  if (fabric.rest.empty()) return settings;
  const Contacts& wanted = scene.contacts;
  float thickness = 0;
  for (const gpu::vec4& rest : fabric.rest) thickness = std::max(thickness, rest.w);
  const double edge = fabric.mean_edge > 0 ? fabric.mean_edge : 1e-3;
  // The margin starts well below the edge length, so that a flat sheet has no candidates, and well below the distance of
  // resting layers.
  const double margin =
      wanted.detection_margin > 0 ? wanted.detection_margin : std::min(0.1 * edge, thickness > 0 ? 0.25 * thickness : edge);
  settings.margin_low = static_cast<float>(margin);
  // A flat sheet has none with the largest bounds, either: a corner is 0.7 edges from the diagonal of its cell. Where cloth that
  // falls freely is finer than that it would have dozens a particle: its bounds grow as gravity bends trajectories, for all alike.
  const double apart = 0.35 * (0.7 * edge - thickness), most = std::max(4 * margin, 0.1 * edge);
  settings.margin_high = static_cast<float>(wanted.detection_margin > 0 ? most : std::clamp(apart, margin, most));
  // The box of a cluster: as many edges long as its triangles lie side by side, and enlarged by the detection margin and the thickness.
  settings.cell = static_cast<float>(wanted.cell > 0 ? wanted.cell : 4.5 * edge + 2 * margin + thickness);
  // A millionth of the first displacement bound; contact_solve.comp says how many quanta a correction may have.
  settings.quantum = static_cast<float>(std::ldexp(margin, -20));
  settings.recover = static_cast<float>(wanted.recover * fabric.h);
  settings.kinematic_lag_limit = static_cast<float>(wanted.kinematic_lag_limit);
  const ClusterLists& lists = fabric.own.of<ClusterLists>();
  settings.particles = static_cast<std::uint32_t>(fabric.positions.size());
  settings.iterations = wanted.iterations;
  settings.triangles = static_cast<std::uint32_t>(lists.faces.size());
  settings.edges = static_cast<std::uint32_t>(lists.edges.size());
  settings.clusters = static_cast<std::uint32_t>(lists.clusters.empty() ? 0 : lists.clusters.size() - 1);
  settings.buckets = std::bit_ceil(std::max(64u, 2 * settings.clusters));
  settings.tangled_room = std::bit_ceil(std::max(1024u, 4 * settings.particles));
  // Room for cloth that crumples, as far as every device has the memory.
  const std::size_t particles = fabric.positions.size();
  const std::size_t room = std::max({std::size_t{1} << 16, std::min(32 * particles, kUsualRoom), 2 * particles});
  settings.capacity = wanted.capacity > 0 ? wanted.capacity : static_cast<std::uint32_t>(std::min<std::size_t>(room, kMostCandidates));
  return settings;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {
    &buffers::clusters, &buffers::cluster_faces, &buffers::cluster_edges, &buffers::cluster_searchers, &buffers::cluster_hulls,
    &buffers::memberships, &buffers::cluster_surroundings, &buffers::clusters_around, &buffers::cluster_boxes,
    &buffers::cluster_pushes, &buffers::near_bounds, &buffers::cluster_motions, &buffers::smooth_clusters, &buffers::near_clusters,
    &buffers::near_boxes, &buffers::outlines, &buffers::outline_boxes,
    &buffers::rest, &buffers::detection, &buffers::detected_positions, &buffers::trajectories, &buffers::displacement_bounds,
    &buffers::candidates, &buffers::grid_counts, &buffers::grid_starts, &buffers::grid_entries, &buffers::contact_normals,
    &buffers::contact_weights, &buffers::near_edges, &buffers::near_faces, &buffers::contact_list, &buffers::touched_particles,
    &buffers::contact_counts, &buffers::contact_sums, &buffers::contact_penetrations, &buffers::slides, &buffers::kinematic_lags,
    &buffers::step_fractions, &buffers::contact_masks,
};

// Indirect dispatches, in the order of the passes: a detection, where one is needed; the pairs of its broad phase; its
// candidates; the active ones and their particles; the unsafe ones; all particles, where there are candidates.
constexpr Threads kOutlined{lengths::outlined, nullptr, {&buffers::detection, offsetof(gpu::Detection, outlined)}};
constexpr Threads kGrid{lengths::clusters, lengths::one, {&buffers::detection, offsetof(gpu::Detection, grid)}};
constexpr Threads kClusters{lengths::clusters, nullptr, {&buffers::detection, offsetof(gpu::Detection, clusters)}};
constexpr Threads kDetectedParticles{lengths::particles, nullptr, {&buffers::detection, offsetof(gpu::Detection, particles)}};
constexpr Threads kFaces{lengths::triangles, nullptr, {&buffers::detection, offsetof(gpu::Detection, faces)}};
constexpr Threads kSearchers{[](const Cooked& s) { return lengths::particles(s) + lengths::edges(s); }, nullptr,
                             {&buffers::detection, offsetof(gpu::Detection, searchers)}};
constexpr Threads kRare{kSearchers.count, nullptr, {&buffers::detection, offsetof(gpu::Detection, rare)}};
constexpr Threads kPrepared{kSearchers.count, nullptr, {&buffers::detection, offsetof(gpu::Detection, prepared)}};
constexpr Threads kNearPairs{buffers::near_faces.length, nullptr, {&buffers::detection, offsetof(gpu::Detection, near_pairs)}, true};
constexpr Threads kEdges{lengths::edges, nullptr, {&buffers::detection, offsetof(gpu::Detection, edges)}};
constexpr Threads kNearFaces{buffers::near_faces.length, nullptr, {&buffers::detection, offsetof(gpu::Detection, near_faces)}, true};
constexpr Threads kNearEdges{buffers::near_edges.length, nullptr, {&buffers::detection, offsetof(gpu::Detection, near_edges)}, true};
constexpr Threads kCandidates{lengths::candidates, nullptr, {&buffers::detection, offsetof(gpu::Detection, contacts)}, true};
constexpr Threads kTouchedParticles{lengths::particles, nullptr, {&buffers::detection, offsetof(gpu::Detection, touched)}};
constexpr Threads kContacts{lengths::candidates, nullptr, {&buffers::detection, offsetof(gpu::Detection, listed)}, true};
constexpr Threads kPenetrating{lengths::candidates, nullptr,
                               {&buffers::detection, offsetof(gpu::Detection, listed) + WEFT_PENETRATING * sizeof(gpu::Groups)}, true};
constexpr Threads kPairedParticles{lengths::particles, nullptr, {&buffers::detection, offsetof(gpu::Detection, paired)}};
constexpr Threads kContactsAlone{lengths::particles, lengths::one, {&buffers::detection, offsetof(gpu::Detection, alone)}};
constexpr Threads kUnsafeCandidates{lengths::candidates, nullptr,
                                    {&buffers::detection, offsetof(gpu::Detection, listed) + WEFT_UNSAFE * sizeof(gpu::Groups)}, true};

// Devices that bind fewer buffers to a pass do without what one workgroup does instead of six passes.
bool binds_all(const Needs& needs) { return needs.storage_buffers >= (needs.constants[gpu::constant::through_texels] != 0 ? 18 : 28); }

// Where idle threads cost, as on the software driver, a shader that does what several do costs more than their dispatches; and it takes
// seconds to compile there, and the loops of one workgroup would be too long (WEFT_MOST_TURNS).
bool unites_all(const Needs& needs) { return binds_all(needs) && needs.constants[gpu::constant::idle_costs] == 0; }
bool keeps_apart(const Needs& needs) { return !unites_all(needs); }

constexpr Pass kPasses[] = {
    {.name = "detect_alone", .stage = Stage::detect, .threads = threads::once, .crowd = Crowd::seldom, .when = unites_all, .alone = true,
     .crew = true},
    {.name = "detect_arguments", .stage = Stage::detect, .threads = threads::once, .crowd = Crowd::decided, .alone = true},
    {.name = "detect_track", .stage = Stage::detect, .threads = kDetectedParticles, .crowd = Crowd::often},
    {.name = "cluster_box", .stage = Stage::detect, .threads = kClusters, .crowd = Crowd::often, .thin = true},
    {.name = "grid_fill", .stage = Stage::detect, .threads = kGrid, .crowd = Crowd::often, .alone = true, .crew = true},
    {.name = "grid_search", .stage = Stage::detect, .threads = kClusters, .crowd = Crowd::often, .thin = true},
    {.name = "detect_outline", .stage = Stage::detect, .threads = kOutlined, .crowd = Crowd::often, .when = unites_all},
    {.name = "outline_particles", .stage = Stage::detect, .threads = kDetectedParticles, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "outline_faces", .stage = Stage::detect, .threads = kFaces, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "outline_edges", .stage = Stage::detect, .threads = kEdges, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "search_faces", .stage = Stage::detect, .threads = kDetectedParticles, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "search_edges", .stage = Stage::detect, .threads = kEdges, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "search_rare", .stage = Stage::detect, .threads = kRare, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "pair_faces", .stage = Stage::detect, .threads = kNearFaces, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "pair_edges", .stage = Stage::detect, .threads = kNearEdges, .crowd = Crowd::sought, .when = keeps_apart},
    {.name = "detect_search", .stage = Stage::detect, .threads = kSearchers, .crowd = Crowd::stirred, .when = unites_all},
    {.name = "detect_pair", .stage = Stage::detect, .threads = kNearPairs, .crowd = Crowd::stirred, .when = unites_all},
    {.name = "detect_prepare", .stage = Stage::detect, .threads = kPrepared, .crowd = Crowd::calm, .when = unites_all},
    {.name = "contact_prepare", .stage = Stage::detect, .threads = kCandidates, .crowd = Crowd::prepared},
    {.name = "contact_alone", .stage = Stage::contacts, .threads = kContactsAlone, .crowd = Crowd::few, .collides = true, .alone = true, .crew = true,
     .can_end_substep = true},
    {.name = "contact_penetration", .stage = Stage::contact, .threads = kContacts, .crowd = Crowd::many},
    {.name = "contact_solve", .stage = Stage::contact, .threads = kPenetrating, .crowd = Crowd::many},
    {.name = "contact_apply", .stage = Stage::contact, .threads = kTouchedParticles, .crowd = Crowd::many, .collides = true},
    {.name = "contact_slide", .stage = Stage::slide, .threads = kContacts, .crowd = Crowd::many},
    {.name = "contact_slide_apply", .stage = Stage::slide, .threads = kTouchedParticles, .crowd = Crowd::many},
    {.name = "contact_unsafe", .stage = Stage::substep_end, .threads = kCandidates, .crowd = Crowd::many},
    {.name = "contact_limit", .stage = Stage::substep_end, .threads = kUnsafeCandidates, .crowd = Crowd::many, .rounds = WEFT_WIDE_ROUNDS},
    {.name = "contact_limit_rest", .stage = Stage::substep_end, .threads = kContactsAlone, .crowd = Crowd::many, .alone = true,
     .crew = true},
    {.name = "contact_finalize", .stage = Stage::substep_end, .threads = kPairedParticles, .crowd = Crowd::met},
};

// Nothing where all meet each other. Mesh colliders are kinematic, and meet none of their own kind.
void make_masks(const Scene& scene, std::span<const std::uint32_t> meshes, CookedFabric& fabric) {
  const auto cloths = static_cast<std::uint32_t>(scene.cloths.size()), all = cloths + static_cast<std::uint32_t>(meshes.size());
  ContactMasks masks{.words = {}, .stride = (all + 31) / 32};
  masks.words.resize(std::size_t{masks.stride} * all, ~gpu::uint{0});
  bool any = false;
  const auto part = [&](std::uint32_t a, std::uint32_t b) {
    masks.words[std::size_t{a} * masks.stride + b / 32] &= ~(gpu::uint{1} << b % 32);
    any = true;
  };
  for (std::uint32_t a = 0; a < cloths; ++a) {
    for (std::uint32_t b = 0; b < cloths; ++b)
      if (a != b && !meet(scene.cloths[a], scene.cloths[b])) part(a, b);
    for (std::uint32_t m = 0; m < meshes.size(); ++m)
      if (!meet(scene.cloths[a], scene.colliders[meshes[m]])) part(a, cloths + m), part(cloths + m, a);
  }
  if (any) fabric.own.of<ContactMasks>() = std::move(masks);
}

Result<void> cook_bodies(cooking::CookState& state, std::span<const Mesh> collider_meshes) {
  const Scene& scene = state.scene();
  if (!contacts_on(scene)) return {};
  cooking::add_rest(state.fabric());
  const std::vector<std::uint32_t> colliders = mesh_colliders(scene);
  for (std::size_t k = 0; k < colliders.size(); ++k)
    if (auto added = cooking::add_collider_mesh(scene, colliders[k], collider_meshes[k], state.fabric()); !added) return added;
  cooking::add_edges(state.fabric());
  state.fabric().own.of<ClusterLists>() = cooking::make_clusters(state.fabric());
  make_masks(scene, colliders, state.fabric());
  return {};
}

constexpr Figure kFigures[] = {
    {.name = "contacts.max", .counted = [](const Counts& c) { return std::uint64_t(c.contacts_most); }},
    {.name = "contacts.room", .counted = [](const Counts& c) { return std::uint64_t(c.contacts_room); }},
    {.name = "contacts.overflowed", .counted = [](const Counts& c) { return std::uint64_t(c.contacts_overflowed); }},
    {.name = "contacts.truncated", .counted = [](const Counts& c) { return std::uint64_t(c.truncated); }},
    {.name = "contacts.detections", .counted = [](const Counts& c) { return std::uint64_t(c.detections); }},
    {.name = "contacts.tracking_error", .measured = [](const Counts& c) { return double(c.tracking_error); }},
};

void remark(const Counts& counts, std::vector<std::string>& remarks) {
  remarks.push_back("Contacts: up to " + std::to_string(counts.contacts_most) + " pairs, searched for " +
                    std::to_string(counts.detections) + " times; " + std::to_string(counts.truncated) +
                    " times a particle was stopped short");
  if (counts.tracking_error > 0)
    remarks.push_back("Anchors waited for cloth to make way, up to " + rounded_text(1000 * double(counts.tracking_error), 2) +
                      " mm behind their targets");
  if (counts.contacts_overflowed > 0)
    remarks.push_back(std::to_string(counts.contacts_overflowed) + " pairs found no room: their particles were held still instead");
}

}  // namespace

constinit const Effect contact{
    .name = "contact",
    .key = "contacts",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.rest.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          constants[gpu::constant::has_contacts] = 1;
          constants[gpu::constant::meets_meshes] = !s.fabric.collider_meshes.empty();
          constants[gpu::constant::contact_mask_words] = s.fabric.own.of<ContactMasks>().stride;
        },
    .slice = {"contact_settings", [](const Cooked& s) { return made(std::vector{s.contacts}); }},
    .reference = Reference::absent,
    .figures = kFigures,
    .remark = remark,
    .cook_bodies = cook_bodies,
};

}  // namespace effects
}  // namespace weft
