// Contact capacity and rollback: a frame in which candidates overflowed is repeated with a larger capacity.
//
// advance() waits for its frame, so it sees an overflow and can roll the frame back: what a frame changes and the next one needs
// is copied at the frame's start and restored before the frame is repeated. The repeated frame does exactly what it would have
// done with the larger capacity from the first. submit() does not wait for its frames, and frames of record() are not Weft's to
// repeat: they hold the particles of a candidate that overflowed still, so that nothing crosses, and count it; submit() enlarges
// the capacity when the frame before the last has told of an overflow, whether or not the last one is done: when that is must not depend
// on how fast the device is.
#include <algorithm>
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

Result<bool> Simulation::State::grow_capacity() {
  const std::uint64_t present = solver->contact_settings().capacity;
  // Half as much again as was found: particles held still by the overflow would have found more.
  std::uint64_t wanted = std::min<std::uint64_t>(
      std::max<std::uint64_t>(2 * present, heard.counters.contacts_most + heard.counters.contacts_most / 2), kMostCandidates);
  if (wanted <= present || capacity.is_final) return false;
  // First: growing replaces the buffer of candidates, and nothing may read the new one's contents as pairs.
  if (auto done = detect_anew(); !done) return done.take_error();
  // Bisection: where the device has no memory for all of them, half of the increase is tried, down to 1/256 of the capacity.
  for (std::string refused;;) {
    auto grown = solver->grow(static_cast<std::uint32_t>(wanted));
    if (!grown && refused.empty()) refused = std::to_string(wanted) + " candidates: " + grown.error();
    const std::uint64_t less = present + (wanted - present) / 2;
    capacity.is_final = !grown && less - present <= present / 256;
    if (grown || capacity.is_final) {
      if (!refused.empty())
        fabric.notes.push_back("contacts: the capacity is " + std::to_string(solver->contact_settings().capacity) +
                               " candidates; the device has no memory for " + refused);
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

// For the frames after one whose overflow was heard of.
Result<void> Simulation::State::grow_later() {
  if (!solver->has(buffers::candidates) || heard.counters.contacts_overflowed == capacity.overflow_seen) return {};
  if (auto done = wait(); !done) return done;
  capacity.overflow_seen = heard.counters.contacts_overflowed;
  auto grown = grow_capacity();
  return grown ? Result<void>() : grown.take_error();
}

// Runs the planned frame, and repeats it with a larger capacity while candidates overflow.
Result<void> Simulation::State::run_to_the_end(const FrameInput& input) {
  const bool contacts = solver->has(buffers::candidates) && input.substeps > 0;
  const Report before = heard;
  const std::uint32_t overflowed = before.counters.contacts_overflowed, parity = solver->parity(), phase = solver->phase();
  const bool saves = contacts || (timed_on_cpu() && input.substeps > 0);
  if (auto done = put_frame_back(); !done) return done;
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
    if (!contacts || heard.counters.contacts_overflowed == overflowed) return {};
    auto grown = grow_capacity();
    if (!grown) return grown.take_error();
    if (!*grown) return {};   // no larger capacity to be had: the frame is safe, and the overflow is counted
    if (auto done = compute::run_once(*device, "weft repeat", [&](VkCommandBuffer commands) { copy_saved(commands, true); }); !done)
      return done;
    solver->set_parity(parity);
    solver->set_phase(phase);
    // The counters are rolled back, too: should the repeated frame fail, it counts nothing.
    heard = before;
  }
}

}  // namespace weft
