// Reading and writing the state from outside.
#include "engine/solve/state.h"

#include <algorithm>
#include <cstring>

#include "engine/solve/sanitize.h"

namespace weft {

// The fence of a frame that was waited for may be reset by now.
Result<void> Simulation::State::wait_for_frame(std::uint64_t frame) {
  if (frame <= queue.waited) return {};
  auto done = queue.ready ? compute::wait_for(*device, queue.ready.get(), frame)
                          : compute::wait_for(*device, queue.slots[slot_of(frame)].done.get());
  if (done) queue.waited = frame;
  return done;
}

// The last frame that is known to be done, without waiting.
std::uint64_t Simulation::State::last_done() const {
  std::uint64_t last = queue.waited;
  if (queue.ready) {
    std::uint64_t reached = 0;
    if (device->heard(device->vk().vkGetSemaphoreCounterValue(device->handle(), queue.ready.get(), &reached)) == VK_SUCCESS) last = reached;
    return last;
  }
  for (const FrameSlot& slot : queue.slots)
    if (slot.value > last && device->heard(device->vk().vkGetFenceStatus(device->handle(), slot.done.get())) == VK_SUCCESS)
      last = slot.value;
  return last;
}

Result<void> Simulation::State::wait() {
  if (auto done = wait_for_frame(queue.submitted); !done) return done;
  hear(queue.submitted);
  return copy_outgrown();   // what follows may read the solver's buffers
}

// The next frame takes the place of the last but one.
Result<void> Simulation::State::wait_for_slot() {
  const std::uint64_t frame = queue.slots[slot_of(queue.submitted + 1)].value;
  if (auto done = wait_for_frame(frame); !done) return done;
  hear(frame);
  return {};
}

// `place` is that of a frame that is done.
Report Simulation::State::reported(std::size_t place) const {
  Report report;
  std::memcpy(&report.counters, readback_of(place, kCounters).mapped, sizeof report.counters);
  std::memcpy(&report.detection, readback_of(place, kDetection).mapped, sizeof report.detection);
  return report;
}

void Simulation::State::read_reactions(std::size_t place, std::vector<gpu::Reaction>& into) const {
  if (solver->has(buffers::reactions)) std::memcpy(into.data(), readback_of(place, kReactions).mapped, solver->used_bytes(buffers::reactions));
}

// Frame `frame` and all before it are done, and so are those that the host has recorded.
void Simulation::State::hear(std::uint64_t frame) {
  let_go_of_outgrown(frame);
  if (has_recorded) {
    hear_recorded();
    heard = reported(place_of_recorded());
    count_calm(heard.counters);
    read_reactions(place_of_recorded(), reactions.heard);
    queue.heard = queue.submitted;   // recorded after them
  } else if (frame > queue.heard) {
    const std::uint32_t stirred = heard.detection.stirred;
    heard = reported(slot_of(frame));
    const gpu::Detection& now = heard.detection;
    kinematic.rest |= queue.heard >= kinematic.still_since && now.stirred == stirred && now.crossings == 0 && now.may_cross == 0;
    count_calm(heard.counters);
    read_reactions(slot_of(frame), reactions.heard);
    queue.heard = frame;
  }
  has_recorded = false;
  reactions.known = reactions.heard;
  learn(heard.counters);
}

// For those who ask while frames are under way. What Weft itself does next must not depend on which frame that is.
std::optional<std::size_t> Simulation::State::newest_place() const {
  if (has_recorded) return place_of_recorded();
  const std::uint64_t done = last_done();
  return done > queue.heard ? std::optional(slot_of(done)) : std::nullopt;
}

// As far as frames are done.
void Simulation::State::hear_reactions() {
  if (has_recorded) hear_recorded();
  else if (const auto place = newest_place()) read_reactions(*place, reactions.known);
  else reactions.known = reactions.heard;
}

std::span<const Reaction> Simulation::take_reactions() {
  State& s = *state_;
  if (!s.scene.reactions) return {};
  s.hear_reactions();
  const auto tell = [&](std::uint32_t collider, std::size_t k) {
    s.reactions.between[collider] = reaction_between(s.reactions.told[k], s.reactions.known[k], s.reactions.quantum);
    s.reactions.told[k] = s.reactions.known[k];
  };
  std::size_t k = 0;
  for (const std::uint32_t collider : s.bodies.order) tell(collider, k++);
  k += s.scene.grabs;
  for (const ColliderMesh& mesh : s.fabric.collider_meshes) tell(mesh.collider, k++);
  return s.reactions.between;
}

std::span<const Reaction> Simulation::take_pulls() {
  State& s = *state_;
  if (!s.scene.reactions) return {};
  s.hear_reactions();
  const double quantum = s.reactions.quantum;
  for (std::size_t g = 0; g < s.reactions.pulls.size(); ++g) {
    const std::size_t k = s.bodies.order.size() + g;
    s.reactions.pulls[g] = reaction_between(s.reactions.told[k], s.reactions.known[k], quantum);
    s.reactions.told[k] = s.reactions.known[k];
  }
  return s.reactions.pulls;
}

// The surface of the pose at hand, outside a frame.
Result<void> Simulation::State::draw_surface() {
  if (auto done = wait(); !done) return done;
  return compute::run_once(*device, "weft surface", [&](VkCommandBuffer commands) {
    compute::Recorder recorder(*device, commands);
    for (const Solver::Step& step : solver->surface()) solver->record_step(recorder, step);
    recorder.finish();
  });
}

Result<std::vector<gpu::vec4>> Simulation::State::read(const Buffer& row, std::size_t count) {
  if (auto done = wait(); !done) return done.take_error();
  if (auto done = put_frame_back(); !done) return done.take_error();
  std::vector<gpu::vec4> values(count);
  if (auto done = compute::read_back(*device, solver->buffer(row), std::as_writable_bytes(std::span(values))); !done)
    return done.take_error();
  return values;
}

Result<void> Simulation::State::check_count(std::span<const gpu::vec4> values) const {
  return values.size() == fabric.positions.size() ? Result<void>()
                                                  : fail(values.size(), " values were given for ", fabric.positions.size(), " particles");
}

// The counters, with `more` added to those sanitized. The device must be done: it counts, too.
Result<gpu::Counters> Simulation::State::counters_and_sanitized(std::size_t more) {
  gpu::Counters counted{};
  if (auto done = compute::read_back(*device, solver->buffer(buffers::counters), std::as_writable_bytes(std::span(&counted, 1))); !done)
    return done.take_error();
  counted.non_finite += static_cast<std::uint32_t>(more);
  return counted;
}

// Uploads all of it or, where there is no memory, nothing.
Result<void> Simulation::State::write(std::vector<compute::Upload> uploads, const gpu::Counters& counted) {
  uploads.push_back({&solver->buffer(buffers::counters), std::as_bytes(std::span(&counted, 1))});
  if (auto done = compute::upload_all(*device, uploads); !done) return done;
  heard.counters = counted;
  return {};
}

Result<std::vector<gpu::vec4>> Simulation::read_positions() const try {
  return state_->read(buffers::positions, state_->fabric.positions.size());
} catch (...) {
  return caught("the positions");
}
Result<std::vector<gpu::vec4>> Simulation::read_velocities() const try {
  return state_->read(buffers::velocities, state_->fabric.positions.size());
} catch (...) {
  return caught("the velocities");
}

// All of write_positions but the surface.
Result<void> Simulation::State::put(std::span<const gpu::vec4> positions) {
  if (auto good = check_count(positions); !good) return good;
  auto present = read(buffers::positions, positions.size());
  if (!present) return present.take_error();
  auto velocities = read(buffers::velocities, positions.size());
  if (!velocities) return velocities.take_error();
  std::vector<gpu::vec4> wanted(positions.begin(), positions.end());
  std::vector<bool> sanitized;
  sanitize_positions(fabric, *present, wanted, sanitized);
  // w belongs to the solver: inverse mass, split mass or material. Both iterates follow: particles that a frame does not predict
  // (anchors) are read there.
  const std::vector<gpu::vec4> iterate = iterates_at(wanted, fabric);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    wanted[i].w = (*present)[i].w;
    if (sanitized[i]) (*velocities)[i] = {0, 0, 0, (*velocities)[i].w};
  }
  auto counted = counters_and_sanitized(static_cast<std::size_t>(std::count(sanitized.begin(), sanitized.end(), true)));
  if (!counted) return counted.take_error();
  const auto upload = [&](const Buffer& row, const std::vector<gpu::vec4>& values) {
    return compute::Upload{&solver->buffer(row), std::as_bytes(std::span(values))};
  };
  std::vector<compute::Upload> uploads = {upload(buffers::positions, wanted), upload(buffers::predicted, iterate),
                                          upload(buffers::next_iterate, iterate), upload(buffers::velocities, *velocities)};
  const std::vector<gpu::LastPull> none = no_pulls(scene);   // what was pulled is elsewhere now
  if (solver->has(buffers::last_pulls)) uploads.push_back({&solver->buffer(buffers::last_pulls), std::as_bytes(std::span(none))});
  // With the pose, or not at all: displacement bounds must never be those of another, and a detection that was not due is another contact.
  gpu::Detection detection{};
  if (solver->has(buffers::detection)) {
    const auto anew = detection_anew();
    if (!anew) return anew.why();
    detection = *anew;
    uploads.push_back({&solver->buffer(buffers::detection), std::as_bytes(std::span(&detection, 1))});
  }
  if (auto done = write(std::move(uploads), *counted); !done) return done;
  stir();
  for (gpu::Anchor& anchor : kinematic.targets) {
    if (anchor.particle == WEFT_NONE) continue;
    anchor.particle &= ~(WEFT_STAYS | WEFT_FROM_HERE);
    const gpu::vec4& p = wanted[anchor.particle];
    anchor.from = anchor.to = {p.x, p.y, p.z};
  }
  kinematic.are_dirty = true;
  return {};
}

