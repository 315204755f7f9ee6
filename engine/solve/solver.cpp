#include "engine/solve/solver.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "engine/effects/contact/contact.h"
#include "engine/effects/motion/motion.h"
#include "engine/solve/sizes.h"

namespace weft {
namespace {

// `predicted` and `next_iterate` trade places; everything else is itself.
std::size_t in_role(std::size_t number, std::uint32_t parity) {
  static const std::size_t predicted = number_of(buffers::predicted), next = number_of(buffers::next_iterate);
  if (parity == 0) return number;
  return number == predicted ? next : number == next ? predicted : number;
}

VkFormat texel_format(Texel texel) {
  switch (texel) {
    case Texel::float4: return VK_FORMAT_R32G32B32A32_SFLOAT;
    case Texel::uint4: return VK_FORMAT_R32G32B32A32_UINT;
    case Texel::uint2: return VK_FORMAT_R32G32_UINT;
    case Texel::uint1: return VK_FORMAT_R32_UINT;
    case Texel::none: break;
  }
  return VK_FORMAT_UNDEFINED;
}

// No device asks for more (Vulkan, minUniformBufferOffsetAlignment).
constexpr std::size_t kSliceAlignment = 256;

// The sets of a pass, by the number that its shader gives them.
constexpr std::uint32_t kSets[] = {WEFT_STORAGE_SET, WEFT_TEXEL_SET};
constexpr const char* kSetNames[] = {" storage", " texels"};

compute::Touches touches_of(const PlannedPass& planned, std::uint32_t parity) {
  compute::Touches touches;
  for (const PlannedPass::Resource& resource : planned.resources) {
    if (resource.kind != PlannedPass::Resource::Kind::buffer) continue;
    const std::size_t number = in_role(resource.number, parity);
    if (resource.binding.read) touches.reads.insert(number);
    if (resource.binding.written) touches.writes.insert(number);
  }
  if (const Buffer* arguments = planned.pass->threads.arguments.buffer) touches.arguments.insert(number_of(*arguments));
  return touches;
}

std::vector<std::byte> first_contents(const Buffer& row, std::uint64_t bytes, const Cooked& subject, std::span<const std::byte>& view) {
  if (row.contents != nullptr) {
    Contents contents = row.contents(subject);
    view = contents.bytes();
    return std::move(contents.made);
  }
  if (row.lifetime != Lifetime::persistent && row.lifetime != Lifetime::cleared) return {};
  std::vector<std::byte> words(bytes);
  for (std::size_t at = 0; at + sizeof row.word <= bytes; at += sizeof row.word) std::memcpy(words.data() + at, &row.word, sizeof row.word);
  view = words;
  return words;
}

}  // namespace

Result<Solver> Solver::create(const compute::Device& device, const compute::PipelineCache& cache, const Scene& scene,
                              const CookedFabric& fabric, const SolverOptions& options) {
  Solver solver;
  solver.device_ = &device;
  solver.shape_ = shape_of(scene);
  solver.rho_ = rho_of(scene.solver);
  const Cooked subject = cooked_of(scene, fabric);
  solver.contacts_ = subject.contacts;
  solver.vertex_usage_ = options.vertex_usage;
  // Both are measured choices: the software driver runs a workgroup on one core, GPUs want full warps and waves.
  solver.workgroup_ = options.workgroup != 0 ? options.workgroup : device.is_software() ? 512 : 64;
  if (solver.workgroup_ > device.limits().max_workgroup_invocations)
    return fail("a workgroup of ", solver.workgroup_, " threads is larger than the device's ", device.limits().max_workgroup_invocations);
  // There eight threads are one, and wait for nobody at a barrier. But each has no more than 65,535 turns of all its loops together: then
  // they end without a word (llvmpipe's LP_MAX_TGSI_LOOP_ITERATIONS).
  const std::uint32_t narrow = device.is_software() ? 8 : WEFT_PATCH_THREADS;
  const std::uint32_t alone = device.is_software() ? 8 : std::min(512u, device.limits().max_workgroup_invocations);
  const std::uint32_t crew = device.is_software() ? 128 : std::min(1024u, device.limits().max_workgroup_invocations);
  // Threads of a warp wait for each other. (H200, drop of 200 x 200, grid_search and cluster_box in workgroups of 64, 16, 8, 4, 2 and 1:
  // 1.32, 1.18, 1.04, 0.90, 0.85, 0.90 ms a frame; smaller GPUs have fewer places for workgroups.) On the software driver it is all the same.
  const std::uint32_t thin = device.is_software() ? 8 : 4;
  solver.needs_ = needs_of(subject, solver.workgroup_, !options.gather_storage, narrow, alone, crew, thin,
                           options.idle_costs.value_or(device.is_software()));
  solver.needs_.storage_buffers = device.limits().max_storage_buffers_per_stage;
  auto plan = make_plan(solver.needs_, device.specializer());
  if (!plan) return plan.take_error();
  solver.plan_ = std::move(*plan);
  solver.has_seldom_ =
      std::ranges::any_of(solver.plan_.passes, [](const PlannedPass& planned) { return planned.pass->crowd == Crowd::seldom; });
  const SizeLimits limits{device.limits().max_storage_buffer_bytes, device.limits().max_workgroups_x, solver.workgroup_};
  if (std::string fault = beyond(limits, device.name(), solver.plan_, subject); !fault.empty()) return Error{std::move(fault)};
  if (auto made = solver.create_buffers(subject); !made) return made.take_error();
  if (auto made = solver.create_runs(subject, cache); !made) return made.take_error();
  solver.motion_.origin = {options.origin.x, options.origin.y, options.origin.z};
  solver.set_uniforms("motion", solver.motion_);
  solver.contacts_.workgroup = solver.workgroup_;
  solver.contacts_.thin_workgroup = solver.needs_.thin;
  solver.contacts_.most_turns = device.is_software() ? WEFT_MOST_TURNS : 1u << 20;   // a GPU ends no loop; these take it a moment
  solver.set_uniforms("contact_settings", solver.contacts_);
  if (!solver.uniforms_.empty())
    if (auto done = compute::upload(device, solver.arena_[solver.arena_.size() - 1], solver.uniforms_); !done) return done.take_error();
  return solver;
}

// The buffers of the plan that grow with the contact capacity; or all others, and after them the uniform buffer.
Result<compute::Arena> Solver::create_arena(bool grows) const {
  std::vector<compute::BufferRequest> requests;
  const Plan::PlannedBuffer* predicted = plan_.find(buffers::predicted);
  for (std::size_t k = 0; k < plan_.buffers.size(); ++k) {
    const Plan::PlannedBuffer& planned = plan_.buffers[k];
    const Buffer& row = *planned.row;
    if (row.grows != grows) continue;
    compute::BufferRequest request{std::string(row.name), places_[k].bytes,
                                   VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    // Both iterates are bound in both roles.
    const bool iterate = predicted != nullptr && (&row == &buffers::predicted || &row == &buffers::next_iterate);
    const auto is_bound = [&](bool Plan::PlannedBuffer::*way) { return planned.*way || (iterate && predicted->*way); };
    const bool texels = is_bound(&Plan::PlannedBuffer::texels), shared = is_bound(&Plan::PlannedBuffer::shared_texels);
    if (is_bound(&Plan::PlannedBuffer::storage)) request.usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    if (texels) request.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    if (shared) request.usage |= VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT;
    if (texels || shared) request.texel_format = texel_format(row.texel);
    if (row.access == Access::vertices) request.usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | vertex_usage_;
    if (row.access == Access::arguments) request.usage |= VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    requests.push_back(std::move(request));
  }
  if (!grows && !uniforms_.empty())
    requests.push_back({"slices", uniforms_.size(), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  return compute::Arena::create(*device_, compute::Memory::device, grows ? "weft candidates" : "weft", requests);
}

Result<void> Solver::create_buffers(const Cooked& subject) {
  std::size_t counts[2] = {0, 0};
  for (const Plan::PlannedBuffer& planned : plan_.buffers)
    places_.push_back({room_of(*planned.row, subject), counts[planned.row->grows]++});
  for (const Slice* slice : plan_.slices) {
    const Contents first = slice->first(subject);
    slices_.push_back({uniforms_.size(), first.bytes().size()});
    uniforms_.insert(uniforms_.end(), first.bytes().begin(), first.bytes().end());
    uniforms_.resize((uniforms_.size() + kSliceAlignment - 1) / kSliceAlignment * kSliceAlignment);
    if (slice->name == "motion") std::memcpy(&motion_, first.bytes().data(), sizeof motion_);
  }
  auto arena = create_arena(false);
  if (!arena) return fail(cause_of_size(false, subject), ": ", arena.why());
  arena_ = std::move(*arena);
  if (counts[1] > 0) {
    auto growing = create_arena(true);
    if (!growing) return fail(cause_of_size(true, subject), ": ", growing.why());
    growing_arena_ = std::move(*growing);
  }
  std::vector<std::vector<std::byte>> made;   // until they are uploaded
  std::vector<compute::Upload> uploads;
  for (std::size_t k = 0; k < plan_.buffers.size(); ++k) {
    const Buffer& row = *plan_.buffers[k].row;
    std::span<const std::byte> view;
    made.push_back(first_contents(row, places_[k].bytes, subject, view));
    if (!view.empty()) uploads.push_back({&buffer(row), view});
  }
  return compute::upload_all(*device_, uploads);
}

Result<void> Solver::create_runs(const Cooked& subject, const compute::PipelineCache& cache) {
  for (const PlannedPass& planned : plan_.passes) {
    Run run;
    run.ranges = ranges_of(*planned.pass, subject);
    if (planned.pass->every != nullptr) run.every = planned.pass->every(subject);
    if (planned.pass->threads.groups != nullptr) run.groups = static_cast<std::uint32_t>(planned.pass->threads.groups(subject));
    for (const std::uint32_t parity : {0u, 1u}) run.touches[parity] = touches_of(planned, parity);
    auto compiled = device_->passes().get(planned.label, planned.spirv, [&] { return compile(planned, cache); });
    if (!compiled) return compiled.take_error();
    run.compiled = std::move(*compiled);
    runs_.push_back(std::move(run));
  }
  auto sets = write_sets();
  if (!sets) return sets.take_error();
  sets_ = std::move(*sets);
  return {};
}

Result<compute::CompiledPass> Solver::compile(const PlannedPass& planned, const compute::PipelineCache& cache) const {
  compute::CompiledPass made;
  VkDescriptorSetLayout handles[2];
  for (const std::uint32_t set : kSets) {
    std::vector<compute::DescriptorBinding> bindings;
    std::uint32_t storage = 0;
    for (const PlannedPass::Resource& resource : planned.resources) {
      if (resource.binding.set != set) continue;
      bindings.push_back({resource.binding.binding, compute::descriptor_type(resource.binding.kind)});
      storage += resource.binding.kind == compute::Binding::Kind::storage_buffer;
    }
    if (storage > device_->limits().max_storage_buffers_per_stage)
      return fail("pass ", planned.label, " uses ", storage, " storage buffers; the device has ",
                  device_->limits().max_storage_buffers_per_stage, " a stage");
    auto layout = compute::DescriptorLayout::create(*device_, planned.label + kSetNames[set], bindings);
    if (!layout) return layout.take_error();
    made.layouts[set] = std::move(*layout);
    handles[set] = made.layouts[set].handle();
  }
  auto layout = compute::create_pipeline_layout(*device_, planned.label, handles, sizeof(gpu::Push));
  if (!layout) return layout.take_error();
  made.layout = std::move(*layout);
  auto pipeline = compute::ComputePipeline::create(*device_, &cache, planned.label, planned.spirv, {}, made.layout.get());
  if (!pipeline) return pipeline.take_error();
  made.pipeline = std::move(*pipeline);
  return made;
}

// All of them or none.
Result<std::vector<Solver::Sets>> Solver::write_sets() const {
  std::vector<Sets> all(runs_.size());
  for (std::size_t k = 0; k < runs_.size(); ++k)
    for (const std::uint32_t parity : {0u, 1u})
      for (const std::uint32_t set : kSets) {
        std::vector<compute::BoundBuffer> bound;
        for (const PlannedPass::Resource& resource : plan_.passes[k].resources) {
          if (resource.binding.set != set) continue;
          if (resource.kind == PlannedPass::Resource::Kind::slice)
            bound.push_back(
                {resource.binding.binding, &arena_[arena_.size() - 1], slices_[resource.number].at, slices_[resource.number].bytes});
          else
            bound.push_back({resource.binding.binding, &buffer(*all_buffers()[in_role(resource.number, parity)])});
        }
        auto written = compute::DescriptorSet::create(*device_, plan_.passes[k].label + kSetNames[set] + (parity == 0 ? " even" : " odd"),
                                                      runs_[k].compiled->layouts[set], bound);
        if (!written) return written.take_error();
        all[k].sets[parity][set] = std::move(*written);
      }
  return all;
}

Result<Solver::Outgrown> Solver::grow(std::uint32_t candidates) {
  if ((std::uint64_t(WEFT_NEAR) * candidates + workgroup_ - 1) / workgroup_ > device_->limits().max_workgroups_x)
    return fail(candidates, " contact candidates need more workgroups than the device's ", device_->limits().max_workgroups_x);
  const auto set_capacity = [&](std::uint32_t capacity) {
    for (std::size_t k = 0; k < places_.size(); ++k)
      if (plan_.buffers[k].row->grows) places_[k].bytes = places_[k].bytes / contacts_.capacity * capacity;
    for (std::size_t k = 0; k < runs_.size(); ++k)
      if (plan_.passes[k].pass->threads.grows)
        for (Range& range : runs_[k].ranges) range.count = range.count / contacts_.capacity * capacity;
    contacts_.capacity = capacity;
    set_uniforms("contact_settings", contacts_);
  };
  // As errors: after an exception the capacity would stay.
  const auto made_by = [](auto make) -> decltype(make()) {
    try {
      return make();
    } catch (...) {
      return caught("contact candidates");
    }
  };
  const std::uint32_t before = contacts_.capacity;
  Outgrown outgrown;
  outgrown.candidates = buffer(buffers::candidates).handle;
  outgrown.bytes = buffer(buffers::candidates).bytes;
  set_capacity(candidates);
  auto arena = made_by([&] { return create_arena(true); });
  if (arena) {
    std::swap(growing_arena_, *arena);
    auto sets = made_by([&] { return write_sets(); });
    if (sets) {
      outgrown.buffers = std::move(*arena);
      outgrown.sets = std::exchange(sets_, std::move(*sets));
      return outgrown;
    }
    std::swap(growing_arena_, *arena);
    arena = sets.take_error();
  }
  set_capacity(before);   // shaders check against it: it must never exceed the buffers
  return arena.take_error();
}

Result<void> Solver::fits(const Cooked& subject) const {
  const bool through_texels = needs_.constants[gpu::constant::through_texels] != 0;
  const Needs wanted = needs_of(subject, workgroup_, through_texels, needs_.narrow, needs_.alone, needs_.crew, needs_.thin,
                                needs_.constants[gpu::constant::idle_costs] != 0);
  if (wanted.effects != needs_.effects || wanted.constants != needs_.constants) return fail("its passes would be others");
  for (std::size_t k = 0; k < plan_.buffers.size(); ++k) {
    const Buffer& row = *plan_.buffers[k].row;
    if (!row.grows && bytes_of(row, subject) > places_[k].bytes) return fail("its ", row.name, " would be longer than there is room for");
  }
  return {};
}

void Solver::follow(const Cooked& subject) {
  std::vector<std::vector<Range>> ranges;
  for (const PlannedPass& planned : plan_.passes) ranges.push_back(ranges_of(*planned.pass, subject));
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const Pass& pass = *plan_.passes[k].pass;
    if (pass.threads.grows) continue;   // as long as the capacity
    runs_[k].ranges = std::move(ranges[k]);
    if (pass.threads.groups != nullptr) runs_[k].groups = static_cast<std::uint32_t>(pass.threads.groups(subject));
  }
  const gpu::ContactSettings before = contacts_;
  contacts_ = subject.contacts;
  contacts_.capacity = before.capacity;
  contacts_.workgroup = before.workgroup;
  contacts_.thin_workgroup = before.thin_workgroup;
  contacts_.most_turns = before.most_turns;
  set_uniforms("contact_settings", contacts_);
}

// It is a matter of time, and of how seldom detections are: with the clusters of a sheet of 200 x 200 one takes as long as what it saves in
// a frame.
bool Solver::can_detect_alone() const {
  constexpr std::uint32_t kMost = 8192;   // clusters
  return has_seldom_ && contacts_.clusters <= kMost;
}

std::span<const Solver::Step> Solver::frame(const FrameInput& input) {
  steps_.clear();
  if (input.substeps == 0) return {};
  const std::uint32_t parity = parity_, phase = phase_;
  try {
    list_frame(input);
  } catch (...) {   // no memory for the steps: as if it had not been asked for
    parity_ = parity;
    phase_ = phase;
    throw;
  }
  return steps_;
}

void Solver::list_frame(const FrameInput& input) {
  gpu::Push push{};
  walk_frame(shape_, input.substeps, [&](const Moment& moment) {
    const std::uint32_t substep_flags = moment.substep + 1 == input.substeps ? WEFT_LAST_SUBSTEP : 0;
    switch (moment.stage) {
      case Stage::substep_begin:
        push.flags = substep_flags;
        push.fraction_from = static_cast<float>(moment.substep) / static_cast<float>(input.substeps);
        push.fraction_to = static_cast<float>(moment.substep + 1) / static_cast<float>(input.substeps);
        break;
      case Stage::linear: push.iteration = moment.iteration; break;
      case Stage::iteration: {
        const std::uint32_t k = moment.iteration;
        if (shape_.implicit) push.iteration = shape_.iterations;
        push.flags = substep_flags | (k == 0 ? WEFT_FIRST_ITERATION : 0) | (k + 1 == shape_.solver_iterations() ? WEFT_LAST_ITERATION : 0) |
                     phase_ << WEFT_PHASE_SHIFT;
        push.omega = k == 0 ? 1 : static_cast<float>(k == 1 ? 2 / (2 - rho_ * rho_) : 4 / (4 - rho_ * rho_ * push.omega));
        break;
      }
      case Stage::substep_end: push.flags = substep_flags; break;
      default: break;
    }
    list(moment.stage, input, push, input.first_substep + moment.substep);
    if (moment.stage == Stage::detect) phase_ = (phase_ + 1) % 3;
  });
}

std::span<const Solver::Step> Solver::surface() {
  steps_.clear();
  list(Stage::frame_end, {}, {}, 0);
  return steps_;
}

// Whether contact_alone ends substeps, should there be contacts at all.
bool Solver::ends_with_contacts(const FrameInput& input) const {
  return input.few_contacts && input.no_contacts && needs_.constants[gpu::constant::idle_costs] == 0;
}

bool Solver::is_recorded(Crowd crowd, const FrameInput& input) const {
  const bool detects = !input.is_still, solves = detects || !input.has_no_candidates;
  const bool seldom = has_seldom_ && input.seldom_detections;
  const bool calm = seldom && input.few_contacts && (input.kinematics_rest || !has(buffers::crossed_triangles));
  switch (crowd) {
    case Crowd::any: return true;
    case Crowd::few: return solves && input.few_contacts;
    case Crowd::many: return solves && !input.few_contacts;
    case Crowd::seldom: return detects && seldom;
    case Crowd::often: return detects && !seldom;
    case Crowd::calm: return detects && calm;
    case Crowd::stirred: return detects && !calm;
    case Crowd::met: return solves && !ends_with_contacts(input);
    case Crowd::sought: return detects;
    case Crowd::decided: return detects ? !seldom : solves;
    case Crowd::prepared: return detects ? !calm : solves;
  }
  return true;
}

// What ends an iteration has an end.
std::uint32_t Solver::sweeps(std::size_t pass, float haste) const {
  const PlannedPass& planned = plan_.passes[pass];
  return planned.pass->sweeps == nullptr || planned.finalizes ? 1 : planned.pass->sweeps(needs_, haste);
}

void Solver::list(Stage stage, const FrameInput& input, const gpu::Push& push, std::uint64_t substep) {
  for (std::uint32_t k = 0; k < plan_.passes.size();) {
    const std::uint32_t first = k++, times = sweeps(first, input.haste);
    while (times > 1 && k < plan_.passes.size() && sweeps(k, input.haste) == times) ++k;
    for (std::uint32_t sweep = 0; sweep < times; ++sweep)
      for (std::uint32_t pass = first; pass < k; ++pass) list(pass, stage, input, push, substep, sweep);
  }
}

void Solver::list(std::uint32_t k, Stage stage, const FrameInput& input, const gpu::Push& push, std::uint64_t substep, std::uint32_t sweep) {
  const Pass& pass = *plan_.passes[k].pass;
  if (pass.stage != stage || !is_recorded(pass.crowd, input)) return;
  if (substep % runs_[k].every != 0) return;
  const bool at_targets = pass.only_towards_targets && !input.anchors_move;
  // With contacts, an anchor that cloth held back may not have reached its target.
  if (at_targets && (!has(buffers::detection) || input.kinematics_rest)) return;
  if (pass.only_after_motion && input.kinematics_rest) return;
  for (std::uint32_t round = 0; round < runs_[k].ranges.size(); ++round) {
    gpu::Push own = push;
    if (sweep > 0) own.flags &= ~WEFT_FIRST_ITERATION;
    own.first = runs_[k].ranges[round].first;
    own.count = runs_[k].ranges[round].count;
    if (at_targets) own.fraction_from = own.fraction_to = 1;
    if (pass.rounds > 1) own.flags |= round << WEFT_PASS_SHIFT;
    if (pass.can_end_substep && ends_with_contacts(input) && (push.flags & WEFT_LAST_ITERATION) != 0) own.flags |= WEFT_ENDS_SUBSTEP;
    steps_.push_back({k, parity_, own});
  }
  if (pass.changes == Changes::iterate) parity_ ^= 1;
}

void Solver::set_uniform_bytes(std::string_view slice, std::span<const std::byte> bytes) {
  for (std::size_t k = 0; k < plan_.slices.size(); ++k)
    if (plan_.slices[k]->name == slice)
      std::copy(bytes.begin(), bytes.end(), uniforms_.begin() + static_cast<std::ptrdiff_t>(slices_[k].at));
}

const compute::Buffer& Solver::buffer(const Buffer& row) const {
  const Plan::PlannedBuffer* planned = plan_.find(row);
  assert(planned != nullptr && "not a buffer of the plan");
  const Place& place = places_[static_cast<std::size_t>(planned - plan_.buffers.data())];
  return row.grows ? growing_arena_[place.index] : arena_[place.index];
}

std::uint64_t Solver::used_bytes(const Buffer& row) const {
  const Plan::PlannedBuffer* planned = plan_.find(row);
  return planned == nullptr ? 0 : places_[static_cast<std::size_t>(planned - plan_.buffers.data())].bytes;
}

std::vector<const compute::Buffer*> Solver::buffers() const {
  std::vector<const compute::Buffer*> all;
  for (const Plan::PlannedBuffer& planned : plan_.buffers) all.push_back(&buffer(*planned.row));
  if (!uniforms_.empty()) all.push_back(&arena_[arena_.size() - 1]);
  return all;
}

}  // namespace weft
