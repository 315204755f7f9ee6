// Reading and writing the state from outside.
#include "engine/simulation_state.h"

#include <algorithm>
#include <cstring>

#include "engine/mend.h"

namespace weft {

Result<void> Simulation::State::wait() const {
  return submitted == 0 ? Result<void>() : compute::wait_for(*device, ready.get(), submitted);
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

Result<std::vector<gpu::vec4>> Simulation::State::read(gpu::Binding binding, std::size_t count) {
  if (auto done = wait(); !done) return done.take_error();
  if (auto done = put_frame_back(); !done) return done.take_error();
  std::vector<gpu::vec4> values(count);
  if (auto done = compute::read_back(*device, solver->buffer(binding), std::as_writable_bytes(std::span(values))); !done) return done.take_error();
  return values;
}

Result<void> Simulation::State::check_count(std::span<const gpu::vec4> values) const {
  return values.size() == fabric.positions.size() ? Result<void>() : fail(values.size(), " values were given for ", fabric.positions.size(), " particles");
}

Result<void> Simulation::State::write(gpu::Binding binding, std::vector<gpu::vec4> values) {
  // w belongs to the solver: inverse mass, split mass or material.
  auto present = read(binding, values.size());
  if (!present) return present.take_error();
  for (std::size_t i = 0; i < values.size(); ++i) values[i].w = (*present)[i].w;
  return compute::upload(*device, solver->buffer(binding), std::as_bytes(std::span(values)));
}

// The device must be done: in between the counters are its.
Result<void> Simulation::State::count_non_finite(std::size_t more) {
  if (more == 0) return {};
  gpu::Counters counted{};
  const auto bytes = std::as_writable_bytes(std::span(&counted, 1));
  if (auto done = compute::read_back(*device, solver->buffer(gpu::counters), bytes); !done) return done;
  counted.non_finite += static_cast<std::uint32_t>(more);
  std::memcpy(readback[0].mapped, &counted, sizeof counted);
  return compute::upload(*device, solver->buffer(gpu::counters), bytes);
}

Result<std::vector<gpu::vec4>> Simulation::read_positions() const { return state_->read(gpu::positions, state_->fabric.positions.size()); }
Result<std::vector<gpu::vec4>> Simulation::read_velocities() const { return state_->read(gpu::velocities, state_->fabric.positions.size()); }

Result<void> Simulation::write_positions(std::span<const gpu::vec4> positions) {
  if (auto good = state_->check_count(positions); !good) return good;
  auto present = read_positions();
  if (!present) return present.take_error();
  std::vector<gpu::vec4> wanted(positions.begin(), positions.end());
  std::vector<bool> mended;
  mend_positions(state_->fabric, *present, wanted, mended);
  const auto lost = static_cast<std::size_t>(std::count(mended.begin(), mended.end(), true));
  // Both iterates follow: what a frame does not predict (anchors) it takes from them.
  for (const gpu::Binding binding : {gpu::positions, gpu::predicted, gpu::relaxed})
    if (auto done = state_->write(binding, wanted); !done) return done;
  if (lost > 0) {   // at rest
    auto velocities = read_velocities();
    if (!velocities) return velocities.take_error();
    for (std::size_t i = 0; i < mended.size(); ++i)
      if (mended[i]) (*velocities)[i] = {0, 0, 0, 0};
    if (auto done = state_->write(gpu::velocities, std::move(*velocities)); !done) return done;
    if (auto done = state_->count_non_finite(lost); !done) return done;
  }
  for (gpu::Anchor& anchor : state_->anchors) {
    const gpu::vec4& p = wanted[anchor.particle];
    anchor.from = anchor.to = {p.x, p.y, p.z};
  }
  state_->anchors_are_owed = true;
  if (state_->solver->has(gpu::detection))
    if (auto done = state_->detect_anew(); !done) return done;
  return state_->draw_surface();
}

Result<void> Simulation::write_velocities(std::span<const gpu::vec4> velocities) {
  if (auto good = state_->check_count(velocities); !good) return good;
  std::vector<gpu::vec4> wanted(velocities.begin(), velocities.end());
  std::size_t lost = 0;
  for (gpu::vec4& v : wanted)
    if (!is_finite(v)) v = {0, 0, 0, 0}, ++lost;
  if (auto done = state_->write(gpu::velocities, std::move(wanted)); !done) return done;
  return state_->count_non_finite(lost);
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

Result<std::vector<Vec3>> Simulation::read_vertex_positions() const {
  return narrowed(state_->read(gpu::vertex_positions, state_->fabric.surface_rows.size()));
}

Result<std::vector<Vec3>> Simulation::read_vertex_normals() const {
  return narrowed(state_->read(gpu::vertex_normals, state_->fabric.surface_rows.size()));
}

}  // namespace weft
