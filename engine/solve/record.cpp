// What a frame's commands are: what the host tells the GPU, and the dispatches.
#include <algorithm>

#include "engine/effects/anchor/anchor.h"
#include "engine/effects/collide/collide.h"
#include "engine/effects/contact/contact.h"
#include "engine/effects/grab/grab.h"
#include "engine/effects/inertia/inertia.h"
#include "engine/effects/motion/motion.h"
#include "engine/effects/motion_constraint/motion_constraint.h"
#include "engine/effects/pressure/pressure.h"
#include "engine/effects/skin/skin.h"
#include "engine/solve/solver.h"

namespace weft {

// The data travels in the command buffer, so frames under way never share it.
void Solver::record_bytes(compute::Recorder& recorder, const compute::Buffer& to, std::span<const std::byte> bytes, std::uint64_t first) const {
  constexpr std::size_t kLongest = 65536;   // vkCmdUpdateBuffer
  for (std::size_t at = 0; at < bytes.size(); at += kLongest)
    device_->vk().vkCmdUpdateBuffer(recorder.commands(), to.handle, first + at, std::min(kLongest, bytes.size() - at), bytes.data() + at);
}

void Solver::record_edits(compute::Recorder& recorder, std::span<const Edit> edits) const {
  if (edits.empty()) return;
  // Of two edits of a place the later one counts; and a frame's start may just have been copied. Edits that go on behind those of their
  // buffer need not wait for each other.
  struct Touched {
    const Buffer* row;
    std::uint64_t first, end;
  };
  std::vector<Touched> touched;
  const auto wait = [&] {
    recorder.barrier(compute::Use::transfer, compute::Use::transfer);
    touched.clear();
  };
  wait();
  for (const Edit& edit : edits) {
    const compute::Buffer& to = buffer(*edit.row);
    const bool copies = edit.copied > 0;
    auto own = std::ranges::find(touched, edit.row, &Touched::row);
    if (own != touched.end() && (edit.at < own->end || (copies && edit.from < own->end && edit.from + edit.copied > own->first))) {
      wait();
      own = touched.end();
    }
    if (own == touched.end()) own = touched.insert(own, {edit.row, edit.at, edit.at});
    own->end = std::max({own->end, edit.at + edit.bytes.size(), copies ? std::max(edit.at, edit.from) + edit.copied : 0});
    if (copies) own->first = std::min(own->first, edit.from);
    record_bytes(recorder, to, edit.bytes, edit.at);
    const VkBufferCopy region{edit.from, edit.at, edit.copied};
    if (copies) device_->vk().vkCmdCopyBuffer(recorder.commands(), to.handle, to.handle, 1, &region);
  }
}

void Solver::record_input(compute::Recorder& recorder, const FrameInput& input) {
  const auto copy = [&](const compute::Buffer& to, std::span<const std::byte> bytes) { record_bytes(recorder, to, bytes); };
  record_edits(recorder, input.edits);
  motion_.gravity = {input.gravity.x, input.gravity.y, input.gravity.z};
  motion_.level_kept = input.is_driven ? WEFT_LEVEL_KEPT : 0;
  set_uniforms("motion", motion_);
  if (input.air) set_uniforms("air", input.air->air);
  if (!uniforms_.empty()) copy(arena_[arena_.size() - 1], uniforms_);
  if (input.anchors_move && has(buffers::anchors)) copy(buffer(buffers::anchors), std::as_bytes(input.anchors));
  if (input.air && has(buffers::air_waves)) copy(buffer(buffers::air_waves), std::as_bytes(std::span(input.air->waves)));
  if (input.air && has(buffers::air_fields)) copy(buffer(buffers::air_fields), std::as_bytes(std::span(input.air->fields)));
  if (has(buffers::grabs)) copy(buffer(buffers::grabs), std::as_bytes(input.grabs));
  if (has(buffers::colliders)) copy(buffer(buffers::colliders), std::as_bytes(input.colliders));
  if (has(buffers::body_sizes)) copy(buffer(buffers::body_sizes), std::as_bytes(input.body_sizes));
  if (has(buffers::skin_joints)) copy(buffer(buffers::skin_joints), std::as_bytes(input.joints));
  if (has(buffers::morph_weights)) copy(buffer(buffers::morph_weights), std::as_bytes(input.morph_weights));
  if (has(buffers::skin_sources)) copy(buffer(buffers::skin_sources), std::as_bytes(input.skin_sources));
  for (const HostCopy& from : input.host_copies) {
    const VkBufferCopy region{from.from, from.to, from.bytes};
    if (has(*from.row)) device_->vk().vkCmdCopyBuffer(recorder.commands(), from.buffer, buffer(*from.row).handle, 1, &region);
  }
  if (has(buffers::frame_changes)) copy(buffer(buffers::frame_changes), std::as_bytes(input.frame_changes));
  if (has(buffers::motion_limits)) copy(buffer(buffers::motion_limits), std::as_bytes(input.motion_limits));
  if (has(buffers::gas_amounts)) copy(buffer(buffers::gas_amounts), std::as_bytes(input.gas_amounts));
  recorder.barrier(compute::Use::transfer, compute::Use::compute);
}

void Solver::record_step(compute::Recorder& recorder, const Step& step) const {
  const PlannedPass& planned = plan_.passes[step.pass];
  const Run& run = runs_[step.pass];
  recorder.begin_pass(planned.label.c_str(), run.touches[step.parity]);
  const VkDescriptorSet sets[] = {sets_[step.pass].sets[step.parity][0].handle(), sets_[step.pass].sets[step.parity][1].handle()};
  recorder.bind(run.compiled->pipeline.handle(), run.compiled->layout.get(), sets);
  recorder.push(run.compiled->layout.get(), std::as_bytes(std::span(&step.push, 1)));
  const Arguments& arguments = planned.pass->threads.arguments;
  if (arguments.buffer != nullptr) recorder.dispatch_indirect(buffer(*arguments.buffer).handle, arguments.offset);
  else if (planned.pass->a_workgroup_each) recorder.dispatch(step.push.count);
  else recorder.dispatch(run.groups > 0 ? run.groups : (step.push.count + workgroup_ - 1) / workgroup_);
}

}  // namespace weft
