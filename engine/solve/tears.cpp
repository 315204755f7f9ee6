// Tearing and cutting. Every third frame that does not tear copies back where the particles are; three frames later the host looks at that,
// splits points of the mesh, cooks it anew, and what has changed of the lists travels in that frame's commands (Edit). A frame therefore
// tears the same cloth, to the bit, however it is run, and nothing waits: two frames may be under way.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "engine/solve/sanitize.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

using Eigen::Vector3d;
using parts::wide;

// How long `record` waits for a frame that is under way on the host's queue.
constexpr std::chrono::seconds kLongestWait{2};

Edit copy_of(const Buffer& row, std::uint64_t from, std::uint64_t to) {
  return {&row, to * row.element_bytes, {}, from * row.element_bytes, row.element_bytes};
}

}  // namespace

Result<void> Simulation::State::make_tears() {
  if (!weft::tears(scene)) return {};
  tears.whole = meshes;
  tears.done.resize(scene.cloths.size());
  tears.found.resize(scene.cloths.size());
  auto made = compute::create_event(*device, "weft look");
  if (!made) return made.take_error();
  tears.is_seen = std::move(*made);
  (void)own_digest();   // of the cloth while it is whole
  return {};
}

std::uint32_t Simulation::State::split_count() const {
  std::size_t count = 0;
  for (const auto& splits : tears.done) count += splits.size();
  return static_cast<std::uint32_t>(count);
}

// `places`: of all particles (m). Without a blade: where cloth is overstretched.
std::vector<std::vector<Split>> Simulation::State::splits_in(std::span<const Vec3> places, const cooking::Blade* blade) {
  const TearLists& lists = std::as_const(fabric.own).of<TearLists>();
  std::vector<std::vector<Split>> splits(scene.cloths.size());
  for (std::size_t c = 0; c < scene.cloths.size(); ++c) {
    if (!scene.cloths[c].tear) continue;
    const std::uint32_t first = fabric.cloths[c].first_particle;
    std::vector<Vector3d> of_points(meshes[c].points.size());
    std::vector<std::uint32_t> particle_of(of_points.size());
    for (std::uint32_t k = 0; k < of_points.size(); ++k) {
      particle_of[lists.orders[c][k]] = first + k;
      of_points[lists.orders[c][k]] = wide(places[first + k]);
    }
    const auto is_held = [&](std::uint32_t point) { return fabric.positions[particle_of[point]].w == 0; };
    const cooking::Posed cloth{meshes[c], of_points, is_held};
    splits[c] = blade ? cooking::cut_by(cloth, *blade) : cooking::cracks(cloth, lists.limits[c]);
  }
  return splits;
}

