// Saving and restoring the whole state.
//
// Between frames both iterates equal the positions, so they are not saved, and it does not matter with which of them a frame
// begins. The next frame uploads the kinematic targets. Everything is checked before anything is changed: a snapshot that does not
// fit leaves the simulation as it was.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <tuple>

#include "engine/effects/bdf2/bdf2.h"
#include "engine/effects/ranges.h"
#include "engine/effects/support/support.h"
#include "engine/solve/sanitize.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

template <class T>
std::vector<T> elements(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

const std::vector<std::byte>* find(const Snapshot& snapshot, const std::string& name) {
  for (const Snapshot::Content& content : snapshot.contents)
    if (content.name == name) return &content.bytes;
  return nullptr;
}

bool is_pose(const ColliderPose& pose) {
  const Rotation& r = pose.rotation;
  return is_finite(pose.centre) && is_finite(pose.normal) && std::isfinite(r.x + r.y + r.z + r.w);
}

bool is_size(const ColliderSize& size) {
  constexpr double kMost = scene_fields::kFarthest;
  const auto good = [&](double value) { return value > 0 && value <= kMost; };
  return good(size.radius) && good(size.radius_end) && good(size.length) && good(size.size.x) && good(size.size.y) && good(size.size.z);
}

// w is the scene's: an inverse mass, or a material that a shader looks up.
Result<void> check_values(const char* name, const std::vector<gpu::vec4>& values, const std::vector<gpu::vec4>& cooked) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!is_finite(values[i]) || std::memcmp(&values[i].w, &cooked[i].w, sizeof(float)) != 0)
      return fail("the snapshot's ", name, " of particle ", i, " are not finite, or have another w than the scene's");
  return {};
}

// Of the candidates only those that were found, and none where the next substep detects first: a buffer that has just grown was
// never written. Of other buffers the part in use: the rest of their memory was never written either.
std::size_t bytes_of(const Solver& solver, const Buffer& row, const gpu::Detection& detection, std::uint32_t capacity) {
  if (&row != &buffers::candidates) return static_cast<std::size_t>(solver.used_bytes(row));
  return detection.needs_detection != 0 ? 0 : std::min(detection.candidates, capacity) * sizeof(gpu::uvec4);
}

// Sorts candidates, which threads append in any order. No frame depends on that order, and neither may the file.
void put_in_order(std::vector<std::byte>& bytes) {
  std::vector<gpu::uvec4> candidates = elements<gpu::uvec4>(bytes);
  std::ranges::sort(candidates, {}, [](const gpu::uvec4& packed) { return std::tuple(packed.x, packed.y, packed.z, packed.w); });
  if (!bytes.empty()) std::memcpy(bytes.data(), candidates.data(), bytes.size());
}

// The name of a snapshot's kinematic targets, of anchors and of mesh colliders' vertices.
constexpr const char* kAnchors = "anchors";

std::vector<gpu::Anchor> anchors_of(const Snapshot& snapshot) {
  const auto* bytes = find(snapshot, kAnchors);
  return bytes ? elements<gpu::Anchor>(*bytes) : std::vector<gpu::Anchor>();
}

bool is_grab(const Snapshot::GrabState& state, const Scene& scene, const CookedFabric& fabric) {
  if (state.grab >= scene.grabs || !is_finite(state.place) || !is_finite(state.pending)) return false;
  for (const float value : {state.stiffness, state.damping, state.force})
    if (!(value >= 0 && value < kTooLarge)) return false;
  for (int k = 0; k < 3; ++k)
    if (state.particles[k] >= cloth_particles(fabric) || !is_finite(state.offsets[k]) || !(state.weights[k] >= 0 && state.weights[k] <= 1))
      return false;
  return true;
}

// Pairs are of a particle and a triangle, or of two edges; the capacity is at most twice what was found (grow_capacity).
std::uint64_t most_candidates(const CookedFabric& fabric) {
  const std::uint64_t edges = fabric.edges.size();
  return std::min<std::uint64_t>(2 * (fabric.positions.size() * fabric.triangles.size() + edges * edges / 2), kMostCandidates);
}

void put_masses(std::vector<std::byte>& bytes, const CookedFabric& fabric) {
  for (std::size_t i = 0; i < fabric.positions.size(); ++i)
    std::memcpy(bytes.data() + i * sizeof(gpu::vec4) + offsetof(gpu::vec4, w), &fabric.positions[i].w, sizeof(float));
}

void call_for_detection(std::vector<std::byte>& bytes) {
  const std::uint32_t needs = 1;
  std::memcpy(bytes.data() + offsetof(gpu::Detection, needs_detection), &needs, sizeof needs);
}

