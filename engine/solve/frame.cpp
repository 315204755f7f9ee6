// A frame: how many substeps it takes, where anchors and colliders go, and the three ways to run it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "compute/functions.h"
#include "engine/effects/collide/collide.h"
#include "engine/effects/triangle/triangle.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

gpu::vec3 gpu_vector(Vec3 v) { return {v.x, v.y, v.z}; }

bool same(const gpu::vec3& a, const gpu::vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// The rotation from one to another by the shorter arc, as an axis times an angle (rad).
Vec3 spin_between(const Rotation& from, const Rotation& to) {
  const Rotation relative = to * Rotation{-from.x, -from.y, -from.z, from.w};
  const Vec3 sine = (relative.w < 0 ? -1.0f : 1.0f) * Vec3{relative.x, relative.y, relative.z};
  const float size = length(sine);
  return size > 0 ? (2 * std::atan2(size, std::abs(relative.w)) / size) * sine : Vec3{};
}

// Keys may rotate by more than half a turn in a frame, which the two rotations alone do not show.
Vec3 spin_between(const Key& from, const Key& to) {
  if (!(from.axis == to.axis)) return spin_between(rotation_about(from.axis, from.degrees), rotation_about(to.axis, to.degrees));
  return static_cast<float>((to.degrees - from.degrees) * std::numbers::pi / 180) * to.axis;
}

using Stopwatch = std::chrono::steady_clock;
double milliseconds(Stopwatch::time_point from, Stopwatch::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

ColliderPose keyed_pose(const Collider& collider, const Key& key) {
  const Rotation rotation = rotation_about(key.axis, key.degrees);
  return {collider.centre + key.translate, rotated(rotation, collider.normal), rotation * rest_rotation(collider)};
}

// What is known of kinematic particles is so no longer. The frame that is planned may not be one of those that are submitted.
void Simulation::State::stir() {
  kinematic.still_since = queue.submitted + 2;
  kinematic.rest = false;
}

// Whole substeps that fit; the rest waits for the next frame. A millionth of a substep counts as rounding, so that 1/60 s
// is always the same number of them.
Result<Advance> Simulation::State::plan_frame(double seconds, FrameInput& input) {
  if (!std::isfinite(seconds) || seconds < 0) return fail("a frame of ", seconds, " s: it must be finite and not negative");
  Advance advance;
  const double taken = std::min(seconds, scene.solver.longest_advance);
  advance.clamped = seconds - taken;
  const double substeps = std::floor((clock.left_over + taken) / fabric.h + 1e-6);
  advance.substeps = static_cast<std::uint32_t>(substeps);
  advance.simulated = substeps * fabric.h;
  clock.left_over = std::max(0.0, clock.left_over + taken - advance.simulated);
  input.substeps = advance.substeps;
  input.first_substep = clock.substeps;
  input.gravity = gravity;
  input.few_contacts = contacts_are_few();
  input.no_contacts = capacity.load == 0;
  if (advance.substeps == 0) {   // its report says nothing new
    if (!kinematic.rest) stir();
    return advance;
  }
  follow_holds();
  if (auto torn = follow_tears(); !torn) return torn.take_error();
  input.edits = holds.edits;
  input.seldom_detections = detections_are_seldom();
  if (scene.air) {
    input.air = air_of(*scene.air, moving_air, now(), advance.simulated, origin);
    moving_air.pass(advance.simulated);
  }
  clock.substeps += advance.substeps;
  move_scene(advance.simulated, input);
  input.haste = haste_after(advance);
  input.is_driven = contacts_on(scene) && is_driven();
  if (input.anchors_move || !input.edits.empty() || !input.frame_changes.empty()) stir();
  input.kinematics_rest = kinematic.rest;
  return advance;
}

// Moves a collider to its pose at the frame's end; returns its rotation in this frame, as an axis times an angle (rad).
Vec3 Simulation::State::move_collider_on(std::uint32_t collider) {
  const Collider& described = scene.colliders[collider];
  ColliderPose& pose = bodies.poses[collider];
  Vec3 spin;
  if (std::optional<ColliderPose>& pending = bodies.pending[collider]) {
    spin = spin_between(pose.rotation, pending->rotation);
    pose = *pending;
    pending.reset();
  } else if (!bodies.is_host_driven[collider] && !described.keys.empty()) {
    const Key key = pose_at(described.keys, now());
    const ColliderPose to = keyed_pose(described, key);
    const bool was_placed = !(keyed_pose(described, bodies.keys[collider]).rotation == pose.rotation);
    spin = was_placed ? spin_between(pose.rotation, to.rotation) : spin_between(bodies.keys[collider], key);
    pose = to;
    bodies.keys[collider] = key;
  }
  return spin;
}

const ColliderMesh* Simulation::State::mesh_of(std::uint32_t collider) const {
  for (const ColliderMesh& mesh : fabric.collider_meshes)
    if (mesh.collider == collider) return &mesh;
  return nullptr;
}

// Their particles are kinematic targets, as anchors are: each moves along a straight line to its next position.
void Simulation::State::move_collider_meshes() {
  auto at = kinematic.targets.begin() + static_cast<std::ptrdiff_t>(anchors_and_pins());
  for (std::size_t m = 0; m < fabric.collider_meshes.size(); ++m) {
    const ColliderMesh& mesh = fabric.collider_meshes[m];
    const ColliderPose from = bodies.poses[mesh.collider];
    move_collider_on(mesh.collider);
    const ColliderPose& to = bodies.poses[mesh.collider];
    if (!bodies.meshes.empty()) bodies.meshes[m].centre_from = gpu_vector(from.centre), bodies.meshes[m].centre_to = gpu_vector(to.centre);
    if (!(from.centre == to.centre) || !(from.rotation == to.rotation))
      for (std::uint32_t k = 0; k < mesh.particles; ++k)
        at[static_cast<std::ptrdiff_t>(k)].to = gpu_vector(collider_point(fabric, mesh, k, to.centre, to.rotation));
    at += mesh.particles;
  }
}

// Whether something may push cloth along, by the scene or by the host, whose anchors need no keys.
bool Simulation::State::is_driven() const {
  return weft::is_driven(scene) || std::ranges::find(kinematic.is_host_driven, true) != kinematic.is_host_driven.end();
}

void Simulation::State::move_anchors() {
  const std::vector<Vec3> keyed = kinematic.are_keyed ? anchor_targets(scene, fabric, now()) : std::vector<Vec3>();
  for (gpu::Anchor& anchor : kinematic.targets) {
    const bool stays = anchor.particle != WEFT_NONE && (anchor.particle & WEFT_STAYS) != 0;
    if (anchor.particle != WEFT_NONE && !stays) anchor.particle &= ~WEFT_FROM_HERE;
    anchor.from = anchor.to;
  }
  for (std::size_t k = 0; k < keyed.size(); ++k)
    if (!kinematic.is_host_driven[k]) kinematic.targets[k].to = gpu_vector(keyed[k]);
  for (std::size_t k = 0; k < kinematic.pending.size(); ++k) {
    gpu::Anchor& anchor = kinematic.targets[k];
    if (kinematic.pending[k]) {
      anchor.to = gpu_vector(*kinematic.pending[k]);
      if ((anchor.particle & WEFT_STAYS) != 0) anchor.particle ^= WEFT_STAYS | WEFT_FROM_HERE;
    }
    kinematic.pending[k].reset();
  }
}

// Tells how far an anchor goes in a frame.
void Simulation::State::hasten(std::uint32_t particle, Vec3 from, Vec3 to) {
  const std::uint32_t body = body_of(fabric, particle);
  const float link = body < kinematic.links.size() ? kinematic.links[body] : 0;   // else of a mesh collider
  if (link > 0) kinematic.way = std::max(kinematic.way, length(to - from) / link);
}

// What an anchor has set moving swings on when it stops: haste goes by half in half a second.
float Simulation::State::haste_after(const Advance& advance) {
  constexpr double kHalfLife = 0.5;   // s
  kinematic.haste *= static_cast<float>(std::exp2(-advance.simulated / kHalfLife));
  const float now = advance.substeps > 0 ? kinematic.way / static_cast<float>(advance.substeps) : 0;
  kinematic.haste = std::max(kinematic.haste, std::min(now, 1.0f));
  return kinematic.haste;
}

// Colliders with bones go where joints have them at the frame's end.
void Simulation::State::move_carried(std::span<const Affine> pose) {
  for (const auto& [collider, joint] : fabric.own.of<SkinLists>().bones) {
    const ColliderPose to = carried_pose(scene.colliders[collider], pose[joint]);
    if (!(to == bodies.poses[collider])) bodies.pending[collider] = to;
  }
}

gpu::BodySize Simulation::State::size_to_vertices(std::uint32_t collider) const {
  ColliderSize size = bodies.sizes[collider];
  const std::vector<float>& stand_offs = fabric.own.of<TriangleLists>().stand_offs;
  if (!stand_offs.empty()) {
    size.radius += stand_offs[collider];
    size.radius_end += stand_offs[collider];
  }
  return body_size(scene.colliders[collider].shape, size);
}

void Simulation::State::move_scene(double seconds, FrameInput& input) {
  const std::vector<Affine> pose = next_pose();
  const std::vector<float> weights = next_weights();
  const std::vector<ColliderPose> before = pose.empty() ? std::vector<ColliderPose>() : bodies.poses;
  kinematic.way = 0;
  input.anchors_move = kinematic.are_dirty || scene.pins > 0;   // pins always: the anchor pass tells their velocities
  move_anchors();
  move_carried(pose);
  move_collider_meshes();
  move_frames(pose, seconds, input);
  move_skins(pose, weights, before, input);
  move_grabs();
  for (const gpu::Anchor& anchor : kinematic.targets) {
    if (same(anchor.from, anchor.to)) continue;
    input.anchors_move = true;
    if ((anchor.particle & (WEFT_STAYS | WEFT_FROM_HERE)) != 0) continue;   // nobody, or from where only the GPU knows
    const gpu::vec3 &from = anchor.from, &to = anchor.to;
    hasten(anchor.particle, {from.x, from.y, from.z}, {to.x, to.y, to.z});
  }
  bodies.colliders.clear();
  bodies.from_sizes.clear();
  for (const std::uint32_t k : bodies.order) {
    const Collider& described = scene.colliders[k];
    const ColliderPose from = bodies.poses[k];
    const Vec3 spin = move_collider_on(k);
    const ColliderPose& to = bodies.poses[k];
    bodies.from_sizes.push_back(size_to_vertices(k));
    if (std::optional<ColliderSize>& pending = bodies.pending_sizes[k]) bodies.sizes[k] = *pending;
    bodies.pending_sizes[k].reset();
    const gpu::BodySize size = size_to_vertices(k);
    const Rotation& start = from.rotation;
    bodies.colliders.push_back({gpu_vector(from.centre), size.radius, gpu_vector(to.centre), static_cast<float>(described.friction),
                                gpu_vector(from.normal), gpu_vector(to.normal), gpu_vector(spin), {start.x, start.y, start.z, start.w},
                                size.half_size});
  }
  bodies.colliders.insert(bodies.colliders.end(), bodies.meshes.begin(), bodies.meshes.end());
  kinematic.are_dirty = input.anchors_move;
  input.anchors = kinematic.targets;
  input.grabs = grabs.corners;
  input.gas_amounts = gas_amounts;
  input.colliders = bodies.colliders;
  input.body_sizes = bodies.from_sizes;
}

// Reports at `place` of `readback`.
void Simulation::State::record_frame(VkCommandBuffer commands, const FrameInput& input, compute::Timestamps* timestamps, bool save,
                                     std::size_t place) {
  using compute::Use;
  const auto steps = solver->frame(input);   // all that takes memory comes before the first command
  compute::Recorder recorder(*device, commands, timestamps);
  constexpr Use kOwn = Use::compute | Use::transfer | Use::indirect;
  // Earlier frames, and the renderer that still reads them.
  recorder.barrier(options.readers ? compute::Users(kOwn, *options.readers) : Use::all, kOwn);
  record_growth(recorder);
  if (rollback.frame_is_torn) {
    copy_saved(commands, true);
    recorder.barrier(Use::transfer, kOwn);
  }
  if (save) copy_saved(commands, false);
  if (!steps.empty()) {
    solver->record_input(recorder, input);   // writes nothing that is saved, and its barrier to the steps is that of the copies, too
    for (const Solver::Step& step : steps) solver->record_step(recorder, step);
    recorder.barrier(Use::compute, options.readers ? compute::Users(Use::transfer, *options.readers)   // the report's copies
                                                   : Use::compute | Use::vertex | Use::transfer);
  }
  const auto report = [&](const Buffer& row, std::size_t to, Part part) {
    if (!solver->has(row)) return;
    const VkBufferCopy region{0, 0, solver->used_bytes(row)};
    device->vk().vkCmdCopyBuffer(commands, solver->buffer(row).handle, readback_of(to, part).handle, 1, &region);
  };
  report(buffers::counters, place, kCounters);
  report(buffers::detection, place, kDetection);
  report(buffers::reactions, place, kReactions);
  if (tears.looks) record_look(recorder);
  const std::size_t event = recorded.next;
  const bool tells = place == place_of_recorded() && recorded.done[event].get() != VK_NULL_HANDLE && !recorded.is_under_way[event];
  if (tells) {
    report(buffers::counters, place_of_event(event), kCounters);
    report(buffers::reactions, place_of_event(event), kReactions);
  }
  recorder.barrier(Use::transfer, Use::host | Use::transfer);
  if (tears.looks && place == place_of_recorded()) recorder.tell_host(tears.is_seen.get());
  if (!tells) return;
  recorder.tell_host(recorded.done[event].get());
  recorded.is_under_way[event] = true;
  recorded.number[event] = ++recorded.recorded;
  recorded.next = (event + 1) % recorded.done.size();
}

Result<void> Simulation::State::submit_frame(const FrameInput& input, std::span<const VkSemaphoreSubmitInfo> waits, bool save) {
  const std::uint64_t value = queue.submitted + 1;
  FrameSlot& slot = queue.slots[slot_of(value)];   // its last frame is done
  compute::Timestamps* timestamps = options.timings && !timed_on_cpu() ? &slot.timestamps : nullptr;
  const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                       nullptr};
  if (const VkResult began = device->vk().vkBeginCommandBuffer(slot.commands, &begin); began != VK_SUCCESS)
    return fail("a frame's command buffer could not be begun: ", compute::result_name(began));
  const std::uint32_t parity = solver->parity(), phase = solver->phase();
  const auto give_up = [&](Error why) {   // the next frame begins as if this one had not been recorded
    solver->set_parity(parity);
    solver->set_phase(phase);
    return why;
  };
  try {
    if (timestamps != nullptr) timestamps->rewind(slot.commands);
    record_frame(slot.commands, input, timestamps, save, slot_of(value));
  } catch (...) {
    (void)device->vk().vkEndCommandBuffer(slot.commands);   // one that is being recorded cannot be begun again
    return give_up(caught("the frame"));
  }
  if (const VkResult ended = device->vk().vkEndCommandBuffer(slot.commands); ended != VK_SUCCESS)
    return give_up(fail("a frame's command buffer could not be ended: ", compute::result_name(ended)));
  const VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, slot.commands, 0};
  // A host that says who reads has its other commands on the queue hold up nothing. Timestamps wait for all of them.
  const VkPipelineStageFlags2 stages = options.readers && timestamps == nullptr
                                           ? VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT
                                           : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  const VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, queue.ready.get(), value, stages, 0};
  const auto wait_count = static_cast<std::uint32_t>(waits.size());
  const VkSubmitInfo2 work{VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, wait_count, waits.data(), 1, &commands, queue.ready ? 1u : 0u, &signal};
  const VkFence fence = slot.done.get();
  if (fence != VK_NULL_HANDLE)
    if (const VkResult reset = device->vk().vkResetFences(device->handle(), 1, &fence); reset != VK_SUCCESS)
      return give_up(fail("a frame's fence could not be reset: ", compute::result_name(reset)));
  if (auto done = device->submit(work, fence); !done) return give_up(done.take_error());
  rollback.frame_is_torn = false;
  // Only what was really submitted may be waited for.
  slot.value = queue.submitted = value;
  growth_is_recorded();
  queue.last_timed = timestamps != nullptr ? &slot : nullptr;
  return {};
}