Result<void> Simulation::write_positions(std::span<const gpu::vec4> positions) try {
  if (auto done = state_->put(positions); !done) return done;
  return state_->draw_surface();
} catch (...) {
  return caught("the positions");
}

Result<void> Simulation::write_velocities(std::span<const gpu::vec4> velocities) try {
  State& s = *state_;
  if (auto good = s.check_count(velocities); !good) return good;
  auto wanted = read_velocities();   // w belongs to the solver
  if (!wanted) return wanted.take_error();
  std::size_t sanitized = 0;
  for (std::size_t i = 0; i < wanted->size(); ++i) {
    const gpu::vec4& v = velocities[i];
    sanitized += !is_finite(v);
    (*wanted)[i] = is_finite(v) ? gpu::vec4{v.x, v.y, v.z, (*wanted)[i].w} : gpu::vec4{0, 0, 0, (*wanted)[i].w};
  }
  auto counted = s.counters_and_sanitized(sanitized);
  if (!counted) return counted.take_error();
  return s.write({{&s.solver->buffer(buffers::velocities), std::as_bytes(std::span(*wanted))}}, *counted);
} catch (...) {
  return caught("the velocities");
}

namespace {

Result<std::vector<Vec3>> narrowed(Result<std::vector<gpu::vec4>> wide) {
  if (!wide) return wide.take_error();
  std::vector<Vec3> values;
  values.reserve(wide->size());
  for (const gpu::vec4& v : *wide) values.push_back({v.x, v.y, v.z});
  return values;
}

}  // namespace

Result<std::vector<Vec3>> Simulation::read_vertex_positions() const try {
  return narrowed(state_->read(buffers::vertex_positions, drawn_vertices(state_->fabric)));
} catch (...) {
  return caught("the vertices");
}

Result<std::vector<Vec3>> Simulation::read_vertex_normals() const try {
  return narrowed(state_->read(buffers::vertex_normals, drawn_vertices(state_->fabric)));
} catch (...) {
  return caught("the vertices");
}

}  // namespace weft