gpu::Detection detection_of(const Snapshot& snapshot) {
  gpu::Detection detection{};
  if (const auto* bytes = find(snapshot, "detection"); bytes && bytes->size() >= sizeof detection)
    std::memcpy(&detection, bytes->data(), sizeof detection);
  return detection;
}

}  // namespace

// Made when first needed: it goes through all that was cooked.
std::uint64_t Simulation::State::own_digest() {
  if (!digest) digest = digest_of(scene, fabric);
  return *digest;
}

Result<Snapshot> Simulation::save() const try {
  State& s = *state_;
  if (auto done = s.wait(); !done) return done.take_error();
  if (auto done = s.put_frame_back(); !done) return done.take_error();
  s.follow_holds();
  if (!s.tears.whole.empty()) {
    if (auto done = s.send_edits(); !done) return done.take_error();
    if (auto heard = s.hear_look(); !heard) return heard.take_error();
  }
  Snapshot snapshot;
  s.save_tears(snapshot);
  snapshot.digest = s.own_digest();
  snapshot.substeps = s.clock.substeps;
  snapshot.left_over = s.clock.left_over;
  snapshot.gravity = s.gravity;
  snapshot.haste = s.kinematic.haste;
  snapshot.wind = s.moving_air.wind;
  for (const Air::Field& field : s.moving_air.fields) snapshot.air_fields.push_back({field.centre, field.velocity});
  snapshot.wind_travelled = s.moving_air.travelled;
  for (std::size_t k = 0; k < s.skinned_meshes().size(); ++k) {
    const SkinnedMesh& skinned = s.skinned_meshes()[k];
    const auto joints = s.skins.pose.begin() + skinned.first_joint;
    const auto weights = s.skins.weights.begin() + skinned.first_morph;
    snapshot.skins.push_back({s.skins.is_host_driven[k], {joints, joints + skinned.joints}, s.skins.pending[k],
                              s.skins.has_host_weights[k], {weights, weights + skinned.morphs}, s.skins.pending_weights[k],
                              s.skins.are_kept[k]});
  }
  for (const gpu::MotionLimits& limits : s.skins.limits) snapshot.motion_limits.push_back({limits.scale, limits.stiffness});
  snapshot.frames = s.saved_frames();
  snapshot.gas_amounts = s.gas_amounts;
  snapshot.phase = s.solver->phase();
  snapshot.capacity = s.solver->contact_settings().capacity;
  for (std::uint32_t k = 0; k < s.kinematic.is_host_driven.size(); ++k)
    if (s.kinematic.is_host_driven[k])
      snapshot.anchors.push_back({k, s.kinematic.pending[k].has_value(), s.kinematic.pending[k].value_or(Vec3())});
  for (const auto& grab : s.grabs.held)
    if (grab) snapshot.grabs.push_back(*grab);
  for (std::size_t k = 0; k < s.bodies.poses.size(); ++k)
    snapshot.colliders.push_back(
        {s.bodies.is_host_driven[k], s.bodies.pending[k].has_value(), s.bodies.poses[k], s.bodies.pending[k].value_or(ColliderPose()),
         s.bodies.pending_sizes[k].has_value(), s.bodies.sizes[k], s.bodies.pending_sizes[k].value_or(ColliderSize())});
  for (const Buffer* row : s.rollback.rows) {   // `detection` comes before `candidates`
    const compute::Buffer& buffer = s.solver->buffer(*row);
    std::vector<std::byte> bytes(bytes_of(*s.solver, *row, detection_of(snapshot), snapshot.capacity));
    if (auto done = compute::read_back(*s.device, buffer, bytes); !done) return done.take_error();
    if (row == &buffers::candidates) put_in_order(bytes);
    // What the next frame would be told.
    if (row == &buffers::positions) put_masses(bytes, s.fabric);
    if (row == &buffers::detection && s.holds.are_new) call_for_detection(bytes);
    snapshot.contents.push_back({buffer.name, std::move(bytes)});
  }
  const auto anchors = std::as_bytes(std::span(s.kinematic.targets));
  snapshot.contents.push_back({kAnchors, {anchors.begin(), anchors.end()}});
  return snapshot;
} catch (...) {
  return caught("the snapshot");
}