// For devices without timestamps: every dispatch is submitted alone and timed on the CPU, waking and waiting included.
Result<void> Simulation::State::run_pass_by_pass(const FrameInput& input, bool save) try {
  queue.cpu_times.clear();
  if (save)
    if (auto done = compute::run_once(*device, "weft saved frame", [&](VkCommandBuffer commands) { copy_saved(commands, false); }); !done)
      return done;
  rollback.frame_is_torn = save;
  const auto start = Stopwatch::now();
  const auto steps = solver->frame(input);
  const auto run = [&](const Solver::Step* step) {
    return compute::run_once(*device, "weft pass", [&](VkCommandBuffer commands) {
      compute::Recorder recorder(*device, commands);
      if (step == nullptr) solver->record_input(recorder, input);
      else solver->record_step(recorder, *step);
      recorder.finish();
    });
  };
  if (!steps.empty())
    if (auto done = run(nullptr); !done) return done;
  for (const Solver::Step& step : steps) {
    const auto begun = Stopwatch::now();
    if (auto done = run(&step); !done) return done;
    queue.cpu_times.push_back({solver->plan().passes[step.pass].label, milliseconds(start, begun), milliseconds(start, Stopwatch::now())});
  }
  rollback.frame_is_torn = false;
  return {};
} catch (...) {
  return caught("the frame");
}