// What the last look has seen becomes known.
Result<void> Simulation::State::hear_look() {
  if (!tears.has_looked) return {};
  if (tears.look > 0) {
    if (auto done = wait_for_frame(tears.look); !done) return done;
  } else {
    const VkEvent event = tears.is_seen.get();
    const auto start = std::chrono::steady_clock::now();
    for (VkResult status; (status = device->heard(device->vk().vkGetEventStatus(device->handle(), event))) != VK_EVENT_SET;) {
      if (status != VK_EVENT_RESET) return fail("a frame that looks at cloth that tears: ", compute::result_name(status));
      if (std::chrono::steady_clock::now() - start > kLongestWait)
        return fail("record: the ", kFramesALook, "rd last frame that was recorded is not done after ", kLongestWait.count(),
                    " s; of a scene with cloth that tears at most ", kFramesALook - 1, " recorded frames may be under way");
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
    if (const VkResult reset = device->vk().vkResetEvent(device->handle(), event); reset != VK_SUCCESS)
      return fail("the event of a recorded frame could not be reset: ", compute::result_name(reset));
  }
  std::vector<gpu::vec4> seen(fabric.positions.size());
  std::memcpy(seen.data(), readback[readback.size() - 1].mapped, seen.size() * sizeof(gpu::vec4));
  std::vector<Vec3> places;
  places.reserve(seen.size());
  for (const gpu::vec4& x : seen) places.push_back({x.x, x.y, x.z});
  tears.found = splits_in(places, nullptr);
  tears.has_looked = false;
  return {};
}

void Simulation::State::record_look(compute::Recorder& recorder) {
  const VkBufferCopy region{0, 0, fabric.positions.size() * sizeof(gpu::vec4)};
  const VkBuffer from = solver->buffer(buffers::positions).handle, to = readback[readback.size() - 1].handle;
  device->vk().vkCmdCopyBuffer(recorder.commands(), from, to, 1, &region);
}

// `from`: whole, or torn up to here. Nothing where the lists would not fit into their buffers. `copies`: the new particles begin where those
// are that they were one with.
Result<std::optional<Simulation::State::Torn>> Simulation::State::torn_by(std::vector<Mesh> from, std::span<const std::vector<Split>> splits,
                                                                          std::span<const gpu::Anchor> targets, bool copies) {
  Torn torn;
  std::vector<std::uint32_t> points;
  for (std::size_t c = 0; c < splits.size(); ++c) {
    points.push_back(static_cast<std::uint32_t>(from[c].points.size()));
    const auto applied = splits[c].empty() ? Result<std::size_t>(std::size_t{0}) : split_points(from[c], splits[c]);
    if (!applied) return fail("cloths[", c, "]: ", applied.why());
    torn.applied.push_back(static_cast<std::uint32_t>(*applied));
  }
  if (copies && std::ranges::count(torn.applied, 0u) == std::ssize(torn.applied)) return std::optional<Torn>();   // no spare ones are left
  auto cooked = torn_anew(scene, from, fabric);
  if (!cooked) return cooked.take_error();
  CookedFabric& next = torn.cooked.fabric = std::move(*cooked);
  next.notes = fabric.notes;
  if (scene.pins > 0) next = held_anew(scene, from, next, are_held(targets));
  if (!solver->fits(cooked_of(scene, next))) return std::optional<Torn>();
  torn.meshes = std::move(from);

  std::vector<Edit>& edits = torn.cooked.edits;
  for (std::size_t c = 0; copies && c < splits.size(); ++c) {
    const std::vector<std::uint32_t>& order = std::as_const(next.own).of<TearLists>().orders[c];
    const std::uint32_t first = next.cloths[c].first_particle;
    for (std::uint32_t k = 0; k < torn.applied[c]; ++k) {
      const auto particle_of = [&](std::uint32_t point) {
        return first + static_cast<std::uint64_t>(std::ranges::find(order, point) - order.begin());
      };
      const std::uint64_t from_particle = particle_of(splits[c][k].point), to_particle = particle_of(points[c] + k);
      for (const Plan::PlannedBuffer& planned : solver->plan().buffers) {
        const Buffer& row = *planned.row;
        const bool is_iterate = &row == &buffers::predicted || &row == &buffers::next_iterate;
        if (row.length == lengths::particles && (row.lifetime == Lifetime::persistent || is_iterate))
          edits.push_back(copy_of(row, from_particle, to_particle));
      }
    }
  }
  add_changes(next, edits, true);
  if (copies && solver->has(buffers::detection))
    edits.push_back(edit_of(buffers::detection, offsetof(gpu::Detection, needs_detection), std::uint32_t(1)));
  holds.edits.reserve(holds.edits.size() + edits.size());
  return std::optional<Torn>(std::move(torn));
}

// A hand goes on holding the triangle that it holds.
void Simulation::State::grabs_follow(const CookedFabric& torn) {
  for (auto& grab : grabs.held) {
    if (!grab) continue;
    const Triangle held{grab->particles[0], grab->particles[1], grab->particles[2]};
    const auto at = std::ranges::find(fabric.triangles, held);
    if (at == fabric.triangles.end()) continue;
    const Triangle& now = torn.triangles[static_cast<std::size_t>(at - fabric.triangles.begin())];
    for (std::size_t k = 0; k < 3; ++k) grab->particles[k] = now[k];
  }
}

void Simulation::State::take(Torn torn) {
  solver->follow(cooked_of(scene, torn.cooked.fabric));
  grabs_follow(torn.cooked.fabric);
  meshes = std::move(torn.meshes);
  take(std::move(torn.cooked));
  holds.are_new = true;
}

// Returns how many points have become two.
Result<std::uint32_t> Simulation::State::tear(std::span<const std::vector<Split>> splits) {
  std::size_t wanted = 0;
  for (const auto& of_cloth : splits) wanted += of_cloth.size();
  if (wanted == 0) return 0u;
  auto torn = torn_by(meshes, splits, kinematic.targets, true);
  if (!torn) return torn.take_error();
  std::uint32_t applied = 0;
  if (*torn) {
    for (std::size_t c = 0; c < splits.size(); ++c) {
      const std::uint32_t count = (*torn)->applied[c];
      tears.done[c].insert(tears.done[c].end(), splits[c].begin(), splits[c].begin() + count);
      applied += count;
    }
    take(std::move(**torn));
  }
  tears.refused += applied < wanted;
  return applied;
}

Result<void> Simulation::State::follow_tears() {
  if (tears.whole.empty()) return {};
  // A frame that tears does not look: the cloth has had no time to let go yet.
  tears.looks = false;
  if (tears.frames % kFramesALook == 0) {
    if (auto heard = hear_look(); !heard) return heard;
    auto torn = tear(tears.found);
    if (!torn) return torn.take_error();
    for (auto& splits : tears.found) splits.clear();
    tears.looks = *torn == 0;
  }
  ++tears.frames;
  return {};
}

// Now, instead of in the next frame. Nothing is under way.
Result<void> Simulation::State::send_edits() {
  if (holds.edits.empty()) return {};
  auto done = compute::run_once(*device, "weft edits", [&](VkCommandBuffer commands) {
    using compute::Use;
    compute::Recorder recorder(*device, commands);
    recorder.barrier(Use::compute | Use::transfer, Use::transfer);
    solver->record_edits(recorder, holds.edits);
    recorder.barrier(Use::transfer, Use::compute | Use::transfer);
    recorder.finish();
  });
  if (done) holds.edits.clear();
  return done;
}

Result<std::uint32_t> Simulation::cut(Vec3 origin, Vec3 a, Vec3 b) try {
  State& s = *state_;
  if (s.tears.whole.empty()) return fail("the scene has no cloth that tears (its key \"tear\"), and none that can be cut");
  for (const Vec3 v : {origin, a, b})
    if (!is_finite(v)) return fail("the blade is not finite, or ", kTooLarge, " m away or more");
  const cooking::Blade blade{wide(origin - s.origin), wide(a).normalized(), wide(b).normalized()};
  if (!(blade.a.cross(blade.b).norm() > 1e-9)) return fail("the blade's two directions are one, or of length 0");
  if (auto ready = s.ready_to_cut(); !ready) return ready.take_error();
  auto places = s.places_of_particles();
  if (!places) return places.take_error();
  return s.tear_now(s.splits_in(*places, &blade));
} catch (...) {
  return caught("the cut");
}

Result<std::uint32_t> Simulation::split(std::uint32_t cloth, std::span<const Split> splits) try {
  State& s = *state_;
  if (cloth >= s.scene.cloths.size() || !s.scene.cloths[cloth].tear)
    return fail("cloth ", cloth, " does not tear (its key \"tear\"), or is none of the scene's ", s.scene.cloths.size());
  if (auto ready = s.ready_to_cut(); !ready) return ready.take_error();
  std::vector<std::vector<Split>> all(s.scene.cloths.size());
  all[cloth].assign(splits.begin(), splits.end());
  return s.tear_now(all);
} catch (...) {
  return caught("the splits");
}

std::span<const Split> Simulation::splits_of(std::uint32_t cloth) const {
  return cloth < state_->tears.done.size() ? std::span<const Split>(state_->tears.done[cloth]) : std::span<const Split>();
}

// What is torn, and on its way to the GPU, is there then. What was seen before the cut is of another cloth.
Result<void> Simulation::State::ready_to_cut() {
  if (auto done = wait(); !done) return done;
  if (auto done = put_frame_back(); !done) return done;
  follow_holds();
  if (auto done = send_edits(); !done) return done;
  if (auto heard = hear_look(); !heard) return heard;
  for (auto& splits : tears.found) splits.clear();
  return {};
}

Result<std::uint32_t> Simulation::State::tear_now(std::span<const std::vector<Split>> splits) {
  auto count = tear(splits);
  if (!count) return count;
  if (auto done = send_edits(); !done) return done.take_error();
  if (auto drawn = draw_surface(); !drawn) return drawn.take_error();
  return count;
}

std::uint32_t Simulation::splits() const { return state_->split_count(); }

// Of a snapshot's splits, in its order, those of each cloth: done, or found and due. Errors: a cloth that does not tear.
static Result<std::vector<std::vector<Split>>> saved_splits(const Snapshot& snapshot, const Scene& scene, bool found) {
  std::vector<std::vector<Split>> splits(scene.cloths.size());
  for (const Snapshot::SplitState& state : snapshot.splits) {
    if (state.cloth >= splits.size() || !scene.cloths[state.cloth].tear)
      return fail("it has a split of cloth ", state.cloth, ", which does not tear");
    if (state.is_found == found) splits[state.cloth].push_back({state.point, state.corners});
  }
  return splits;
}

void Simulation::State::save_tears(Snapshot& snapshot) const {
  snapshot.tear_frames = tears.frames;
  snapshot.splits_refused = tears.refused;
  for (const bool found : {false, true})
    for (std::uint32_t c = 0; c < tears.done.size(); ++c)
      for (const Split& split : (found ? tears.found : tears.done)[c]) snapshot.splits.push_back({c, found, split.point, split.corners});
}

// Nothing where the cloth is torn so already.
Result<std::optional<Simulation::State::Torn>> Simulation::State::torn_of(const Snapshot& snapshot, std::span<const gpu::Anchor> targets) {
  if (tears.whole.empty()) {
    if (!snapshot.splits.empty()) return fail("it has splits, and no cloth of the scene tears");
    return std::optional<Torn>();
  }
  auto done = saved_splits(snapshot, scene, false), found = saved_splits(snapshot, scene, true);
  if (!done) return done.take_error();
  if (!found) return found.take_error();
  std::optional<Torn> torn;
  if (*done != tears.done) {
    auto made = torn_by(tears.whole, *done, targets, false);
    if (!made) return made.take_error();
    if (!*made) return fail("its torn cloth does not fit into this scene's buffers");
    torn = std::move(*made);
  }
  for (std::size_t c = 0; c < scene.cloths.size(); ++c) {
    if (torn && torn->applied[c] != (*done)[c].size()) return fail("cloth ", c, " has more splits than spare vertices");
    Mesh trial = torn ? torn->meshes[c] : meshes[c];
    if (const auto good = split_points(trial, (*found)[c]); !good) return fail("cloth ", c, ": ", good.why());
  }
  return torn;
}

// After take(): the rest, without a need for memory but for the lists of splits.
void Simulation::State::put_tears_back(const Snapshot& snapshot) {
  if (tears.whole.empty()) return;
  tears.done = *saved_splits(snapshot, scene, false);
  tears.found = *saved_splits(snapshot, scene, true);
  tears.frames = snapshot.tear_frames;
  tears.refused = snapshot.splits_refused;
  if (std::exchange(tears.has_looked, false) && tears.look == 0) (void)device->vk().vkResetEvent(device->handle(), tears.is_seen.get());
  tears.looks = false;
}

}  // namespace weft
