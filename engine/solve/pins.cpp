// Pinning and releasing while running. Who is held decides masses, and with them many cooked lists: these are cooked anew on the CPU, where
// a frame begins, and what has changed of them travels in its commands (Edit). So it does not matter how a frame is run, and nothing waits.
#include <algorithm>
#include <cstring>

#include "engine/solve/sanitize.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

// Equal words between two that differ which one edit takes along: a command costs as much.
constexpr std::size_t kNear = 32;

// What makes `before` of a buffer `after`, which may be longer.
void add_differences(const Buffer& row, std::span<const std::byte> before, std::span<const std::byte> after, std::vector<Edit>& edits) {
  constexpr std::size_t kWord = 4;
  const std::size_t size = std::min(before.size(), after.size());
  const auto differs = [&](std::size_t at) { return std::memcmp(before.data() + at, after.data() + at, kWord) != 0; };
  for (std::size_t at = 0; at + kWord <= size; at += kWord) {
    if (!differs(at)) continue;
    std::size_t end = at + kWord;
    for (std::size_t next = end; next + kWord <= size && next - end <= kNear * kWord; next += kWord)
      if (differs(next)) end = next + kWord;
    edits.push_back({&row, at, {after.begin() + static_cast<std::ptrdiff_t>(at), after.begin() + static_cast<std::ptrdiff_t>(end)}});
    at = end - kWord;
  }
  if (after.size() > size) edits.push_back({&row, size, {after.begin() + static_cast<std::ptrdiff_t>(size), after.end()}});
}

std::uint32_t particle_of(const gpu::Anchor& anchor) {
  return anchor.particle == WEFT_NONE ? WEFT_NONE : anchor.particle & ~(WEFT_STAYS | WEFT_FROM_HERE);
}

}  // namespace

std::uint32_t Simulation::State::held_by(std::size_t place) const { return particle_of(kinematic.targets[place]); }

std::map<std::uint32_t, std::size_t> Simulation::State::places_held() const {
  std::map<std::uint32_t, std::size_t> places;
  for (std::size_t k = 0; k < anchors_and_pins(); ++k)
    if (const std::uint32_t particle = held_by(k); particle != WEFT_NONE) places.emplace(particle, k);
  return places;
}

Result<std::vector<std::uint32_t>> Simulation::State::particles_of(std::span<const std::uint32_t> vertices) const {
  std::vector<std::uint32_t> particles;
  const std::uint32_t cloth = cloth_vertices(fabric);
  for (const std::uint32_t v : vertices) {
    if (v >= fabric.surface_rows.size()) return fail("vertex ", v, " is not below the simulation's ", fabric.surface_rows.size());
    if (v >= cloth) return fail("vertex ", v, " is of a mesh collider: only cloth, the vertices below ", cloth, ", can be held");
    particles.push_back(fabric.surface_rows[v].x);
  }
  return particles;
}

Result<std::vector<std::uint32_t>> Simulation::State::pinnable(std::span<const std::uint32_t> vertices) const {
  if (scene.pins == 0) return fail("the scene has no pins (its key \"pins\"), and what it holds it holds for good");
  return particles_of(vertices);
}

// Of each particle. `targets`: as kinematic.targets.
std::vector<bool> Simulation::State::are_held(std::span<const gpu::Anchor> targets) const {
  std::vector<bool> held(fabric.positions.size());
  for (const gpu::Anchor& anchor : targets)
    if (anchor.particle != WEFT_NONE) held[particle_of(anchor)] = true;
  return held;
}

// `whole_plan`: all lists, not only those that depend on who is held; then of particles that did not exist, too.
void Simulation::State::add_changes(const CookedFabric& next, std::vector<Edit>& edits, bool whole_plan) const {
  const Cooked before = cooked_of(scene, fabric), after = cooked_of(scene, next);
  for (const Effect* effect : all_effects())
    for (const Buffer* row : effect->buffers) {
      if (whole_plan ? row->lifetime != Lifetime::cooked : effect->hold == nullptr) continue;
      if (row->contents == nullptr || !solver->has(*row)) continue;
      const Contents old = row->contents(before), made = row->contents(after);
      add_differences(*row, old.bytes(), made.bytes(), edits);
    }
  for (std::size_t i = 0; i < fabric.positions.size(); ++i) {
    const float w = next.positions[i].w, weight = next.iterate_weights[i];
    const std::uint64_t at = i * sizeof(gpu::vec4) + offsetof(gpu::vec4, w);
    if (w != fabric.positions[i].w) edits.push_back(edit_of(buffers::positions, at, w));
    if (weight == fabric.iterate_weights[i]) continue;
    for (const Buffer* row : {&buffers::predicted, &buffers::next_iterate}) edits.push_back(edit_of(*row, at, weight));
  }
}

