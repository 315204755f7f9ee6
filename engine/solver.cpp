#include "engine/solver.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace weft {
namespace {

bool grows_with_candidates(Domain domain) {
  return domain == Domain::candidates || domain == Domain::contacts || domain == Domain::open_candidates || domain == Domain::near_faces ||
         domain == Domain::near_edges;
}

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
    case BufferNeed::Texel::uint1: return VK_FORMAT_R32_UINT;
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
  solver.contact_iterations_ = scene.contacts.iterations;
  solver.h_ = fabric.h;
  solver.cloths_ = static_cast<std::uint32_t>(fabric.cloths.size());
  solver.jacobi_weight_ = fabric.jacobi_weight;
  solver.stretch_stride_ = fabric.stretch.stride;
  solver.rho_ = rho_of(scene.solver);
  solver.damped_ = std::any_of(fabric.springs.begin(), fabric.springs.end(), [](const ParticleSpring& s) { return s.damping > 0; });
  solver.colour_ends_ = fabric.colour_ends;
  solver.tether_pairs_ = fabric.tethers_per_particle / 2;
  for (const Collider& collider : scene.colliders)
    if (collider.shape != ColliderShape::mesh) ++solver.colliders_[static_cast<std::size_t>(collider.shape)];
  // Both are measured choices: the software driver runs a workgroup on one core, GPUs want full warps and waves.
  solver.workgroup_ = options.workgroup != 0 ? options.workgroup : device.is_software() ? 512 : 64;
  if (solver.workgroup_ > device.limits().max_workgroup_invocations)
    return fail("a workgroup of ", solver.workgroup_, " threads is larger than the device's ", device.limits().max_workgroup_invocations);
  auto plan = make_plan(features_of(scene, fabric), options.gather_storage);
  if (!plan) return plan.take_error();
  solver.plan_ = std::move(*plan);
  solver.contacts_ = weft::contact_sizes(scene, fabric);
  solver.triangles_ = static_cast<std::uint32_t>(fabric.triangles.size());
  solver.edges_ = static_cast<std::uint32_t>(fabric.edges.size());
  for (const PlannedPass& planned : solver.plan_.passes) {
    solver.counts_.push_back(domain_size(planned.pass->domain, fabric, solver.contacts_));
    solver.rounds_.push_back(rounds_of(*planned.pass, fabric));
    if ((solver.counts_.back() + solver.workgroup_ - 1) / solver.workgroup_ > device.limits().max_workgroups_x)
      return fail("pass ", planned.label, ": ", solver.counts_.back(), " threads need more workgroups than the device's ", device.limits().max_workgroups_x);
  }
  if (auto made = solver.create_buffers(scene, fabric); !made) return made.take_error();
  if (auto made = solver.create_pipelines(cache); !made) return made.take_error();
  return solver;
}

// All buffers of the plan, or those that can grow.
Result<compute::Arena> Solver::create_arena(bool grows) const {
  std::vector<compute::BufferRequest> requests;
  for (const BufferNeed& need : needs_) {
    if (need.grows != grows) continue;
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
    if (need.binding == gpu::detection) request.usage |= VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    requests.push_back(std::move(request));
  }
  return compute::Arena::create(*device_, compute::Memory::device, grows ? "weft candidates" : "weft", requests);
}