// Of each place the particle that the scene has there; where the host may pin, also none, and for pins any of cloth.
bool Simulation::State::are_targets(const std::vector<gpu::Anchor>& targets) const {
  if (targets.size() != kinematic.targets.size()) return false;
  std::set<std::uint32_t> seen;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const bool pin = k >= fabric.anchors.size() && k < anchors_and_pins(), may_be_none = scene.pins > 0 && k < anchors_and_pins();
    if (!is_finite(Vec3{targets[k].to.x, targets[k].to.y, targets[k].to.z})) return false;
    if (may_be_none && targets[k].particle == WEFT_NONE) continue;
    const std::uint32_t particle = may_be_none ? targets[k].particle & ~(WEFT_STAYS | WEFT_FROM_HERE) : targets[k].particle;
    const std::uint32_t own = k < fabric.anchors.size() ? fabric.anchors[k].particle : kinematic.targets[k].particle;
    if (pin ? particle >= cloth_particles(fabric) : particle != own) return false;
    if (!seen.insert(particle).second) return false;
  }
  return true;
}

// As they were cooked, with the masses that they have when these are held.
std::vector<gpu::vec4> Simulation::State::positions_of(const CookedFabric& fabric, const std::vector<bool>& held) {
  std::vector<gpu::vec4> positions = fabric.positions;
  for (std::size_t i = 0; i < fabric.inverse_masses.size(); ++i) positions[i].w = held[i] ? 0 : fabric.inverse_masses[i];
  return positions;
}

