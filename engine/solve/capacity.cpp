// Room for contacts, and frames that are taken back: a frame that found more candidates than there is room for is run again with more room.
//
// advance() waits for its frame, so it can tell that candidates were lost and take the frame back: what a frame changes and
// the next one needs is copied at its start, and put back before it is repeated. With the room it lacked it then does exactly what it
// would have done with that room from the first. Frames of submit() are not waited for and frames of record() are not Weft's to
// repeat: they hold the particles of a lost candidate still, so that nothing crosses, and are counted; submit() at least makes room
// for the frames that follow.
#include <algorithm>
#include <cstring>

#include "compute/functions.h"
#include "engine/solve/state.h"

namespace weft {

// Made again when there is more to keep than it holds: less than all of it must never be put back.
Result<void> Simulation::State::create_saved() {
  bool fits = rollback.saved.size() > 0;
  for (std::size_t k = 0; k < rollback.saved.size(); ++k) fits &= rollback.saved[k].bytes >= solver->buffer(*rollback.rows[k]).bytes;
  if (fits) return {};
  std::vector<compute::BufferRequest> requests;
  for (const Buffer* row : rollback.rows)
    requests.push_back({"kept " + solver->buffer(*row).name, solver->buffer(*row).bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  auto arena = compute::Arena::create(*device, compute::Memory::device, "weft kept frame", requests);
  if (!arena) return arena.take_error();
  rollback.saved = std::move(*arena);
  return {};
}

// Between the solver's buffers and what is kept of them; barriers are the caller's. A frame that is put back may have stopped between any two passes.
void Simulation::State::copy_saved(VkCommandBuffer commands, bool back) const {
  for (std::size_t k = 0; k < rollback.rows.size(); ++k) {
    const compute::Buffer& live = solver->buffer(*rollback.rows[k]);
    // Of the candidates only those that there are.
    const VkDeviceSize bytes = rollback.rows[k] == &buffers::candidates ? std::max<VkDeviceSize>(1, rollback.candidates) * sizeof(gpu::uvec4) : rollback.saved[k].bytes;
    const VkBufferCopy region{0, 0, std::min(bytes, live.bytes)};
    device->vk().vkCmdCopyBuffer(commands, back ? rollback.saved[k].handle : live.handle, back ? live.handle : rollback.saved[k].handle, 1, &region);
  }
  if (!back) return;
  for (const Plan::PlannedBuffer& planned : solver->plan().buffers)
    if (planned.row->lifetime == Lifetime::cleared)
      device->vk().vkCmdFillBuffer(commands, solver->buffer(*planned.row).handle, 0, VK_WHOLE_SIZE, planned.row->word);
}

const gpu::Counters& Simulation::State::counters() const { return *reinterpret_cast<const gpu::Counters*>(readback[0].mapped); }

// Of a frame that stopped in its middle; if this cannot be done now, the next frame begins with it.
Result<void> Simulation::State::put_frame_back() {
  if (!rollback.frame_is_torn) return {};
  if (auto done = compute::run_once(*device, "weft put back", [&](VkCommandBuffer commands) { copy_saved(commands, true); }); !done) return done;
  rollback.frame_is_torn = false;
  return {};
}

Result<bool> Simulation::State::grow_capacity() {
  const std::uint64_t room = solver->contact_settings().capacity;
  // Half as much again as was found: the frame would have found more if it had not been held up.
  std::uint64_t wanted = std::min<std::uint64_t>(std::max<std::uint64_t>(2 * room, counters().contacts_most + counters().contacts_most / 2), kMostCandidates);
  if (wanted <= room || capacity.is_final) return false;
  // First: what was found so far is gone as soon as there is more room, and nobody may take what is there instead for pairs.
  if (auto done = detect_anew(); !done) return done.take_error();
  // What a device has no buffer or memory for it may have for some of these: half as many more at a time, to within a part in 256.
  for (std::string refused;;) {
    auto grown = solver->grow(static_cast<std::uint32_t>(wanted));
    if (!grown && refused.empty()) refused = std::to_string(wanted) + " candidates: " + grown.error();
    const std::uint64_t less = room + (wanted - room) / 2;
    capacity.is_final = !grown && less - room <= room / 256;
    if (grown || capacity.is_final) {
      if (!refused.empty()) fabric.notes.push_back("contacts: room for " + std::to_string(solver->contact_settings().capacity) + " candidates, and none for " + refused);
      return bool(grown);
    }
    wanted = less;
  }
}

Result<void> Simulation::State::detect_anew() {
  gpu::Detection detection{};
  const auto bytes = std::as_writable_bytes(std::span(&detection, 1));
  if (auto done = compute::read_back(*device, solver->buffer(buffers::detection), bytes); !done) return done;
  detection.needs_detection = 1;
  return compute::upload(*device, solver->buffer(buffers::detection), bytes);
}

// For frames that follow one whose losses have been read back.
Result<void> Simulation::State::grow_later() {
  if (!solver->has(buffers::candidates) || counters().contacts_overflowed == capacity.overflow_seen) return {};
  if (auto done = wait(); !done) return done;
  capacity.overflow_seen = counters().contacts_overflowed;
  auto room = grow_capacity();
  return room ? Result<void>() : room.take_error();
}

// Runs what was planned, again with more room while candidates are lost for want of it.
Result<void> Simulation::State::run_to_the_end(const FrameInput& input) {
  const bool contacts = solver->has(buffers::candidates) && input.substeps > 0;
  const gpu::Counters before = counters();
  const gpu::Detection found = detection();
  const std::uint32_t lost = before.contacts_overflowed, parity = solver->parity(), turn = solver->phase();
  const bool keeps = contacts || (timed_on_cpu() && input.substeps > 0);
  if (auto done = put_frame_back(); !done) return done;
  rollback.candidates = contacts ? std::min(detection().candidates, solver->contact_settings().capacity) : 0;
  for (;;) {
    if (keeps)
      if (auto done = create_saved(); !done) return done;
    if (timed_on_cpu()) {
      if (auto done = run_pass_by_pass(input, keeps); !done) {
        solver->set_parity(parity);
        solver->set_phase(turn);
        (void)put_frame_back();
        return done;
      }
      if (auto done = submit_frame({}, {}, false); !done) return done;   // what is left of the frame: the counters
    } else {
      if (auto done = submit_frame(input, {}, contacts); !done) return done;
    }
    if (auto done = wait(); !done) return done;
    if (!contacts || counters().contacts_overflowed == lost) return {};
    auto room = grow_capacity();
    if (!room) return room.take_error();
    if (!*room) return {};   // as far as it goes: safe, and counted
    if (auto done = compute::run_once(*device, "weft repeat", [&](VkCommandBuffer commands) { copy_saved(commands, true); }); !done) return done;
    solver->set_parity(parity);
    solver->set_phase(turn);
    // What the frame had counted is taken back with it: it may not get as far as counting again.
    std::memcpy(readback[0].mapped, &before, sizeof before);
    std::memcpy(readback[1].mapped, &found, sizeof found);
  }
}

}  // namespace weft