Result<void> Solver::create_buffers(const Scene& scene, const CookedFabric& fabric) {
  needs_ = buffer_needs(plan_, scene, fabric, contacts_);
  auto arena = create_arena(false);
  if (!arena) return arena.take_error();
  arena_ = std::move(*arena);
  if (has(gpu::candidates)) {
    auto growing = create_arena(true);
    if (!growing) return growing.take_error();
    growing_arena_ = std::move(*growing);
  }

  std::vector<gpu::vec4> iterate = fabric.positions;
  for (std::size_t i = 0; i < iterate.size(); ++i) iterate[i].w = fabric.iterate_weights[i];
  std::vector<gpu::Anchor> anchors;
  for (const AnchorTarget& a : fabric.anchors) anchors.push_back({a.particle, {a.rest.x, a.rest.y, a.rest.z}, {a.rest.x, a.rest.y, a.rest.z}});
  for (const ColliderMesh& mesh : fabric.collider_meshes)
    for (std::uint32_t i = mesh.first_particle; i < mesh.first_particle + mesh.particles; ++i) {
      const gpu::vec4& x = fabric.positions[i];
      anchors.push_back({i, {x.x, x.y, x.z}, {x.x, x.y, x.z}});
    }
  const std::vector<gpu::Counters> counters(1);
  // What contacts find between detections, substeps and iterations (shared.h).
  std::vector<gpu::Detection> detection(1);
  detection[0].due = 1;
  const std::size_t particles = has(gpu::candidates) ? fabric.positions.size() : 0;
  const std::uint32_t whole = std::bit_cast<std::uint32_t>(1.0f);
  const std::vector<gpu::uvec4> fractions(WEFT_ROUNDS / 4 * particles, {whole, whole, whole, whole});
  const std::vector<gpu::ivec4> sums(particles);
  const std::vector<gpu::vec4> nowhere(particles);
  const std::vector<std::uint32_t> zeros(std::max<std::size_t>(particles, contacts_.slots));
  const std::vector<gpu::vec4> iterates(has(gpu::iterates) ? 3 * fabric.positions.size() : 0);
  const std::vector<gpu::Acceleration> acceleration(1);
  std::vector<gpu::uvec4> triangles;
  if (has(gpu::triangles))
    for (const auto& [a, b, c] : fabric.triangles) triangles.push_back({a, b, c, 0});
  const std::vector<gpu::Linear> linear(1);
  std::vector<gpu::FreeCloth> free_cloths(fabric.materials.size());
  for (std::size_t k = 0; k < fabric.cloths.size(); ++k)
    if (fabric.cloths[k].anchors == 0) free_cloths[k] = {fabric.cloths[k].first_particle, fabric.cloths[k].particles, {0, 0, 0}};
  const std::span<const std::byte> none = std::as_bytes(std::span(zeros));
  const std::pair<gpu::Binding, std::span<const std::byte>> contents[] = {
      {gpu::positions, bytes_of(fabric.positions)},        {gpu::velocities, bytes_of(fabric.velocities)},
      {gpu::predicted, bytes_of(iterate)},                 {gpu::relaxed, bytes_of(iterate)},
      {gpu::stretch_rows, bytes_of(fabric.stretch.rows)},  {gpu::stretch_links, bytes_of(fabric.stretch.pairs)},
      {gpu::bend_rows, bytes_of(fabric.bend.rows)},        {gpu::bend_entries, bytes_of(fabric.bend.pairs)},
      {gpu::bends, bytes_of(fabric.bends)},                {gpu::bend_uses, bytes_of(fabric.bend_uses.pairs)},
      {gpu::bend_use_rows, bytes_of(fabric.bend_uses.rows)}, {gpu::tethers, bytes_of(fabric.tethers)},
      {gpu::anchors, bytes_of(anchors)},                   {gpu::materials, bytes_of(fabric.materials)},
      {gpu::surface_rows, bytes_of(fabric.surface_rows)},  {gpu::corners, bytes_of(fabric.corners)},
      {gpu::counters, bytes_of(counters)},                 {gpu::triangles, bytes_of(triangles)},
      {gpu::edges, bytes_of(fabric.edges)},                {gpu::rest, bytes_of(fabric.rest)},
      {gpu::references, bytes_of(nowhere)},                {gpu::paths, bytes_of(nowhere)},
      {gpu::leashes, none.first(particles * sizeof(gpu::uint))}, {gpu::contact_counts, none.first(particles * sizeof(gpu::uint))}, {gpu::contact_lacks, none.first(particles * sizeof(gpu::uint))},
      {gpu::grid_counts, none.first(contacts_.slots * sizeof(gpu::uint))}, {gpu::detection, bytes_of(detection)},
      {gpu::coloured_links, bytes_of(fabric.coloured_links)}, {gpu::iterates, bytes_of(iterates)},
      {gpu::acceleration, bytes_of(acceleration)},         {gpu::contact_sums, bytes_of(sums)},                 {gpu::fractions, bytes_of(fractions)},
      {gpu::spring_rows, bytes_of(fabric.spring_rows.rows)}, {gpu::spring_ends, bytes_of(fabric.spring_rows.ends)},
      {gpu::springs, bytes_of(fabric.spring_rows.springs)}, {gpu::free_cloths, bytes_of(free_cloths)},
      {gpu::linear, bytes_of(linear)},                     {gpu::hinges, bytes_of(fabric.hinges)},
      {gpu::hinge_use_rows, bytes_of(fabric.hinge_uses.rows)}, {gpu::hinge_uses, bytes_of(fabric.hinge_uses.pairs)},
  };
  std::vector<compute::Upload> uploads;
  for (const auto& [binding, bytes] : contents)
    if (has(binding) && !bytes.empty()) uploads.push_back({&buffer(binding), bytes});
  return compute::upload_all(*device_, uploads);
}