Result<Advance> Simulation::advance(double seconds) try {
  State& s = *state_;
  FrameInput input;
  auto advance = s.plan_frame(seconds, input);
  if (!advance) return advance;
  if (auto done = s.wait(); !done) return done.take_error();
  if (auto done = s.run_to_the_end(input); !done) return done.take_error();
  advance->pairs_lost = s.lost_since_told();
  s.frame_is_sent(*advance, s.queue.submitted);
  return advance;
} catch (...) {
  return caught("the frame");
}

Result<Advance> Simulation::submit(double seconds, std::span<const VkSemaphoreSubmitInfo> waits) try {
  FrameInput input;
  auto advance = state_->plan_frame(seconds, input);
  if (!advance) return advance;
  input.few_contacts &= !state_->contacts_may_leap();
  if (auto done = state_->wait_for_slot(); !done) return done.take_error();
  advance->pairs_lost = state_->lost_since_told();
  state_->make_room();
  if (auto done = state_->submit_frame(input, waits, false); !done) return done.take_error();
  state_->frame_is_sent(*advance, state_->queue.submitted);
  return advance;
} catch (...) {
  return caught("the frame");
}

Result<Advance> Simulation::record(VkCommandBuffer commands, double seconds) try {
  if (commands == VK_NULL_HANDLE) return fail("record: the command buffer is VK_NULL_HANDLE");
  FrameInput input;
  auto advance = state_->plan_frame(seconds, input);
  if (!advance) return advance;
  input.few_contacts &= !state_->contacts_may_leap();
  state_->hear_recorded();
  advance->pairs_lost = state_->lost_since_told();
  state_->make_room();
  state_->record_frame(commands, input, nullptr, false, state_->place_of_recorded());
  state_->has_recorded = true;
  state_->growth_is_recorded();
  state_->rollback.frame_is_torn = false;
  state_->frame_is_sent(*advance, 0);
  return advance;
} catch (...) {
  return caught("the frame");
}

