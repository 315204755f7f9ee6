#include "engine/solver.h"

#include <algorithm>
#include <bit>

namespace weft {
namespace {

static_assert(static_cast<int>(ColliderShape::plane) == WEFT_PLANE && static_cast<int>(ColliderShape::sphere) == WEFT_SPHERE &&
              static_cast<int>(ColliderShape::capsule) == WEFT_CAPSULE && static_cast<int>(ColliderShape::box) == WEFT_BOX);

// `predicted` and `relaxed` trade places; everything else is itself.
gpu::Binding in_role(gpu::Binding binding, std::uint32_t parity) {
  if (parity == 0) return binding;
  if (binding == gpu::predicted) return gpu::relaxed;
  if (binding == gpu::relaxed) return gpu::predicted;
  return binding;
}

VkFormat texel_format(BufferNeed::Texel texel) {
  switch (texel) {
    case BufferNeed::Texel::float4: return VK_FORMAT_R32G32B32A32_SFLOAT;
    case BufferNeed::Texel::uint4: return VK_FORMAT_R32G32B32A32_UINT;
    case BufferNeed::Texel::uint2: return VK_FORMAT_R32G32_UINT;
    case BufferNeed::Texel::none: break;
  }
  return VK_FORMAT_UNDEFINED;
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

}  // namespace

Result<Solver> Solver::create(const compute::Device& device, const compute::PipelineCache& cache, const Scene& scene, const CookedFabric& fabric,
                              const SolverOptions& options) {
  Solver solver;
  solver.device_ = &device;
  solver.settings_ = scene.solver;
  solver.h_ = fabric.h;
  solver.stretch_stride_ = fabric.stretch.stride;
  solver.tether_pairs_ = fabric.tethers_per_particle / 2;
  for (const Collider& collider : scene.colliders) ++solver.colliders_[static_cast<std::size_t>(collider.shape)];
  // Both are measured choices: the software driver runs a workgroup on one core, GPUs want full warps and waves.
  solver.workgroup_ = options.workgroup != 0 ? options.workgroup : device.is_software() ? 512 : 64;
  if (solver.workgroup_ > device.limits().max_workgroup_invocations)
    return fail("a workgroup of ", solver.workgroup_, " threads is larger than the device's ", device.limits().max_workgroup_invocations);
  auto plan = make_plan(features_of(scene, fabric), options.gather_storage);
  if (!plan) return plan.take_error();
  solver.plan_ = std::move(*plan);
  for (const PlannedPass& planned : solver.plan_.passes) {
    solver.counts_.push_back(domain_size(planned.pass->domain, fabric));
    if ((solver.counts_.back() + solver.workgroup_ - 1) / solver.workgroup_ > device.limits().max_workgroups_x)
      return fail("pass ", planned.label, ": ", solver.counts_.back(), " threads need more workgroups than the device's ", device.limits().max_workgroups_x);
  }
  if (auto made = solver.create_buffers(device, scene, fabric); !made) return made.take_error();
  if (auto made = solver.create_pipelines(device, cache); !made) return made.take_error();
  return solver;
}

Result<void> Solver::create_buffers(const compute::Device& device, const Scene& scene, const CookedFabric& fabric) {
  needs_ = buffer_needs(plan_, scene, fabric);
  std::vector<compute::BufferRequest> requests;
  for (const BufferNeed& need : needs_) {
    compute::BufferRequest request{need.name, need.bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    // Both iterates are bound in both roles.
    const bool iterate = need.binding == gpu::predicted || need.binding == gpu::relaxed;
    const auto used_as = [&](std::uint64_t set) { return (set >> need.binding & 1) != 0 || (iterate && (set >> gpu::predicted & 1) != 0); };
    if (used_as(plan_.storage)) request.usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    if (used_as(plan_.texels)) {
      request.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
      request.texel_format = texel_format(need.texel);
    }
    if (need.binding == gpu::vertex_positions || need.binding == gpu::vertex_normals) request.usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    requests.push_back(std::move(request));
  }
  auto arena = compute::Arena::create(device, compute::Memory::device, "weft", requests);
  if (!arena) return arena.take_error();
  arena_ = std::move(*arena);

  std::vector<gpu::vec4> iterate = fabric.positions;
  for (std::size_t i = 0; i < iterate.size(); ++i) iterate[i].w = fabric.iterate_weights[i];
  std::vector<gpu::Anchor> anchors;
  for (const AnchorTarget& a : fabric.anchors) anchors.push_back({a.particle, {a.rest.x, a.rest.y, a.rest.z}, {a.rest.x, a.rest.y, a.rest.z}});
  const gpu::Counters zero{};
  const std::vector<gpu::Counters> counters{zero};
  const std::pair<gpu::Binding, std::span<const std::byte>> contents[] = {
      {gpu::positions, bytes_of(fabric.positions)},        {gpu::velocities, bytes_of(fabric.velocities)},
      {gpu::predicted, bytes_of(iterate)},                 {gpu::relaxed, bytes_of(iterate)},
      {gpu::stretch_rows, bytes_of(fabric.stretch.rows)},  {gpu::stretch_links, bytes_of(fabric.stretch.pairs)},
      {gpu::bend_rows, bytes_of(fabric.bend.rows)},        {gpu::bend_entries, bytes_of(fabric.bend.pairs)},
      {gpu::bends, bytes_of(fabric.bends)},                {gpu::bend_uses, bytes_of(fabric.bend_uses.pairs)},
      {gpu::bend_use_rows, bytes_of(fabric.bend_uses.rows)}, {gpu::tethers, bytes_of(fabric.tethers)},
      {gpu::anchors, bytes_of(anchors)},                   {gpu::materials, bytes_of(fabric.materials)},
      {gpu::surface_rows, bytes_of(fabric.surface_rows)},  {gpu::corners, bytes_of(fabric.corners)},
      {gpu::counters, bytes_of(counters)},
  };
  std::vector<compute::Upload> uploads;
  for (const auto& [binding, bytes] : contents)
    if (has(binding) && !bytes.empty()) uploads.push_back({&buffer(binding), bytes});
  return compute::upload_all(device, uploads);
}

Result<void> Solver::create_pipelines(const compute::Device& device, const compute::PipelineCache& cache) {
  std::vector<compute::DescriptorBinding> storage, texel;
  for (std::uint32_t b = 0; b < 64; ++b) {
    if (plan_.storage >> b & 1) storage.push_back({b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER});
    if (plan_.texels >> b & 1) texel.push_back({b, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER});
  }
  if (storage.size() > device.limits().max_storage_buffers_per_stage)
    return fail("the scene's passes use ", storage.size(), " storage buffers; the device has ", device.limits().max_storage_buffers_per_stage, " a stage");
  auto storage_layout = compute::DescriptorLayout::create(device, "storage", storage);
  if (!storage_layout) return storage_layout.take_error();
  storage_layout_ = std::move(*storage_layout);
  auto texel_layout = compute::DescriptorLayout::create(device, "texels", texel);
  if (!texel_layout) return texel_layout.take_error();
  texel_layout_ = std::move(*texel_layout);
  for (std::uint32_t parity = 0; parity < 2; ++parity) {
    std::vector<compute::BoundBuffer> bound_storage, bound_texel;
    for (const auto& binding : storage) bound_storage.push_back({binding.binding, &buffer(in_role(static_cast<gpu::Binding>(binding.binding), parity))});
    for (const auto& binding : texel) bound_texel.push_back({binding.binding, &buffer(in_role(static_cast<gpu::Binding>(binding.binding), parity))});
    auto storage_set = compute::DescriptorSet::create(device, parity == 0 ? "storage even" : "storage odd", storage_layout_, bound_storage);
    if (!storage_set) return storage_set.take_error();
    storage_sets_[parity] = std::move(*storage_set);
    auto texel_set = compute::DescriptorSet::create(device, parity == 0 ? "texels even" : "texels odd", texel_layout_, bound_texel);
    if (!texel_set) return texel_set.take_error();
    texel_sets_[parity] = std::move(*texel_set);
  }
  const VkDescriptorSetLayout sets[] = {storage_layout_.handle(), texel_layout_.handle()};
  auto layout = compute::create_pipeline_layout(device, "passes", sets, sizeof(gpu::Push));
  if (!layout) return layout.take_error();
  layout_ = std::move(*layout);
  for (const PlannedPass& planned : plan_.passes) {
    // A shader ignores the constants that it does not have.
    std::vector<compute::SpecializationConstant> constants{{planned.group_size_constant, workgroup_}};
    for (std::uint32_t shape = 0; shape < WEFT_SHAPES; ++shape) constants.push_back({WEFT_SHAPE_CONSTANT + shape, colliders_[shape]});
    constants.push_back({WEFT_STRIDE_CONSTANT, stretch_stride_});
    auto pipeline = compute::ComputePipeline::create(device, &cache, planned.label, planned.spirv, constants, layout_.get());
    if (!pipeline) return pipeline.take_error();
    pipelines_.push_back(std::move(*pipeline));
  }
  return {};
}

std::span<const Solver::Step> Solver::frame(const FrameInput& input) {
  steps_.clear();
  if (input.substeps == 0) return {};
  gpu::Push push{};
  push.tether_pairs = tether_pairs_;
  push.h = static_cast<float>(h_);
  push.inverse_h = static_cast<float>(1 / h_);
  push.inverse_h2 = static_cast<float>(1 / (h_ * h_));
  push.relaxation = static_cast<float>(settings_.relaxation);
  push.gravity = {input.gravity.x, input.gravity.y, input.gravity.z};
  list_stage(Stage::frame_begin, input, push);
  for (std::uint32_t s = 0; s < input.substeps; ++s) {
    push.fraction_from = static_cast<float>(s) / static_cast<float>(input.substeps);
    push.fraction_to = static_cast<float>(s + 1) / static_cast<float>(input.substeps);
    list_stage(Stage::substep_begin, input, push);
    for (std::uint32_t k = 0; k < settings_.iterations; ++k) {
      push.flags = (k == 0 ? WEFT_FIRST_ITERATION : 0) | (k + 1 == settings_.iterations ? WEFT_LAST_ITERATION : 0) |
                   (s + 1 == input.substeps ? WEFT_LAST_SUBSTEP : 0);
      list_stage(Stage::iteration, input, push);
    }
  }
  list_stage(Stage::frame_end, input, push);
  return steps_;
}

std::span<const Solver::Step> Solver::surface() {
  steps_.clear();
  list_stage(Stage::frame_end, {}, {});
  return steps_;
}

void Solver::list_stage(Stage stage, const FrameInput& input, gpu::Push push) {
  for (std::uint32_t k = 0; k < plan_.passes.size(); ++k) {
    const Pass& pass = *plan_.passes[k].pass;
    if (pass.stage != stage || (pass.domain == Domain::anchors && !input.anchors_move)) continue;
    push.count = counts_[k];
    steps_.push_back({k, parity_, push});
    if (pass.relaxes) parity_ ^= 1;
  }
}

void Solver::record_input(compute::Recorder& recorder, const FrameInput& input) const {
  const auto copy = [&](gpu::Binding binding, std::span<const std::byte> bytes) {
    // The data travels in the command buffer, so frames under way never share it.
    constexpr std::size_t kLongest = 65536;   // vkCmdUpdateBuffer
    for (std::size_t at = 0; at < bytes.size(); at += kLongest)
      device_->vk().vkCmdUpdateBuffer(recorder.commands(), buffer(binding).handle, at, std::min(kLongest, bytes.size() - at), bytes.data() + at);
  };
  if (input.anchors_move) copy(gpu::anchors, std::as_bytes(input.anchors));
  if (has(gpu::colliders)) copy(gpu::colliders, std::as_bytes(input.colliders));
  recorder.barrier(compute::Use::transfer, compute::Use::compute);
}

void Solver::record_step(compute::Recorder& recorder, const Step& step) const {
  const PlannedPass& planned = plan_.passes[step.pass];
  recorder.begin_pass(planned.label.c_str(), mask(planned.reads, step.parity), mask(planned.writes, step.parity));
  const VkDescriptorSet sets[] = {storage_sets_[step.parity].handle(), texel_sets_[step.parity].handle()};
  recorder.bind(pipelines_[step.pass].handle(), layout_.get(), sets);
  recorder.push(layout_.get(), std::as_bytes(std::span(&step.push, 1)));
  recorder.dispatch((step.push.count + workgroup_ - 1) / workgroup_);
}

std::uint64_t Solver::mask(std::uint64_t bindings, std::uint32_t parity) const {
  if (parity == 0) return bindings;
  const std::uint64_t predicted = bindings >> gpu::predicted & 1, relaxed = bindings >> gpu::relaxed & 1;
  const std::uint64_t both = std::uint64_t(1) << gpu::predicted | std::uint64_t(1) << gpu::relaxed;
  return (bindings & ~both) | predicted << gpu::relaxed | relaxed << gpu::predicted;
}

const compute::Buffer& Solver::buffer(gpu::Binding binding) const {
  const auto at = std::find_if(needs_.begin(), needs_.end(), [&](const BufferNeed& need) { return need.binding == binding; });
  return arena_[static_cast<std::size_t>(at - needs_.begin())];
}

}  // namespace weft