Holds::Cooked Simulation::State::cooked_for(std::span<const gpu::Anchor> targets) {
  Holds::Cooked next{held_anew(scene, meshes, fabric, are_held(targets)), {}};
  add_changes(next.fabric, next.edits, false);
  holds.edits.reserve(holds.edits.size() + next.edits.size() + 1);
  return next;
}

void Simulation::State::take(Holds::Cooked next) noexcept {
  fabric = std::move(next.fabric);
  for (Edit& edit : next.edits) holds.edits.push_back(std::move(edit));
  holds.are_changed = false;
}

void Simulation::State::follow_holds() {
  if (!holds.are_changed) return;
  Holds::Cooked next = cooked_for(kinematic.targets);
  // Trajectories are those of particles with other masses.
  if (solver->has(buffers::detection))
    next.edits.push_back(edit_of(buffers::detection, offsetof(gpu::Detection, needs_detection), std::uint32_t(1)));
  take(std::move(next));
}

Result<void> Simulation::pin(std::span<const std::uint32_t> vertices) try {
  State& s = *state_;
  auto particles = s.pinnable(vertices);
  if (!particles) return particles.take_error();
  const std::size_t anchors = s.fabric.anchors.size();
  std::map<std::uint32_t, std::size_t> held = s.places_held(), own;   // an anchor that was released has its own place
  for (std::size_t k = 0; k < anchors; ++k)
    if (s.held_by(k) == WEFT_NONE) own.emplace(s.fabric.anchors[k].particle, k);
  std::vector<std::pair<std::size_t, std::uint32_t>> taken;
  std::size_t next = anchors;
  for (const std::uint32_t particle : *particles) {
    if (held.contains(particle)) continue;
    const auto at = own.find(particle);
    while (at == own.end() && next < s.anchors_and_pins() && s.held_by(next) != WEFT_NONE) ++next;
    const std::size_t place = at != own.end() ? at->second : next++;
    if (place >= s.anchors_and_pins())
      return fail("more vertices would be pinned than the scene has pins for, ", s.scene.pins, " (its key \"pins\")");
    held.emplace(particle, place);
    taken.emplace_back(place, particle);
  }
  for (const auto& [place, particle] : taken) {
    s.kinematic.targets[place] = {particle | WEFT_STAYS, {}, {}};
    s.kinematic.pending[place].reset();
    s.kinematic.is_host_driven[place] = true;
  }
  if (!taken.empty()) s.holds.are_changed = s.holds.are_new = true;
  return {};
} catch (...) {
  return caught("the pins");
}

Result<void> Simulation::release(std::span<const std::uint32_t> vertices) try {
  State& s = *state_;
  auto particles = s.pinnable(vertices);
  if (!particles) return particles.take_error();
  std::map<std::uint32_t, std::size_t> held = s.places_held();
  for (const std::uint32_t particle : *particles) {
    const auto at = held.find(particle);
    if (at == held.end()) continue;
    s.kinematic.targets[at->second] = {WEFT_NONE, {}, {}};
    s.kinematic.pending[at->second].reset();
    held.erase(at);
    s.holds.are_changed = s.holds.are_new = true;
  }
  return {};
} catch (...) {
  return caught("the pins");
}

Result<void> Simulation::move_pins(std::span<const std::uint32_t> vertices, std::span<const Vec3> targets) try {
  State& s = *state_;
  if (vertices.size() != targets.size()) return fail(targets.size(), " targets were given for ", vertices.size(), " vertices");
  auto particles = s.particles_of(vertices);
  if (!particles) return particles.take_error();
  const std::map<std::uint32_t, std::size_t> held = s.places_held();
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (!held.contains((*particles)[k])) return fail("vertex ", vertices[k], " is not held: pin it before it is moved");
    if (!is_finite(targets[k])) return fail("the target of vertex ", vertices[k], " is not finite, or ", kTooLarge, " m away or more");
  }
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const std::size_t place = held.at((*particles)[k]);
    s.kinematic.pending[place] = targets[k] - s.origin;
    s.kinematic.is_host_driven[place] = true;
  }
  return {};
} catch (...) {
  return caught("the pins");
}

}  // namespace weft