// Returns the cloth as the snapshot has it torn, where it is torn otherwise now.
Result<std::optional<Simulation::State::Torn>> Simulation::State::check(const Snapshot& snapshot) {
  if (snapshot.digest != own_digest())
    return fail("the snapshot was taken of another scene than ", scene.name.empty() ? "this one" : scene.name,
                ", or with other settings, fabrics or meshes than it has now");
  const auto unfit = [&](const auto&... what) { return fail("the snapshot is damaged: ", what...); };
  if (!(snapshot.left_over >= 0 && snapshot.left_over <= fabric.h))
    return unfit("the ", snapshot.left_over, " s left over are not between 0 and a substep of ", fabric.h, " s");
  if (!(snapshot.haste >= 0 && snapshot.haste <= 1)) return unfit("its anchors' haste is ", snapshot.haste, ", not between 0 and 1");
  if (!is_finite(snapshot.gravity)) return unfit("its gravity is not finite");
  if (!is_finite(snapshot.wind)) return unfit("its wind is not finite");
  if (snapshot.air_fields.size() != moving_air.fields.size())
    return unfit("its air has ", snapshot.air_fields.size(), " fields instead of ", moving_air.fields.size());
  for (const auto& [centre, velocity] : snapshot.air_fields)
    if (!is_finite(centre) || !is_finite(velocity)) return unfit("a field of its air is not finite");
  for (const double way : snapshot.wind_travelled)
    if (!std::isfinite(way)) return unfit("its wind has travelled ", way, " m");
  if (auto good = check_skins(snapshot); !good) return unfit(good.why());
  if (auto good = check_frames(snapshot); !good) return unfit(good.why());
  if (auto good = check_gases(snapshot); !good) return unfit(good.why());
  if (snapshot.phase > 2) return unfit("its phase of ", snapshot.phase, " is above 2");
  if (const std::uint64_t most = std::max<std::uint64_t>(most_candidates(fabric), solver->contact_settings().capacity);
      snapshot.capacity > most)
    return unfit("its capacity of ", snapshot.capacity, " candidates is more than this scene can take, ", most);
  for (const Snapshot::AnchorTargetState& state : snapshot.anchors)
    if (state.anchor >= kinematic.is_host_driven.size() || !is_finite(state.target))
      return unfit("it drives anchor ", state.anchor, " of ", kinematic.is_host_driven.size(), ", or to a target that is not finite");
  if (snapshot.colliders.size() != bodies.poses.size())
    return unfit("it has ", snapshot.colliders.size(), " colliders instead of ", bodies.poses.size());
  for (std::size_t k = 0; k < snapshot.colliders.size(); ++k)
    if (!is_pose(snapshot.colliders[k].pose) || !is_pose(snapshot.colliders[k].pending))
      return unfit("the pose of collider ", k, " is not finite");
  for (std::size_t k = 0; k < snapshot.colliders.size(); ++k)
    for (const ColliderSize& size : {snapshot.colliders[k].size, snapshot.colliders[k].pending_size})
      if (!is_size(size) || (!may_resize(scene.colliders[k]) && !(snapshot.colliders[k].size == bodies.sizes[k])))
        return unfit("collider ", k, " has a size that it cannot have");
  if (snapshot.contents.size() != rollback.rows.size() + 1)
    return unfit("it has ", snapshot.contents.size(), " buffers instead of ", rollback.rows.size() + 1);
  const auto targets = anchors_of(snapshot);
  if (!are_targets(targets))
    return unfit("its ", targets.size(), " anchors are not the scene's ", kinematic.targets.size(), " or have targets that are not finite");
  for (const Snapshot::GrabState& state : snapshot.grabs)
    if (!is_grab(state, scene, fabric)) return unfit("grab ", state.grab, " is none that this scene can have");
  const gpu::Detection found = detection_of(snapshot);
  if (!(found.least >= 0 && found.least < kTooLarge))
    return unfit("its least displacement bound is ", found.least, " m, not from 0 to ", kTooLarge);
  if (found.steps > WEFT_LONGEST_LIFETIME || found.lifetime > WEFT_LONGEST_LIFETIME)
    return unfit("its last detection is ", found.steps, " substeps ago and valid for ", found.lifetime, "; neither may be above ",
                 WEFT_LONGEST_LIFETIME);
  if (found.needs_detection == 0 && found.candidates > snapshot.capacity)   // an overflow calls for a detection
    return unfit("its ", found.candidates, " candidates are more than its capacity, ", snapshot.capacity);
  auto torn = torn_of(snapshot, targets);
  if (!torn) return unfit(torn.why());
  const CookedFabric& present = *torn ? (*torn)->cooked.fabric : fabric;
  for (const Buffer* row : rollback.rows) {
    const compute::Buffer& buffer = solver->buffer(*row);
    const std::size_t wanted = bytes_of(*solver, *row, found, snapshot.capacity);
    const auto* bytes = find(snapshot, buffer.name);
    if (!bytes || bytes->size() != wanted)
      return unfit("its buffer ", buffer.name, " has ", bytes ? bytes->size() : 0, " bytes instead of ", wanted);
    if (row == &buffers::positions)
      if (auto good = check_values("positions", elements<gpu::vec4>(*bytes), positions_of(present, are_held(targets))); !good)
        return good.take_error();
    if (row == &buffers::velocities)
      if (auto good = check_values("velocities", elements<gpu::vec4>(*bytes), present.velocities); !good) return good.take_error();
    if (row == &buffers::detected_positions || row == &buffers::trajectories || row == &buffers::skin_ends || row == &buffers::supports ||
        row == &buffers::velocity_changes || row == &buffers::step_remainders)
      for (const gpu::vec4& at : elements<gpu::vec4>(*bytes))
        if (!is_finite(at)) return unfit("its buffer ", buffer.name, " has a vector that is not finite");
    const std::size_t formulas = scene.colliders.size() - fabric.collider_meshes.size();
    if (row == &buffers::support_bodies)
      for (const std::uint32_t body : elements<std::uint32_t>(*bytes))
        if (body >= formulas) return unfit("its buffer ", buffer.name, " has collider ", body, " of ", formulas);
    if (row == &buffers::displacement_bounds || row == &buffers::near_bounds)
      for (const std::uint32_t bits : elements<std::uint32_t>(*bytes))
        if (const float bound = std::bit_cast<float>(bits & ~WEFT_PAIRED); !(bound >= 0 && bound < kTooLarge))
          return unfit("its buffer ", buffer.name, " has one of ", bound, " m");
    if (row != &buffers::candidates) continue;
    const auto bounds = elements<std::uint32_t>(*find(snapshot, "displacement_bounds"));   // checked before
    for (const gpu::uvec4& packed : elements<gpu::uvec4>(*bytes)) {
      const gpu::Candidate candidate = gpu::unpack_candidate(packed);
      for (const std::uint32_t particle : candidate.particle) {
        if (particle >= fabric.positions.size()) return unfit("a candidate has particle ", particle, " of ", fabric.positions.size());
        if ((bounds[particle] & WEFT_PAIRED) == 0) return unfit("a candidate has particle ", particle, ", which is marked to have none");
      }
      if (!(candidate.separation >= 0 && candidate.separation < kTooLarge))
        return unfit("a candidate has a separation of ", candidate.separation, " m");
    }
  }
  return torn;
}

Result<void> Simulation::fits(const Snapshot& snapshot) const try {
  if (auto good = state_->check(snapshot); !good) return good.take_error();
  return {};
} catch (...) {
  return caught("the snapshot");
}

Result<void> Simulation::restore(const Snapshot& snapshot) try {
  auto torn = state_->check(snapshot);
  if (!torn) return torn.take_error();
  if (auto done = state_->wait(); !done) return done;
  if (auto done = state_->put_frame_back(); !done) return done;
  return state_->put_back(snapshot, std::move(*torn));
} catch (...) {
  return caught("the snapshot");
}