// The GPU has what it was to be told, or gets it before anything else. `frame`: its number among those that Weft submits, or 0.
void Simulation::State::frame_is_sent(const Advance& advance, std::uint64_t frame) {
  if (advance.substeps == 0) return;
  if (std::exchange(tears.looks, false)) tears.has_looked = true, tears.look = frame;
  kinematic.are_dirty = holds.are_new = false;
  for (std::size_t m = 0; m < skins.sources.size(); ++m) skins.are_kept[m] = (skins.sources[m] & (WEFT_TO_HOST | WEFT_TO_KEPT)) != 0;
  holds.edits.clear();
}

bool Simulation::State::timed_on_cpu() const {
  return options.timings && (options.timings_on_cpu || !queue.slots[0].timestamps.supported());
}

bool Simulation::timed_on_cpu() const { return state_->timed_on_cpu(); }

std::vector<DispatchTime> Simulation::dispatch_times() const try {
  if (timed_on_cpu()) return state_->queue.cpu_times;
  if (state_->queue.last_timed == nullptr) return {};
  auto times = state_->queue.last_timed->timestamps.read();
  if (!times) return {};
  std::vector<DispatchTime> dispatches;
  for (const compute::PassTime& time : *times)
    dispatches.push_back({state_->queue.last_timed->timestamps.names()[time.name], time.begin_ms, time.end_ms});
  return dispatches;
} catch (const std::bad_alloc&) {
  return {};
}

std::vector<PassTiming> Simulation::timings() const try {
  std::vector<PassTiming> timings;
  for (const DispatchTime& time : dispatch_times()) {
    auto at = std::find_if(timings.begin(), timings.end(), [&](const PassTiming& t) { return t.name == time.name; });
    if (at == timings.end()) at = timings.insert(at, {time.name, 0, 0, time.begin_ms});
    ++at->dispatches;
    at->milliseconds += time.end_ms - time.begin_ms;
  }
  return timings;
} catch (const std::bad_alloc&) {
  return {};
}

double Simulation::gpu_milliseconds() const {
  const auto times = dispatch_times();
  return times.empty() ? 0 : times.back().end_ms - times.front().begin_ms;
}

}  // namespace weft