Result<void> Solver::create_pipelines(const compute::PipelineCache& cache) {
  for (const PlannedPass& planned : plan_.passes) {
    std::vector<compute::DescriptorBinding> storage, texel;
    for (std::uint32_t b = 0; b < 64; ++b) {
      if (planned.storage >> b & 1) storage.push_back({b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER});
      if (planned.texels >> b & 1) texel.push_back({b, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER});
    }
    if (storage.size() > device_->limits().max_storage_buffers_per_stage)
      return fail("pass ", planned.label, " uses ", storage.size(), " storage buffers; the device has ", device_->limits().max_storage_buffers_per_stage, " a stage");
    PassResources& made = resources_.emplace_back();
    auto storage_layout = compute::DescriptorLayout::create(*device_, planned.label + " storage", storage);
    if (!storage_layout) return storage_layout.take_error();
    made.storage_layout = std::move(*storage_layout);
    auto texel_layout = compute::DescriptorLayout::create(*device_, planned.label + " texels", texel);
    if (!texel_layout) return texel_layout.take_error();
    made.texel_layout = std::move(*texel_layout);
    const VkDescriptorSetLayout sets[] = {made.storage_layout.handle(), made.texel_layout.handle()};
    auto layout = compute::create_pipeline_layout(*device_, planned.label, sets, sizeof(gpu::Push));
    if (!layout) return layout.take_error();
    made.layout = std::move(*layout);
    // A shader ignores the constants that it does not have.
    std::vector<compute::SpecializationConstant> constants{{planned.group_size_constant, workgroup_}, {WEFT_STRIDE_CONSTANT, stretch_stride_},
                                                            {WEFT_LINEAR_CONSTANT, settings_.linear == Linear::jacobi ? WEFT_LINEAR_JACOBI : WEFT_LINEAR_CG},
                                                            {WEFT_DAMPED_CONSTANT, damped_ ? 1u : 0u}};
    for (std::uint32_t shape = 0; shape < WEFT_SHAPES; ++shape) constants.push_back({WEFT_SHAPE_CONSTANT + shape, colliders_[shape]});
    auto pipeline = compute::ComputePipeline::create(*device_, &cache, planned.label, planned.spirv, constants, made.layout.get());
    if (!pipeline) return pipeline.take_error();
    made.pipeline = std::move(*pipeline);
  }
  return write_sets();
}

// All of them or none.
Result<void> Solver::write_sets() {
  std::vector<PassSets> sets(resources_.size());
  for (std::size_t k = 0; k < resources_.size(); ++k)
    for (std::uint32_t parity = 0; parity < 2; ++parity) {
      const auto write = [&](const compute::DescriptorLayout& layout, const char* kind, compute::DescriptorSet& set) -> Result<void> {
        std::vector<compute::BoundBuffer> bound;
        for (const auto& binding : layout.bindings()) bound.push_back({binding.binding, &buffer(in_role(static_cast<gpu::Binding>(binding.binding), parity))});
        auto written = compute::DescriptorSet::create(*device_, plan_.passes[k].label + kind + (parity == 0 ? " even" : " odd"), layout, bound);
        if (!written) return written.take_error();
        set = std::move(*written);
        return {};
      };
      if (auto done = write(resources_[k].storage_layout, " storage", sets[k].storage[parity]); !done) return done;
      if (auto done = write(resources_[k].texel_layout, " texels", sets[k].texel[parity]); !done) return done;
    }
  sets_ = std::move(sets);
  return {};
}

