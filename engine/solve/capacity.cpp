// Contact capacity and rollback.
//
// Room is made before it is needed: when a frame that is done has used more than a third of the capacity, the next one gets four times
// what was used (sheets that pile up have three times the pairs two frames later). Frames under way keep the buffers they were recorded
// with, and the next one begins with copying what was found so far, so nothing waits, and nothing changes but the room.
//
// Pairs may grow faster than that. advance() waits for its frame, so it sees an overflow and can roll the frame back: what a frame changes
// and the next one needs is copied at the frame's start and restored before the frame is repeated. The repeated frame does exactly what it
// would have done with the larger capacity from the first. submit() does not wait for its frames, and frames of record() are not Weft's to
// repeat: they hold the particles of a candidate that overflowed still, so that nothing crosses, and count it. What submit() knows is what
// the frame before the last has told, whether or not the last one is done: that must not depend on how fast the device is. record() knows
// what those frames have told that are done by then.
#include <algorithm>
#include <utility>
#include <cstring>

#include "compute/functions.h"
#include "engine/solve/state.h"

namespace weft {

// Made anew when the buffers have outgrown it: less than all of a frame's state must never be restored.
Result<void> Simulation::State::create_saved() {
  bool fits = rollback.saved.size() > 0;
  for (std::size_t k = 0; k < rollback.saved.size(); ++k) fits &= rollback.saved[k].bytes >= solver->buffer(*rollback.rows[k]).bytes;
  if (fits) return {};
  std::vector<compute::BufferRequest> requests;
  for (const Buffer* row : rollback.rows)
    requests.push_back({"saved " + solver->buffer(*row).name, solver->buffer(*row).bytes,
                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  auto arena = compute::Arena::create(*device, compute::Memory::device, "weft saved frame", requests);
  if (!arena) return arena.take_error();
  rollback.saved = std::move(*arena);
  return {};
}

// Copies between the solver's buffers and `saved`; barriers are the caller's. A torn frame may have stopped between any two
// passes, so with `back` the buffers that are cleared between frames are cleared, too.
void Simulation::State::copy_saved(VkCommandBuffer commands, bool back) const {
  for (std::size_t k = 0; k < rollback.rows.size(); ++k) {
    const compute::Buffer& live = solver->buffer(*rollback.rows[k]);
    // Of the candidates only those that were found.
    const VkDeviceSize bytes = rollback.rows[k] == &buffers::candidates
                                   ? std::max<VkDeviceSize>(1, rollback.candidates) * sizeof(gpu::uvec4)
                                   : rollback.saved[k].bytes;
    const VkBufferCopy region{0, 0, std::min(bytes, live.bytes)};
    device->vk().vkCmdCopyBuffer(commands, back ? rollback.saved[k].handle : live.handle, back ? live.handle : rollback.saved[k].handle, 1,
                                 &region);
  }
  if (!back) return;
  for (const Plan::PlannedBuffer& planned : solver->plan().buffers)
    if (planned.row->lifetime == Lifetime::cleared)
      device->vk().vkCmdFillBuffer(commands, solver->buffer(*planned.row).handle, 0, VK_WHOLE_SIZE, planned.row->word);
}

// Rolls a torn frame back. If that fails, the next frame begins with it.
Result<void> Simulation::State::put_frame_back() {
  if (!rollback.frame_is_torn) return {};
  if (auto done = compute::run_once(*device, "weft put back", [&](VkCommandBuffer commands) { copy_saved(commands, true); }); !done)
    return done;
  rollback.frame_is_torn = false;
  return {};
}

// True if it has grown.
Result<bool> Simulation::State::grow_capacity(std::uint64_t wanted) {
  const std::uint64_t present = solver->contact_settings().capacity;
  wanted = std::min<std::uint64_t>(wanted, kMostCandidates);
  if (wanted <= present || capacity.is_final) return false;
  capacity.outgrown.reserve(capacity.outgrown.size() + 1);
  // Bisection: where the device has no memory for all of them, half of the increase is tried, down to 1/256 of the capacity.
  for (std::string refused;;) {
    auto grown = solver->grow(static_cast<std::uint32_t>(wanted));
    if (!grown && refused.empty()) refused = std::to_string(wanted) + " candidates: " + grown.error();
    const std::uint64_t less = present + (wanted - present) / 2;
    capacity.is_final = !grown && less - present <= present / 256;
    if (grown) capacity.outgrown.push_back({std::move(*grown)});
    if (grown || capacity.is_final) {
      if (!refused.empty())
        fabric.notes.push_back("contacts: the capacity is " + std::to_string(solver->contact_settings().capacity) +
                               " candidates; the device has no memory for " + refused);
      return bool(grown);
    }
    wanted = less;
  }
}

// Detection as it has to be before the next frame where candidates, or the pose that they are of, are no longer.
Result<gpu::Detection> Simulation::State::detection_anew() const {
  gpu::Detection detection{};
  const auto bytes = std::as_writable_bytes(std::span(&detection, 1));
  if (auto done = compute::read_back(*device, solver->buffer(buffers::detection), bytes); !done) return done.take_error();
  detection.needs_detection = detection.may_cross = 1;   // who writes positions may have put cloth through cloth
  detection.lifetime = 0;                                // what trajectories were expected is no measure of them
  return detection;
}

Result<Simulation::State::Tracks> Simulation::State::tracks() {
  Tracks tracks;
  if (!solver->has(buffers::detection)) return tracks;
  auto at = read(buffers::detected_positions, fabric.positions.size()), trajectories = read(buffers::trajectories, fabric.positions.size());
  if (!at) return at.take_error();
  if (!trajectories) return trajectories.take_error();
  gpu::Detection detection{};
  if (auto done = compute::read_back(*device, solver->buffer(buffers::detection), std::as_writable_bytes(std::span(&detection, 1))); !done)
    return done.take_error();
  return Tracks{std::move(*at), std::move(*trajectories), detection.lifetime};
}

Result<void> Simulation::State::put(const Tracks& tracks) {
  if (tracks.at.empty()) return {};
  const compute::Buffer& detection = solver->buffer(buffers::detection);
  gpu::Detection changed{};
  if (auto done = compute::read_back(*device, detection, std::as_writable_bytes(std::span(&changed, 1))); !done) return done;
  changed.lifetime = tracks.lifetime;
  return compute::upload_all(*device, std::vector<compute::Upload>{
                                          {&solver->buffer(buffers::detected_positions), std::as_bytes(std::span(tracks.at))},
                                          {&solver->buffer(buffers::trajectories), std::as_bytes(std::span(tracks.trajectories))},
                                          {&detection, std::as_bytes(std::span(&changed, 1))}});
}

// Before a frame that will not be repeated. Where there is no memory for more a note says so, and what does not fit is counted.
void Simulation::State::make_room() {
  if (!solver->has(buffers::candidates)) return;
  const std::uint64_t present = solver->contact_settings().capacity, room = capacity.room;
  if (3 * room > present) (void)grow_capacity(std::max(2 * present, 4 * room));
}

// The candidates found so far, into the buffers that took the place of theirs.
void Simulation::State::record_growth(compute::Recorder& recorder) const {
  using compute::Use;
  for (std::size_t k = 0; k < capacity.outgrown.size(); ++k) {
    const ContactCapacity::Outgrown& outgrown = capacity.outgrown[k];
    if (outgrown.is_copied) continue;
    const bool last = k + 1 == capacity.outgrown.size();
    const VkBuffer to = last ? solver->buffer(buffers::candidates).handle : capacity.outgrown[k + 1].buffers.candidates;
    const VkBufferCopy region{0, 0, outgrown.buffers.bytes};
    device->vk().vkCmdCopyBuffer(recorder.commands(), outgrown.buffers.candidates, to, 1, &region);
    recorder.barrier(Use::transfer, Use::compute | Use::transfer | Use::indirect);
  }
}

void Simulation::State::growth_is_recorded() {
  for (ContactCapacity::Outgrown& outgrown : capacity.outgrown)
    if (!outgrown.is_copied) outgrown.is_copied = true, outgrown.until = queue.submitted;
}

// At once, for those who read the solver's buffers outside a frame. Nothing is under way.
Result<void> Simulation::State::copy_outgrown() {
  if (capacity.outgrown.empty()) return {};
  if (auto done = compute::run_once(*device, "weft growth",
                                    [&](VkCommandBuffer commands) {
                                      compute::Recorder recorder(*device, commands);
                                      record_growth(recorder);
                                      recorder.finish();
                                    });
      !done)
    return done;
  capacity.outgrown.clear();
  return {};
}

// Frame `frame` is done, and so are those that the host has recorded.
void Simulation::State::let_go_of_outgrown(std::uint64_t frame) {
  std::erase_if(capacity.outgrown, [&](const ContactCapacity::Outgrown& o) { return o.is_copied && (has_recorded || o.until <= frame); });
}

void Simulation::State::learn(const gpu::Counters& counters) {
  capacity.room = std::max(capacity.room, counters.contacts_room);
  capacity.lost = std::max(capacity.lost, counters.contacts_overflowed);
  capacity.load = counters.contacts_load;
}

// One workgroup takes longer for a detection than the passes that have a thread each (detect_alone), and saves dispatches in every substep
// without one. (H200, with none, one and two a frame: drop of 100 x 100 3.2, 3.3, 3.6 ms, curtain 2.4, 2.3, 2.6.)
void Simulation::State::count_calm(const gpu::Counters& counters) {
  constexpr std::uint32_t kSeldom = 1;   // in a frame
  const std::uint32_t detections = counters.detections - std::exchange(capacity.detections, counters.detections);
  capacity.calm = detections <= kSeldom ? capacity.calm + 1 : 0;
  capacity.still = detections == 0 ? capacity.still + 1 : 0;
}

// A dispatch costs a GPU as much as a workgroup needs for thousands of contacts, and the software driver the waking of its threads: two
// dozen a substep more than one thread needs for a thousand active contacts and as many candidates as here. (Of 1000, 16,000 and 32,000:
// the drop of 50 x 50 takes 39, 24, 25 ms, walk 58, 50, 48; with four rounds of slides for two, of 16,000 and 32,000, 37 and 33. On an
// H200, of 8000, 16,000, 32,000, 64,000 and 128,000: 3.8, 3.5, 3.2, 3.2, 3.2 ms, the drop of 100 x 100 4.7, 4.4, 3.9, 4.0, 4.0, walk 4.3,
// 4.0, 3.9, 3.8, 3.9.) One workgroup can do several times as many, should they grow before the host knows.
bool Simulation::State::contacts_are_few() const { return capacity.load <= (device->is_software() ? 32'000u : 64'000u); }

// Whether there may be more than one workgroup can do (contact_alone) before the host hears of them: for frames that are not repeated. Two
// sheets of 70 x 70 that fall flat onto each other have 300,000 candidates, and none in the frame before.
bool Simulation::State::contacts_may_leap() const {
  constexpr std::size_t kSmall = 2048;   // particles
  return device->is_software() && fabric.positions.size() > kSmall;
}

bool Simulation::State::detections_are_seldom() const { return capacity.calm >= 4 && solver->can_detect_alone(); }

// Whether no detection is to be expected of the next frame. All frames before it are done, and what is kinematic does not move. A frame
// that has to be repeated for it costs as much as is saved in some ten, so there must have been none for longer.
bool Simulation::State::is_still() const {
  constexpr std::uint32_t kFrames = 16;
  const gpu::Detection& now = heard.detection;
  const bool may_settle = now.settled == 0 && now.candidates > solver->contact_settings().particles;   // detect_arguments
  return capacity.still >= kFrames && now.needs_detection == 0 && !may_settle;
}

// Of the frames of `record` those that are done by now.
void Simulation::State::hear_recorded() {
  for (std::size_t k = 0; k < recorded.done.size(); ++k) {
    const VkEvent event = recorded.done[k].get();
    if (!recorded.is_under_way[k] || device->heard(device->vk().vkGetEventStatus(device->handle(), event)) != VK_EVENT_SET) continue;
    if (device->heard(device->vk().vkResetEvent(device->handle(), event)) != VK_SUCCESS) continue;
    recorded.is_under_way[k] = false;
    learn(reported(place_of_event(k)).counters);
    if (recorded.number[k] < recorded.heard) continue;
    recorded.heard = recorded.number[k];
    count_calm(reported(place_of_event(k)).counters);
    read_reactions(place_of_event(k), reactions.known);
  }
}

// Runs the planned frame, and repeats it with a larger capacity while candidates overflow.
Result<void> Simulation::State::run_to_the_end(FrameInput input) {
  const bool contacts = solver->has(buffers::candidates) && input.substeps > 0;
  const Report before = heard;
  const bool rested = kinematic.rest;
  const std::vector<gpu::Reaction> given_before = reactions.heard;
  const std::uint32_t overflowed = before.counters.contacts_overflowed, parity = solver->parity(), phase = solver->phase();
  const bool saves = contacts || (timed_on_cpu() && input.substeps > 0);
  if (auto done = put_frame_back(); !done) return done;
  input.is_still = contacts && input.kinematics_rest && is_still();
  // Where trajectories and slack have ended nothing counts substeps any more, either.
  input.has_no_candidates =
      heard.detection.candidates == 0 && heard.detection.steps == WEFT_LONGEST_LIFETIME && heard.detection.slack == 0;
  rollback.candidates = contacts ? std::min(heard.detection.candidates, solver->contact_settings().capacity) : 0;
  for (;;) {
    if (saves)
      if (auto done = create_saved(); !done) return done;
    if (timed_on_cpu()) {
      if (auto done = run_pass_by_pass(input, saves); !done) {
        solver->set_parity(parity);
        solver->set_phase(phase);
        (void)put_frame_back();
        return done;
      }
      if (auto done = submit_frame({}, {}, false); !done) return done;   // what is left of the frame: the counters
    } else {
      if (auto done = submit_frame(input, {}, contacts); !done) return done;
    }
    if (auto done = wait(); !done) return done;
    const bool overflows = contacts && heard.counters.contacts_overflowed != overflowed;
    const bool was_still = std::exchange(input.is_still, false);
    const bool misses = was_still && (heard.detection.needs_detection != 0 || heard.counters.detections != before.counters.detections);
    if (!overflows && !misses) return {};
    // One workgroup may have found more contacts than it can do.
    const bool was_alone = overflows && std::exchange(input.few_contacts, false);
    // What the torn frame has found says little: it depends on which pairs overflowed, and those on the order of threads.
    if (!misses && (!was_alone || heard.counters.contacts_room > solver->contact_settings().capacity)) {
      auto grown = grow_capacity(2 * std::uint64_t{solver->contact_settings().capacity});
      if (!grown) return grown.take_error();
      if (!*grown) return {};   // no larger capacity to be had: the frame is safe, and the overflow is counted
    }
    if (auto done = compute::run_once(*device, "weft repeat", [&](VkCommandBuffer commands) { copy_saved(commands, true); }); !done)
      return done;
    capacity.outgrown.clear();   // nothing is under way, and what was found came back
    solver->set_parity(parity);
    solver->set_phase(phase);
    // The counters are rolled back, too: should the repeated frame fail, it counts nothing.
    heard = before;
    kinematic.rest = rested;
    capacity.detections = before.counters.detections;
    capacity.still = 0;
    reactions.heard = reactions.known = given_before;
    capacity.lost = before.counters.contacts_overflowed;
  }
}

Result<void> Simulation::reserve_contacts(std::uint32_t pairs) try {
  State& s = *state_;
  if (pairs > kMostCandidates) return fail("reserve_contacts: ", pairs, " candidate pairs are more than ", kMostCandidates);
  if (!s.solver->has(buffers::candidates) || pairs <= s.solver->contact_settings().capacity) return {};
  s.capacity.outgrown.reserve(s.capacity.outgrown.size() + 1);
  auto grown = s.solver->grow(pairs);
  if (!grown) return grown.take_error();
  s.capacity.outgrown.push_back({std::move(*grown)});
  return {};
} catch (...) {
  return caught("reserve_contacts");
}

}  // namespace weft
