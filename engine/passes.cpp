#include "engine/passes.h"

#include <array>

#include "shaders/embedded.h"

namespace weft {
namespace {

using namespace feature;

// All that C++ says about passes. What a pass touches stands in its shader alone.
constexpr Pass kPasses[] = {
    // name         shader              stage                 one thread per     only with              not with                relaxes settles
    {"predict",     "predict",          Stage::frame_begin,   Domain::particles, kPlain,                kPlain,                 false,  false},
    {"anchor",      "anchor",           Stage::substep_begin, Domain::anchors,   kAnchors,              kPlain,                 false,  false},
    {"stretch",     "stretch",          Stage::iteration,     Domain::particles, kBending,              kIterated,              true,   false},
    {"stretch",     "stretch",          Stage::iteration,     Domain::particles, kPlain,                kBending | kIterated,   true,   true},
    {"stretch",     "stretch_iterated", Stage::iteration,     Domain::particles, kBending | kIterated,  kPlain,                 true,   false},
    {"stretch",     "stretch_iterated", Stage::iteration,     Domain::particles, kIterated,             kBending,               true,   true},
    {"bend",        "bend",             Stage::iteration,     Domain::particles, kBending,              kIterated,              true,   true},
    {"bend_lambda", "bend_lambda",      Stage::iteration,     Domain::bends,     kBending | kIterated,  kPlain,                 false,  false},
    {"bend_gather", "bend_gather",      Stage::iteration,     Domain::particles, kBending | kIterated,  kPlain,                 true,   true},
    {"surface",     "surface",          Stage::frame_end,     Domain::vertices,  kPlain,                kPlain,                 false,  false},
};

std::string fused_with(const Pass& pass, std::uint32_t features) {
  if (!pass.settles) return "";
  return std::string(features & kTethers ? "+tether" : "") + (features & kColliders ? "+collide" : "") + "+settle";
}

template <class Element>
constexpr BufferNeed::Texel texel_of() {
  if (std::is_same_v<Element, gpu::vec4>) return BufferNeed::Texel::float4;
  if (std::is_same_v<Element, gpu::uvec4>) return BufferNeed::Texel::uint4;
  if (std::is_same_v<Element, gpu::uvec2>) return BufferNeed::Texel::uint2;
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
  if (!fabric.anchors.empty()) features |= kAnchors;
  if (!fabric.bends.empty()) features |= kBending;
  if (!fabric.tethers.empty()) features |= kTethers;
  if (!scene.colliders.empty()) features |= kColliders;
  if (scene.solver.iterations > 1) features |= kIterated;
  return features;
}

Result<Plan> make_plan(std::uint32_t features, bool gather_storage) {
  Plan plan;
  for (const Pass& pass : kPasses) {
    if ((features & pass.needs) != pass.needs || (features & pass.without) != 0) continue;
    const std::string fused = fused_with(pass, features);
    PlannedPass planned{&pass, pass.name + fused, shader_named(pass.shader + fused, gather_storage), 0, 0, 0};
    auto touched = compute::reflect(planned.spirv);
    if (!touched) return fail("pass ", planned.label, ": ", touched.error());
    if (!touched->local_size_id[0] || touched->push_constant_bytes > sizeof(gpu::Push))
      return fail("pass ", planned.label, ": its workgroup's width is fixed or its push block is longer than ", sizeof(gpu::Push), " bytes");
    planned.group_size_constant = *touched->local_size_id[0];
    for (const compute::Binding& binding : touched->bindings) {
      const std::uint64_t bit = std::uint64_t(1) << binding.binding;
      if (binding.binding >= 64 || binding.set > WEFT_TEXEL_SET) return fail("pass ", planned.label, ": set ", binding.set, ", binding ", binding.binding, " is not in shared.h");
      (binding.set == WEFT_TEXEL_SET ? plan.texels : plan.storage) |= bit;
      if (binding.read) planned.reads |= bit;
      if (binding.written) planned.writes |= bit;
    }
    plan.passes.push_back(planned);
  }
  return plan;
}

std::vector<BufferNeed> buffer_needs(const Plan& plan, const Scene& scene, const CookedFabric& fabric) {
  const std::uint64_t particles = fabric.positions.size(), vertices = fabric.surface_rows.size();
  const std::uint64_t stretch_pairs = fabric.stretch.pairs.size(), bends = fabric.bends.size();
  const std::uint64_t counts[] = {particles, particles, particles, particles, particles, stretch_pairs, stretch_pairs, particles,
                                  fabric.bend.pairs.size(), bends, bends, bends, fabric.bend_uses.pairs.size(), fabric.tethers.size() / 2,
                                  fabric.anchors.size(), scene.colliders.size(), fabric.materials.size(), vertices,
                                  fabric.corners.size(), vertices, vertices, 1, particles};
  const BufferNeed all[] = {
#define WEFT_NEED(number, name, element) {#name, gpu::name, counts[number] * sizeof(gpu::element), texel_of<gpu::element>()},
      WEFT_BUFFERS(WEFT_NEED)
#undef WEFT_NEED
  };
  static_assert(std::size(counts) == std::size(all));
  std::vector<BufferNeed> needs;
  for (const BufferNeed& need : all)
    if (plan.buffers() >> need.binding & 1) needs.push_back(need);
  return needs;
}

std::uint32_t domain_size(Domain domain, const CookedFabric& fabric) {
  switch (domain) {
    case Domain::particles: return static_cast<std::uint32_t>(fabric.positions.size());
    case Domain::anchors: return static_cast<std::uint32_t>(fabric.anchors.size());
    case Domain::bends: return static_cast<std::uint32_t>(fabric.bends.size());
    case Domain::vertices: return static_cast<std::uint32_t>(fabric.surface_rows.size());
  }
  return 0;
}

}  // namespace weft
