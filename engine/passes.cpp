#include "engine/passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "shaders/embedded.h"

namespace weft {
namespace {

using namespace feature;

constexpr std::uint32_t kOthers = kGaussSeidel | kChebyshev | kImplicit | kSprings;   // solvers that are not Jacobi

// All that C++ says about passes. What a pass touches stands in its shader alone.
constexpr Pass kPasses[] = {
    // name            shader              stage                 one thread per               only with              not with                relaxes settles
    {"predict",        "predict",          Stage::frame_begin,   Domain::particles,           kPlain,                kPlain,                 false,  false, "+watch"},
    {"anchor",         "anchor",           Stage::substep_begin, Domain::anchors,             kAnchors,              kPlain,                 false,  false, "+watch"},
    {"detect_arm",     "detect_arm",       Stage::detect,        Domain::once,                kContacts,             kPlain,                 false,  false},
    {"detect_path",    "detect_path",      Stage::detect,        Domain::detected_particles,  kContacts,             kPlain,                 false,  false},
    {"grid_count",     "grid_count",       Stage::detect,        Domain::primitives,          kContacts,             kPlain,                 false,  false},
    {"grid_total",     "grid_total",       Stage::detect,        Domain::slots,               kContacts,             kPlain,                 false,  false},
    {"grid_scan",      "grid_scan",        Stage::detect,        Domain::slots,               kContacts,             kPlain,                 false,  false},
    {"grid_fill",      "grid_fill",        Stage::detect,        Domain::primitives,          kContacts,             kPlain,                 false,  false},
    {"search_faces",   "search_faces",     Stage::detect,        Domain::detected_particles,  kContacts,             kPlain,                 false,  false},
    {"search_edges",   "search_edges",     Stage::detect,        Domain::primitives,          kContacts,             kPlain,                 false,  false},
    {"search_arm",     "search_arm",       Stage::detect,        Domain::once,                kContacts,             kPlain,                 false,  false},
    {"pair_faces",     "pair_faces",       Stage::detect,        Domain::near_faces,          kContacts,             kPlain,                 false,  false},
    {"pair_edges",     "pair_edges",       Stage::detect,        Domain::near_edges,          kContacts,             kPlain,                 false,  false},
    {"contact_arm",    "contact_arm",      Stage::detect,        Domain::once,                kContacts,             kPlain,                 false,  false},
    {"contact_prepare","contact_prepare",  Stage::detect,        Domain::candidates,          kContacts,             kPlain,                 false,  false},
    {"implicit_assemble","implicit_assemble",Stage::assemble,    Domain::particles,           kImplicit,             kColliders,             false,  false},
    {"implicit_assemble","implicit_assemble_met",Stage::assemble,Domain::particles,           kImplicit | kColliders, kPlain,                false,  false},
    {"implicit_meet",  "implicit_meet",    Stage::assemble,      Domain::particles,           kImplicit | kColliders, kPlain,                false,  false},
    {"implicit_multiply","implicit_multiply",Stage::linear,      Domain::particles,           kImplicit,             kRelaxed | kColliders,  false,  false},
    {"implicit_multiply","implicit_multiply_met",Stage::linear,  Domain::particles,           kImplicit | kColliders, kRelaxed,              false,  false},
    {"implicit_advance","implicit_advance",Stage::linear,        Domain::particles,           kImplicit,             kRelaxed,               false,  false},
    {"implicit_relax", "implicit_relax",   Stage::linear,        Domain::particles,           kImplicit | kRelaxed,  kColliders,             false,  false},
    {"implicit_relax", "implicit_relax_met",Stage::linear,       Domain::particles,           kImplicit | kRelaxed | kColliders, kPlain,     false,  false},
    {"implicit_drift", "implicit_drift",   Stage::iteration,     Domain::cloths,              kImplicit,             kColliders,             false,  false},
    {"implicit_drift", "implicit_drift_met",Stage::iteration,    Domain::cloths,              kImplicit | kColliders, kPlain,                false,  false},
    {"implicit_step",  "implicit_step",    Stage::iteration,     Domain::particles,           kImplicit,             kPlain,                 true,   true},
    {"stretch",        "stretch",          Stage::iteration,     Domain::particles,           kPlain,                kIterated | kOthers,    true,   true},
    {"stretch",        "stretch_iterated", Stage::iteration,     Domain::particles,           kIterated,             kOthers,                true,   true},
    {"stretch",        "stretch_coloured", Stage::iteration,     Domain::coloured,            kGaussSeidel,          kIterated,              false,  false},
    {"stretch",        "stretch_coloured_iterated", Stage::iteration, Domain::coloured,       kGaussSeidel | kIterated, kPlain,              false,  false},
    {"hold",           "hold",             Stage::iteration,     Domain::particles,           kGaussSeidel,          kBending | kHinges,     true,   true},
    {"spring",         "spring",           Stage::iteration,     Domain::particles,           kSprings,              kPlain,                 true,   false},
    {"hold",           "hold",             Stage::iteration,     Domain::particles,           kSprings,              kPlain,                 true,   true},
    {"stretch",        "stretch_accelerated", Stage::iteration,  Domain::particles,           kChebyshev,            kPlain,                 true,   false},
    {"bend",           "bend",             Stage::iteration,     Domain::particles,           kBending,              kIterated | kImplicit,  true,   true},
    {"bend_lambda",    "bend_lambda",      Stage::iteration,     Domain::bends,               kBending | kIterated,  kChebyshev,             false,  false},
    {"bend_lambda",    "bend_lambda_accelerated", Stage::iteration, Domain::bends,            kBending | kChebyshev, kPlain,                 false,  false},
    {"bend_gather",    "bend_gather",      Stage::iteration,     Domain::particles,           kBending | kIterated,  kPlain,                 true,   true},
    {"hinge",          "hinge",            Stage::iteration,     Domain::hinges,              kHinges,               kPlain,                 false,  false},
    {"hinge_gather",   "hinge_gather",     Stage::iteration,     Domain::particles,           kHinges,               kPlain,                 true,   true},
    {"accelerate",     "accelerate",       Stage::iteration,     Domain::particles,           kChebyshev,            kPlain,                 true,   true},
    {"contact_weigh",  "contact_weigh",    Stage::contact,       Domain::contacts,            kContacts,             kPlain,                 false,  false},
    {"contact_solve",  "contact_solve",    Stage::contact,       Domain::contacts,            kContacts,             kPlain,                 false,  false},
    {"contact_apply",  "contact_apply",    Stage::contact,       Domain::touched_particles,   kContacts,             kColliders,             false,  false},
    {"contact_apply",  "contact_apply",    Stage::contact,       Domain::touched_particles,   kContacts | kColliders, kPlain,                false,  false, "+collide"},
    {"contact_open",   "contact_open",     Stage::substep_end,   Domain::candidates,          kContacts,             kPlain,                 false,  false},
    {"contact_limit",  "contact_limit",    Stage::substep_end,   Domain::open_candidates,     kContacts,             kPlain,                 false,  false, "", WEFT_ROUNDS},
    {"settle",         "settle",           Stage::substep_end,   Domain::particles,           kContacts,             kPlain,                 false,  false},
    {"surface",        "surface",          Stage::frame_end,     Domain::vertices,            kPlain,                kPlain,                 false,  false},
};

bool called_for(const Pass& pass, std::uint32_t features) { return (features & pass.needs) == pass.needs && (features & pass.without) == 0; }

std::string fused_with(const Pass& pass, bool settles, std::uint32_t features) {
  if (!settles) return features & kContacts ? pass.fused : "";
  return std::string(features & kTethers ? "+tether" : "") + (features & kColliders ? "+collide" : "") + (features & kContacts ? "" : "+settle");
}

template <class Element>
constexpr BufferNeed::Texel texel_of() {
  if (std::is_same_v<Element, gpu::vec4>) return BufferNeed::Texel::float4;
  if (std::is_same_v<Element, gpu::uvec4>) return BufferNeed::Texel::uint4;
  if (std::is_same_v<Element, gpu::uvec2>) return BufferNeed::Texel::uint2;
  if (std::is_same_v<Element, gpu::uint>) return BufferNeed::Texel::uint1;
  return BufferNeed::Texel::none;
}

std::span<const std::uint32_t> shader_named(const std::string& name, bool gather_storage) {
  if (gather_storage)
    if (const auto variant = shader(name + ".storage"); !variant.empty()) return variant;
  return shader(name);
}

}  // namespace

std::span<const Pass> all_passes() { return kPasses; }

std::uint32_t features_of(const Scene& scene, const CookedFabric& fabric) {
  std::uint32_t features = kPlain;
  if (moved_particles(fabric) > 0) features |= kAnchors;
  const bool implicit = scene.solver.method == Method::implicit;
  if (implicit) features |= kImplicit | (scene.solver.linear == Linear::jacobi ? kRelaxed : kPlain);
  if (!fabric.bends.empty() && !on_springs(scene.solver.method)) features |= kBending;
  if (!fabric.hinges.empty()) features |= kHinges;
  if (!fabric.tethers.empty()) features |= kTethers;
  if (scene.colliders.size() > fabric.collider_meshes.size()) features |= kColliders;
  if (scene.solver.iterations > 1 && !implicit) features |= kIterated;
  if (!fabric.rest.empty()) features |= kContacts;
  if (scene.solver.method == Method::gauss_seidel) features |= kGaussSeidel;
  if (scene.solver.method == Method::chebyshev) features |= kChebyshev;
  if (on_springs(scene.solver.method) && !implicit) features |= kSprings;
  return features;
}

Result<Plan> make_plan(std::uint32_t features, bool gather_storage) {
  Plan plan;
  const Pass* last = nullptr;   // of those that can settle
  for (const Pass& pass : kPasses)
    if (pass.settles && called_for(pass, features)) last = &pass;
  for (const Pass& pass : kPasses) {
    if (!called_for(pass, features)) continue;
    const std::string fused = fused_with(pass, &pass == last, features);
    PlannedPass planned{&pass, pass.name + fused, shader_named(pass.shader + fused, gather_storage)};
    auto touched = compute::reflect(planned.spirv);
    if (!touched) return fail("pass ", planned.label, ": ", touched.error());
    if (!touched->local_size_id[0] || touched->push_constant_bytes > sizeof(gpu::Push))
      return fail("pass ", planned.label, ": its workgroup's width is fixed or its push block is longer than ", sizeof(gpu::Push), " bytes");
    planned.group_size_constant = *touched->local_size_id[0];
    for (const compute::Binding& binding : touched->bindings) {
      const std::uint64_t bit = std::uint64_t(1) << binding.binding;
      if (binding.binding >= 64 || binding.set > WEFT_TEXEL_SET) return fail("pass ", planned.label, ": set ", binding.set, ", binding ", binding.binding, " is not in shared.h");
      (binding.set == WEFT_TEXEL_SET ? planned.texels : planned.storage) |= bit;
      if (binding.read) planned.reads |= bit;
      if (binding.written) planned.writes |= bit;
    }
    plan.texels |= planned.texels;
    plan.storage |= planned.storage;
    plan.passes.push_back(planned);
  }
  return plan;
}

ContactSizes contact_sizes(const Scene& scene, const CookedFabric& fabric) {
  ContactSizes sizes;
  if (fabric.rest.empty()) return sizes;
  const Contacts& wanted = scene.contacts;
  float thickness = 0;
  for (const gpu::vec4& rest : fabric.rest) thickness = std::max(thickness, rest.w);
  const double edge = fabric.mean_edge > 0 ? fabric.mean_edge : 1e-3;
  // At first short against the edges, so that a flat sheet has no candidates, and against the distance of layers that lie on each other.
  const double reach = wanted.reach > 0 ? wanted.reach : std::min(0.1 * edge, thickness > 0 ? 0.25 * thickness : edge);
  sizes.reach_low = static_cast<float>(reach);
  sizes.reach_high = static_cast<float>(std::max(4 * reach, 0.1 * edge));
  // A box is an edge long and as much thicker as detection has to look around it.
  sizes.cell = static_cast<float>(wanted.cell > 0 ? wanted.cell : 1.5 * edge + 2 * reach + thickness);
  // A millionth of what a particle may stray at first; contact_solve.comp says how many of them a correction can be.
  sizes.quantum = static_cast<float>(std::ldexp(reach, -20));
  sizes.recover = static_cast<float>(wanted.recover * fabric.h);
  sizes.patience = static_cast<float>(wanted.patience);
  const std::size_t primitives = fabric.triangles.size() + fabric.edges.size();
  // Neighbours in the cloth share cells, so that half as many slots are seldom taken twice.
  sizes.slots = static_cast<std::uint32_t>(std::bit_ceil(std::max<std::size_t>(64, primitives / 2)));
  sizes.capacity = wanted.capacity > 0 ? wanted.capacity : static_cast<std::uint32_t>(std::max<std::size_t>(4096, 2 * fabric.positions.size()));
  return sizes;
}

std::vector<BufferNeed> buffer_needs(const Plan& plan, const Scene& scene, const CookedFabric& fabric, const ContactSizes& contacts) {
  const std::uint64_t particles = fabric.positions.size(), vertices = fabric.surface_rows.size();
  const std::uint64_t stretch_pairs = fabric.stretch.pairs.size(), bends = fabric.bends.size(), hinges = fabric.hinges.size();
  const std::uint64_t triangles = fabric.triangles.size(), edges = fabric.edges.size();
  const std::uint64_t fours = std::max<std::uint64_t>(1, fabric.spring_rows.ends.size());
  const std::uint64_t links = std::max<std::uint64_t>(1, fabric.coloured_links.size());   // none where all are held
  const bool relaxed = scene.solver.linear == Linear::jacobi;
  const std::uint64_t counts[] = {particles, particles, particles, particles, particles, stretch_pairs, stretch_pairs, particles,
                                  fabric.bend.pairs.size(), bends, bends, bends, fabric.bend_uses.pairs.size(), fabric.tethers.size() / 2,
                                  moved_particles(fabric), scene.colliders.size() - fabric.collider_meshes.size(), fabric.materials.size(), vertices,
                                  fabric.corners.size(), vertices, vertices, 1, particles,
                                  // Contacts: from `triangles` on. A block is at least 8 slots.
                                  triangles, edges, particles, particles, particles, particles, contacts.slots, contacts.slots + 1ull,
                                  contacts.slots / 8 + 1ull, 3 * (triangles + edges), 1, contacts.capacity, contacts.capacity, contacts.capacity,
                                  particles, particles, WEFT_ROUNDS / 4 * particles,
                                  // Springs, and the system of the method implicit.
                                  particles, fours, 4 * fours, 4 * fours, 2 * particles, (relaxed ? 3 : 1) * particles, (relaxed ? 1 : 5) * particles,
                                  particles, 1, fabric.materials.size(),
                                  // Gauss-Seidel; Chebyshev.
                                  links, links, stretch_pairs, bends, 3 * particles, 1,
                                  contacts.capacity, particles,
                                  hinges, 4 * hinges, particles, fabric.hinge_uses.pairs.size(), 2 * particles};
  constexpr auto grows = [](gpu::Binding binding) {
    return binding == gpu::candidates || binding == gpu::contact_normals || binding == gpu::contact_weights || binding == gpu::contact_list;
  };
  const BufferNeed all[] = {
#define WEFT_NEED(number, name, element) {#name, gpu::name, counts[number] * sizeof(gpu::element), texel_of<gpu::element>(), grows(gpu::name)},
      WEFT_BUFFERS(WEFT_NEED)
#undef WEFT_NEED
  };
  static_assert(std::size(counts) == std::size(all));
  std::vector<BufferNeed> needs;
  for (const BufferNeed& need : all)
    if (plan.buffers() >> need.binding & 1) needs.push_back(need);
  return needs;
}

std::uint32_t domain_size(Domain domain, const CookedFabric& fabric, const ContactSizes& contacts) {
  switch (domain) {
    case Domain::coloured: return static_cast<std::uint32_t>(fabric.coloured_links.size());   // all colours together
    case Domain::particles:
    case Domain::detected_particles:
    case Domain::touched_particles:
    case Domain::cloths:
    case Domain::once: return static_cast<std::uint32_t>(fabric.positions.size());   // a single thread, or one group a cloth, is told how many there are
    case Domain::anchors: return moved_particles(fabric);
    case Domain::bends: return static_cast<std::uint32_t>(fabric.bends.size());
    case Domain::hinges: return static_cast<std::uint32_t>(fabric.hinges.size());
    case Domain::vertices: return static_cast<std::uint32_t>(fabric.surface_rows.size());
    case Domain::primitives: return static_cast<std::uint32_t>(fabric.triangles.size() + fabric.edges.size());
    case Domain::slots: return contacts.slots;
    case Domain::near_faces:
    case Domain::near_edges: return WEFT_NEAR * contacts.capacity;
    case Domain::candidates:
    case Domain::contacts:
    case Domain::open_candidates: return contacts.capacity;
  }
  return 0;
}

std::uint32_t rounds_of(const Pass& pass, const CookedFabric& fabric) {
  return pass.domain == Domain::coloured ? static_cast<std::uint32_t>(fabric.colour_ends.size()) : pass.rounds;
}

std::optional<std::uint32_t> indirect_offset(Domain domain) {
  switch (domain) {
    case Domain::detected_particles: return offsetof(gpu::Detection, particles);
    case Domain::primitives: return offsetof(gpu::Detection, primitives);
    case Domain::slots: return offsetof(gpu::Detection, blocks);
    case Domain::near_faces: return offsetof(gpu::Detection, near_faces);
    case Domain::near_edges: return offsetof(gpu::Detection, near_edges);
    case Domain::candidates: return offsetof(gpu::Detection, contacts);
    case Domain::contacts: return offsetof(gpu::Detection, listed);
    case Domain::open_candidates: return offsetof(gpu::Detection, listed) + WEFT_OPEN * sizeof(gpu::Groups);
    case Domain::touched_particles: return offsetof(gpu::Detection, touched);
    default: return std::nullopt;
  }
}

}  // namespace weft