Result<void> Solver::grow(std::uint32_t candidates) {
  if ((std::uint64_t(WEFT_NEAR) * candidates + workgroup_ - 1) / workgroup_ > device_->limits().max_workgroups_x)
    return fail(candidates, " contact candidates need more workgroups than the device's ", device_->limits().max_workgroups_x);
  const auto set_room = [&](std::uint32_t capacity) {
    for (BufferNeed& need : needs_)
      if (need.grows) need.bytes = need.bytes / contacts_.capacity * capacity;
    for (std::size_t k = 0; k < counts_.size(); ++k)
      if (grows_with_candidates(plan_.passes[k].pass->domain)) counts_[k] = counts_[k] / contacts_.capacity * capacity;
    contacts_.capacity = capacity;
  };
  const std::uint32_t before = contacts_.capacity;
  set_room(candidates);
  auto arena = create_arena(true);
  if (arena) {
    std::swap(growing_arena_, *arena);
    auto written = write_sets();
    if (written) return {};
    std::swap(growing_arena_, *arena);
    arena = written.take_error();
  }
  set_room(before);   // shaders go by it: it must never be more than the buffers have
  return arena.take_error();
}

std::span<const Solver::Step> Solver::frame(const FrameInput& input) {
  steps_.clear();
  if (input.substeps == 0) return {};
  gpu::Push push{};
  push.origin = origin_;
  push.tether_pairs = tether_pairs_;
  push.h = static_cast<float>(h_);
  push.inverse_h = static_cast<float>(1 / h_);
  push.inverse_h2 = static_cast<float>(1 / (h_ * h_));
  const bool implicit = settings_.method == Method::implicit;
  push.relaxation = static_cast<float>(implicit ? jacobi_weight_ : relaxation_of(settings_));
  push.gravity = {input.gravity.x, input.gravity.y, input.gravity.z};
  push.triangles = triangles_;
  push.edges = edges_;
  push.slots = contacts_.slots;
  push.capacity = contacts_.capacity;
  push.cell = contacts_.cell;
  push.quantum = contacts_.quantum;
  push.recover = contacts_.recover;
  push.patience = contacts_.patience;
  push.reach_low = contacts_.reach_low;
  push.reach_high = contacts_.reach_high;
  list_stage(Stage::frame_begin, input, push);
  for (std::uint32_t s = 0; s < input.substeps; ++s) {
    const std::uint32_t flags = s + 1 == input.substeps ? WEFT_LAST_SUBSTEP : 0;
    push.flags = flags;
    push.fraction_from = static_cast<float>(s) / static_cast<float>(input.substeps);
    push.fraction_to = static_cast<float>(s + 1) / static_cast<float>(input.substeps);
    list_stage(Stage::substep_begin, input, push);
    list_stage(Stage::detect, input, push);
    turn_ = (turn_ + 1) % 3;
    if (implicit) {
      list_stage(Stage::assemble, input, push);
      for (push.iteration = 0; push.iteration < settings_.iterations; ++push.iteration) list_stage(Stage::linear, input, push);
    }
    const std::uint32_t iterations = implicit ? 1 : settings_.iterations;
    for (std::uint32_t k = 0; k < iterations; ++k) {
      push.flags = flags | (k == 0 ? WEFT_FIRST_ITERATION : 0) | (k + 1 == iterations ? WEFT_LAST_ITERATION : 0) | turn_ << WEFT_TURN_SHIFT;
      push.momentum = k == 0 ? 1 : static_cast<float>(k == 1 ? 2 / (2 - rho_ * rho_) : 4 / (4 - rho_ * rho_ * push.momentum));
      list_stage(Stage::iteration, input, push);
      for (std::uint32_t c = 0; c < contact_iterations_; ++c) list_stage(Stage::contact, input, push);
    }
    push.flags = flags;
    list_stage(Stage::substep_end, input, push);
  }
  list_stage(Stage::frame_end, input, push);
  return steps_;
}