Result<void> Simulation::State::put_back(const Snapshot& snapshot, std::optional<Torn> torn) {
  const bool contacts = solver->has(buffers::candidates);
  if (contacts && snapshot.capacity > solver->contact_settings().capacity) {
    // Growing discards the candidates; should anything fail from there on, they must be detected again.
    stir();
    const auto anew = detection_anew();
    if (!anew) return anew.why();
    if (auto done = compute::upload(*device, solver->buffer(buffers::detection), std::as_bytes(std::span(&*anew, 1))); !done) return done;
    if (auto grown = solver->grow(snapshot.capacity); !grown) return grown.take_error();
    if (auto done = create_saved(); !done) return done;
  }
  std::vector<gpu::Anchor> targets = anchors_of(snapshot);
  std::optional<Holds::Cooked> cooked;
  if (scene.pins > 0 && !torn) cooked = cooked_for(targets);
  const CookedFabric& fabric = torn ? torn->cooked.fabric : cooked ? cooked->fabric : this->fabric;
  const std::vector<gpu::vec4> iterate = iterates_at(elements<gpu::vec4>(*find(snapshot, "positions")), fabric);
  std::vector<compute::Upload> uploads;
  for (const Buffer* row : {&buffers::predicted, &buffers::next_iterate})
    uploads.push_back({&solver->buffer(*row), std::as_bytes(std::span(iterate))});
  for (const Buffer* row : rollback.rows) {
    const compute::Buffer& buffer = solver->buffer(*row);
    uploads.push_back({&buffer, *find(snapshot, buffer.name)});
  }
  Skins skinned = skins_of(snapshot);
  if (auto done = compute::upload_all(*device, uploads); !done) return done;

  // From here on nothing asks for memory, up to the surface, but what is torn.
  std::erase_if(holds.edits, [](const Edit& edit) { return edit.copied > 0; });   // what was to begin where others are has begun
  if (torn) take(std::move(*torn));
  put_tears_back(snapshot);
  kinematic.targets = std::move(targets);
  kinematic.are_dirty = true;
  if (cooked) take(std::move(*cooked));   // the next frame tells the GPU what differs of the lists
  holds.are_new = false;
  std::ranges::fill(grabs.held, std::nullopt);
  for (const Snapshot::GrabState& state : snapshot.grabs) grabs.held[state.grab] = state;
  // What the frame has reported at its end.
  std::memcpy(&heard.counters, find(snapshot, "counters")->data(), sizeof heard.counters);
  heard.detection = detection_of(snapshot);
  if (const auto* sums = find(snapshot, "reactions"); sums != nullptr) std::memcpy(reactions.heard.data(), sums->data(), sums->size());
  reactions.known = reactions.told = reactions.heard;
  solver->set_phase(snapshot.phase);
  capacity.room = heard.counters.contacts_room;
  capacity.lost = capacity.told = heard.counters.contacts_overflowed;
  capacity.detections = heard.counters.detections;
  capacity.calm = capacity.still = 0;
  clock.substeps = snapshot.substeps;
  clock.left_over = snapshot.left_over;
  gravity = snapshot.gravity;
  kinematic.haste = snapshot.haste;
  moving_air.wind = snapshot.wind;
  for (std::size_t k = 0; k < moving_air.fields.size(); ++k) {
    moving_air.fields[k].centre = snapshot.air_fields[k].centre;
    moving_air.fields[k].velocity = snapshot.air_fields[k].velocity;
  }
  moving_air.travelled = snapshot.wind_travelled;
  skins = std::move(skinned);
  put_frames_back(snapshot);
  std::ranges::copy(snapshot.gas_amounts, gas_amounts.begin());
  kinematic.is_host_driven.assign(kinematic.is_host_driven.size(), false);
  kinematic.pending.assign(kinematic.pending.size(), std::nullopt);
  for (const Snapshot::AnchorTargetState& state : snapshot.anchors) {
    kinematic.is_host_driven[state.anchor] = true;
    if (state.is_pending) kinematic.pending[state.anchor] = state.target;
  }
  for (std::size_t k = 0; k < bodies.poses.size(); ++k) {
    const Snapshot::ColliderState& state = snapshot.colliders[k];
    bodies.poses[k] = state.pose;
    bodies.is_host_driven[k] = state.is_host_driven;
    bodies.pending[k] = state.is_pending ? std::optional(state.pending) : std::nullopt;
    bodies.sizes[k] = state.size;
    bodies.pending_sizes[k] = state.is_resized ? std::optional(state.pending_size) : std::nullopt;
    bodies.keys[k] = pose_at(scene.colliders[k].keys, now());
  }
  if (!tears.whole.empty())   // what is drawn at once has the triangles of then
    if (auto done = send_edits(); !done) return done;
  return draw_surface();
}

}  // namespace weft
