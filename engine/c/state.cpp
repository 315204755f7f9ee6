// See engine/c/weft.h: particles, counts, and the state as bytes.
#include "engine/c/inside.h"

#include <cstring>

#include "engine/metrics.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

using weft::gpu::vec4;
static_assert(sizeof(vec4) == 4 * sizeof(float));

Result<void> copy(Result<std::vector<vec4>> read, float* xyzw, std::size_t particles) {
  if (!read) return read.take_error();
  if (auto good = room(particles, read->size(), "particles"); !good) return good;
  std::memcpy(xyzw, read->data(), read->size() * sizeof(vec4));
  return {};
}

std::vector<vec4> fours(const float* xyzw, std::size_t count) {
  std::vector<vec4> all(count);
  std::memcpy(all.data(), xyzw, count * sizeof(vec4));
  return all;
}

Result<void> hand_out(const std::string& text, char** out) {
  auto bytes = handed_out(std::as_bytes(std::span(text.c_str(), text.size() + 1)));   // with the zero at its end
  if (!bytes) return bytes.take_error();
  *out = static_cast<char*>(*bytes);
  return {};
}

Result<weft::Snapshot> snapshot_of(const void* bytes, std::size_t size) {
  return weft::parse_snapshot({static_cast<const std::byte*>(bytes), size});
}

}  // namespace

uint32_t weft_particle_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->fabric().positions.size()) : 0;
}

weft_status weft_origin(const weft_simulation* simulation, float origin[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(origin);
    put(simulation->simulation->origin(), origin);
    return {};
  });
}

weft_status weft_read_particles(const weft_simulation* simulation, float* xyzw, size_t particles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyzw);
    return copy(simulation->simulation->read_positions(), xyzw, particles);
  });
}

weft_status weft_read_velocities(const weft_simulation* simulation, float* xyzw, size_t particles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyzw);
    return copy(simulation->simulation->read_velocities(), xyzw, particles);
  });
}

weft_status weft_write_particles(weft_simulation* simulation, const float* xyzw, size_t particles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyzw);
    if (auto good = room(particles, weft_particle_count(simulation), "particles"); !good) return good;
    return simulation->simulation->write_positions(fours(xyzw, particles));
  });
}

weft_status weft_write_velocities(weft_simulation* simulation, const float* xyzw, size_t particles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyzw);
    if (auto good = room(particles, weft_particle_count(simulation), "particles"); !good) return good;
    return simulation->simulation->write_velocities(fours(xyzw, particles));
  });
}

weft_status weft_vertex_particles(const weft_simulation* simulation, uint32_t* particles, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(particles);
    const weft::CookedFabric& fabric = simulation->simulation->fabric();
    if (auto good = room(vertices, weft::drawn_vertices(fabric), "vertices"); !good) return good;
    for (std::size_t v = 0; v < vertices; ++v) particles[v] = v < fabric.surface_rows.size() ? fabric.surface_rows[v].x : WEFT_NOTHING;
    return {};
  });
}

weft_counts weft_get_counts(const weft_simulation* simulation) {
  if (simulation == nullptr) return {};
  const weft::Counts c = simulation->simulation->counts();
  return {c.non_finite, c.coincident, c.contacts_overflowed, c.crossings, c.contacts_most, c.contacts_room, c.truncated, c.detections};
}

weft_quality weft_get_quality(const weft_simulation* simulation) {
  if (simulation == nullptr) return {};
  const weft::Counts c = simulation->simulation->counts();
  return {c.crossings_most, c.unconverged, c.stopped, c.unaccelerated, c.splits_refused, c.tracking_error, c.residual};
}

weft_status weft_scene_text(const weft_simulation* simulation, char** text, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(text);
    return hand_out(weft::scene_text(simulation->simulation->scene()), text);
  });
}

weft_status weft_notes(const weft_simulation* simulation, char** text, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(text);
    std::string lines;
    for (const std::string& note : simulation->simulation->fabric().notes) lines.append(note).append("\n");
    return hand_out(lines, text);
  });
}

weft_status weft_hash(const weft_simulation* simulation, uint64_t* hash, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(hash);
    auto particles = simulation->simulation->read_positions();
    if (!particles) return particles.take_error();
    *hash = weft::position_hash(*particles);
    return {};
  });
}

weft_status weft_save(const weft_simulation* simulation, void** bytes, size_t* size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(bytes);
    WEFT_GIVEN(size);
    auto snapshot = simulation->simulation->save();
    if (!snapshot) return snapshot.take_error();
    const std::vector<std::byte> all = weft::snapshot_bytes(*snapshot);
    auto copied = handed_out(all);
    if (!copied) return copied.take_error();
    *bytes = *copied;
    *size = all.size();
    return {};
  });
}

weft_status weft_restore(weft_simulation* simulation, const void* bytes, size_t size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(bytes, size);
    auto snapshot = snapshot_of(bytes, size);
    if (!snapshot) return snapshot.take_error();
    return simulation->simulation->restore(*snapshot);
  });
}

weft_status weft_fits(const weft_simulation* simulation, const void* bytes, size_t size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(bytes, size);
    auto snapshot = snapshot_of(bytes, size);
    if (!snapshot) return snapshot.take_error();
    return simulation->simulation->fits(*snapshot);
  });
}