std::span<const Solver::Step> Solver::surface() {
  steps_.clear();
  gpu::Push push{};
  push.origin = origin_;
  list_stage(Stage::frame_end, {}, push);
  return steps_;
}

void Solver::list_stage(Stage stage, const FrameInput& input, gpu::Push push) {
  for (std::uint32_t k = 0; k < plan_.passes.size(); ++k) {
    const Pass& pass = *plan_.passes[k].pass;
    const bool arrived = pass.domain == Domain::anchors && !input.anchors_move;
    // With contacts an anchor that was held back may still be on its way.
    if (pass.stage != stage || (arrived && !has(gpu::detection))) continue;
    for (std::uint32_t round = 0; round < rounds_[k]; ++round) {
      gpu::Push told = push;
      told.count = counts_[k];
      if (arrived) told.fraction_from = told.fraction_to = 1;
      set_round(pass.domain, round, told);
      steps_.push_back({k, parity_, told});
    }
    if (pass.relaxes) parity_ ^= 1;
  }
}

void Solver::set_round(Domain domain, std::uint32_t round, gpu::Push& push) const {
  if (domain != Domain::coloured) {
    push.flags |= round << WEFT_ROUND_SHIFT;
    return;
  }
  push.first = round == 0 ? 0 : colour_ends_[round - 1];
  push.count = colour_ends_[round] - push.first;
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
  const PassResources& resources = resources_[step.pass];
  const auto indirect = indirect_offset(planned.pass->domain);
  recorder.begin_pass(planned.label.c_str(), mask(planned.reads, step.parity), mask(planned.writes, step.parity),
                      indirect ? std::uint64_t(1) << gpu::detection : 0);
  const VkDescriptorSet sets[] = {sets_[step.pass].storage[step.parity].handle(), sets_[step.pass].texel[step.parity].handle()};
  recorder.bind(resources.pipeline.handle(), resources.layout.get(), sets);
  recorder.push(resources.layout.get(), std::as_bytes(std::span(&step.push, 1)));
  if (indirect) recorder.dispatch_indirect(buffer(gpu::detection).handle, *indirect);
  else recorder.dispatch(planned.pass->domain == Domain::once ? 1 : planned.pass->domain == Domain::cloths ? cloths_ : (step.push.count + workgroup_ - 1) / workgroup_);
}

std::uint64_t Solver::mask(std::uint64_t bindings, std::uint32_t parity) const {
  if (parity == 0) return bindings;
  const std::uint64_t predicted = bindings >> gpu::predicted & 1, relaxed = bindings >> gpu::relaxed & 1;
  const std::uint64_t both = std::uint64_t(1) << gpu::predicted | std::uint64_t(1) << gpu::relaxed;
  return (bindings & ~both) | predicted << gpu::relaxed | relaxed << gpu::predicted;
}

const compute::Buffer& Solver::buffer(gpu::Binding binding) const {
  std::size_t places[2] = {0, 0};
  for (const BufferNeed& need : needs_) {
    if (need.binding == binding) return need.grows ? growing_arena_[places[1]] : arena_[places[0]];
    ++places[need.grows];
  }
  assert(!"not a buffer of the plan");
  return arena_[0];
}

std::uint64_t Solver::used_bytes(gpu::Binding binding) const {
  const auto need = std::find_if(needs_.begin(), needs_.end(), [binding](const BufferNeed& n) { return n.binding == binding; });
  return need == needs_.end() ? 0 : need->bytes;
}

std::vector<const compute::Buffer*> Solver::buffers() const {
  std::vector<const compute::Buffer*> all;
  for (const BufferNeed& need : needs_) all.push_back(&buffer(need.binding));
  return all;
}

}  // namespace weft
