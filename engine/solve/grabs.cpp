// Grabbing, dragging and throwing. The CPU looks for the place, in positions that it copies back; from then on a frame is told targets alone.
#include <algorithm>
#include <cmath>

#include "engine/solve/sanitize.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

constexpr double kMostGrip = 1e9;   // N/m, N s/m, N

Result<void> check_grip(const Grip& grip) {
  const auto wrong = [](const char* what, double value, const char* low, const char* unit) {
    return fail("the grip's ", what, " of ", value, " ", unit, " is not ", low, " 0, or above ", kMostGrip, " ", unit);
  };
  if (!(grip.stiffness > 0 && grip.stiffness <= kMostGrip)) return wrong("stiffness", grip.stiffness, "above", "N/m");
  if (!(grip.damping >= 0 && grip.damping <= kMostGrip)) return wrong("damping", grip.damping, "at least", "N s/m");
  if (!(grip.force > 0 && grip.force <= kMostGrip)) return wrong("force", grip.force, "above", "N");
  return {};
}

}  // namespace

Result<std::uint32_t> Simulation::State::free_grab(const Grip& grip) const {
  if (scene.grabs == 0) return fail("the scene has no grabs (its key \"grabs\")");
  if (auto good = check_grip(grip); !good) return good.take_error();
  const auto free = std::ranges::find_if(grabs.held, [](const auto& grab) { return !grab; });
  if (free == grabs.held.end()) return fail("all of the scene's ", scene.grabs, " grabs hold something: let one go");
  return static_cast<std::uint32_t>(free - grabs.held.begin());
}

// Relative to the origin.
Result<std::vector<Vec3>> Simulation::State::places_of_particles() {
  auto positions = read(buffers::positions, fabric.positions.size());
  if (!positions) return positions.take_error();
  std::vector<Vec3> places;
  places.reserve(positions->size());
  for (const gpu::vec4& x : *positions) places.push_back({x.x, x.y, x.z});
  return places;
}

// The corners keep their places about the hand, and share its grip as they share the point.
Grabbed Simulation::State::take_hold(std::uint32_t grab, const Hit& hit, std::span<const Vec3> places, const Grip& grip) {
  const Triangle& corners = fabric.triangles[hit.triangle];
  Snapshot::GrabState held;
  held.grab = grab;
  held.stiffness = static_cast<float>(grip.stiffness);
  held.damping = static_cast<float>(grip.damping);
  held.force = static_cast<float>(grip.force);
  for (std::size_t k = 0; k < 3; ++k) {
    held.particles[k] = corners[k];
    held.weights[k] = static_cast<float>(hit.weights[k]);
    held.place = held.place + held.weights[k] * places[corners[k]];
  }
  for (std::size_t k = 0; k < 3; ++k) held.offsets[k] = places[corners[k]] - held.place;
  grabs.held[grab] = held;
  const auto has_it = [&](const ClothRange& range) { return corners[0] < range.first_particle + range.particles; };
  const auto cloth = std::ranges::find_if(fabric.cloths, has_it);
  return {grab, static_cast<std::uint32_t>(cloth - fabric.cloths.begin()), held.place + origin, hit.distance};
}

Result<std::optional<Grabbed>> Simulation::grab(Vec3 origin, Vec3 direction, const Grip& grip) try {
  State& s = *state_;
  if (!is_finite(origin) || !is_finite(direction)) return fail("the ray is not finite, or comes from ", kTooLarge, " m away or more");
  if (!(length(direction) > 1e-6f)) return fail("the ray's direction has a length of ", length(direction), ", not above 1e-6");
  auto free = s.free_grab(grip);
  if (!free) return free.take_error();
  auto places = s.places_of_particles();
  if (!places) return places.take_error();
  const auto hit = first_on_ray(std::span(s.fabric.triangles).first(s.fabric.cloth_triangles), *places, origin - s.origin, direction);
  return hit ? std::optional(s.take_hold(*free, *hit, *places, grip)) : std::nullopt;
} catch (...) {
  return caught("the grab");
}

Result<Grabbed> Simulation::grab_near(Vec3 point, const Grip& grip) try {
  State& s = *state_;
  if (!is_finite(point)) return fail("the point is not finite, or ", kTooLarge, " m away or more");
  auto free = s.free_grab(grip);
  if (!free) return free.take_error();
  auto places = s.places_of_particles();
  if (!places) return places.take_error();
  const auto hit = nearest_to(std::span(s.fabric.triangles).first(s.fabric.cloth_triangles), *places, point - s.origin);
  if (!hit) return fail("no triangle of the cloth is finite");
  return s.take_hold(*free, *hit, *places, grip);
} catch (...) {
  return caught("the grab");
}

Result<void> Simulation::move_grab(std::uint32_t grab, Vec3 target) try {
  auto& held = state_->grabs.held;
  if (grab >= held.size() || !held[grab]) return fail("nothing is held by grab ", grab);
  if (!is_finite(target)) return fail("the target of grab ", grab, " is not finite, or ", kTooLarge, " m away or more");
  held[grab]->pending = target - state_->origin;
  held[grab]->is_pending = true;
  return {};
} catch (...) {
  return caught("the grab");
}

Result<void> Simulation::let_go(std::uint32_t grab) try {
  State& s = *state_;
  if (grab >= s.grabs.held.size() || !s.grabs.held[grab]) return fail("nothing is held by grab ", grab);
  // Its particles have their own weight again.
  std::vector<Edit> edits;
  for (const std::uint32_t particle : s.grabs.held[grab]->particles) {
    const std::uint64_t at = particle * sizeof(gpu::vec4) + offsetof(gpu::vec4, w);
    for (const Buffer* row : {&buffers::predicted, &buffers::next_iterate}) edits.push_back(edit_of(*row, at, s.fabric.iterate_weights[particle]));
  }
  s.holds.edits.reserve(s.holds.edits.size() + edits.size());
  for (Edit& edit : edits) s.holds.edits.push_back(std::move(edit));
  s.grabs.held[grab].reset();
  return {};
} catch (...) {
  return caught("the grab");
}

// Their targets in the frame at hand.
void Simulation::State::move_grabs() {
  const auto packed = [](Vec3 v) { return gpu::vec3{v.x, v.y, v.z}; };
  for (std::size_t g = 0; g < grabs.held.size(); ++g)
    for (std::size_t k = 0; k < 3; ++k) {
      gpu::Grab& corner = grabs.corners[3 * g + k];
      corner.particle = WEFT_NONE;
      if (!grabs.held[g]) continue;
      const Snapshot::GrabState& held = *grabs.held[g];
      const float weight = held.weights[k];
      if (weight == 0) continue;
      const Vec3 to = held.is_pending ? held.pending : held.place;
      corner = {held.particles[k], fabric.iterate_weights[held.particles[k]], weight * held.stiffness, weight * held.damping,
                weight * held.force, packed(held.place + held.offsets[k]), packed(to + held.offsets[k])};
    }
  for (auto& held : grabs.held) {
    if (!held || !held->is_pending) continue;
    held->place = held->pending;
    held->is_pending = false;
  }
}

}  // namespace weft
