// Creating a simulation, setting targets, and asking it for figures.
#include "engine/simulation.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/reference/choice.h"
#include "engine/scene/origin.h"
#include "engine/solve/sanitize.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

constexpr double kMostDispatches = 4e6;   // of an advance: about 400 MB of steps and commands
constexpr float kLongestLink = 4e9f;      // m: a packed link holds no longer ones (packed.h)

}  // namespace

Simulation::Simulation(std::unique_ptr<State> state) : state_(std::move(state)) {}

Simulation::~Simulation() {
  // Frames that Weft submitted must be done before their buffers go; a host that recorded frames waits for them itself.
  if (!state_ || state_->queue.submitted == 0) return;
  try {
    (void)state_->wait();
  } catch (const std::bad_alloc&) {   // it failed, and there is no memory to say so
  }
  state_->device->wait_idle();   // the software driver (Mesa 22.3) looks at semaphores for a moment after they are signalled
}

Result<std::unique_ptr<Simulation>> Simulation::create(const compute::Device& device, const Scene& scene,
                                                       const SimulationOptions& options) try {
  if (const auto good = check(scene); !good) return good.why();
  auto near = recentred(scene);
  if (!near) return near.take_error();
  return create_at(device, scene, near->origin, std::move(near->meshes), options);
} catch (...) {
  return caught("the simulation");
}

Result<std::unique_ptr<Simulation>> Simulation::create(const compute::Device& device, const Scene& scene, std::vector<Mesh> meshes,
                                                       const SimulationOptions& options) try {
  if (const auto good = check(scene); !good) return good.why();
  const std::size_t cloths = scene.cloths.size(), colliders = mesh_colliders(scene).size();
  const Vec3 origin = origin_near(std::span(meshes).first(std::min(meshes.size(), cloths)));
  if (origin != Vec3{})
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      if (k >= cloths && k < cloths + colliders) continue;   // these have axes of their own
      Mesh& mesh = meshes[k];
      for (Vec3& p : mesh.points) p = p - origin;
      for (Vec3& p : mesh.render.positions) p = p - origin;
      for (Vec3& p : mesh.loose) p = p - origin;
      if (mesh.skin) mesh.skin->place.origin = mesh.skin->place.origin - origin;
    }
  return create_at(device, scene, origin, std::move(meshes), options);
} catch (...) {
  return caught("the simulation");
}

// `meshes` are relative to the origin, the scene is not.
Result<std::unique_ptr<Simulation>> Simulation::create_at(const compute::Device& device, const Scene& given, Vec3 origin,
                                                          std::vector<Mesh> meshes, const SimulationOptions& options) {
  if (options.readers)
    if (auto good = compute::check_readers(device, *options.readers); !good) return good.take_error();
  if (auto good = compute::check_usage(device, options.vertex_usage); !good) return good.take_error();
  const Scene described = origin == Vec3{} ? given : relative_to(given, origin);
  std::string chosen_by;
  std::uint64_t points = 0;
  for (std::size_t k = 0; k < std::min(described.cloths.size(), meshes.size()); ++k) points += meshes[k].points.size();
  const auto chosen = with_choice(described, points, options.curve ? *options.curve : builtin_curve(), chosen_by);
  if (!chosen) return fail(chosen.why());
  const Scene& scene = *chosen;
  auto state = std::make_unique<State>();
  state->device = &device;
  state->scene = scene;
  state->described = given;
  state->described.solver = scene.solver;   // with what was chosen for "auto"
  state->origin = origin;
  state->options = options;
  state->gravity = scene.gravity;
  if (scene.air) state->moving_air = {scene.air->wind, state->scene.air->fields, {}};
  add_spares(scene, meshes);
  auto fabric = cook(scene, meshes);
  if (!fabric) return fabric.take_error();
  state->fabric = std::move(*fabric);
  for (const gpu::vec4& x : state->fabric.positions)
    if (!is_finite(x))
      return fail("a particle would start at (", x.x, ", ", x.y, ", ", x.z, "), which is not finite, or ", kTooLarge, " m away or more");
  for (const StretchLink& link : state->fabric.links)
    if (!(link.rest < kLongestLink)) return fail("a link is ", kLongestLink, " m long or longer: scale the mesh down");
  if (!chosen_by.empty()) state->fabric.notes.push_back(chosen_by);
  state->meshes = std::move(meshes);
  auto cache = compute::PipelineCache::create(device, options.pipeline_cache);
  if (!cache) return cache.take_error();
  state->cache = std::move(*cache);
  auto solver = Solver::create(device, state->cache, scene, state->fabric,
                               {options.gather_storage, options.workgroup, origin, options.vertex_usage, options.idle_costs});
  if (!solver) return solver.take_error();
  state->solver = std::move(*solver);
  for (const Plan::PlannedBuffer& planned : state->solver->plan().buffers)
    if (planned.row->lifetime == Lifetime::persistent) state->rollback.rows.push_back(planned.row);
  // A cache that cannot be written only makes the next start slower: a note, no error.
  if (!options.pipeline_cache.empty())
    if (auto saved = state->cache.save(); !saved) state->fabric.notes.push_back(saved.error());

  std::vector<compute::BufferRequest> reports;
  for (std::size_t place = 0; place < state->place_of_event(state->recorded.done.size()); ++place) {
    reports.push_back({"counters readback", sizeof(gpu::Counters), VK_BUFFER_USAGE_TRANSFER_DST_BIT});
    reports.push_back({"detection readback", sizeof(gpu::Detection), VK_BUFFER_USAGE_TRANSFER_DST_BIT});
    if (state->solver->has(buffers::reactions))
      reports.push_back({"reactions readback", state->solver->used_bytes(buffers::reactions), VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  }
  if (tears(scene))   // the last
    reports.push_back({"positions readback", state->fabric.positions.size() * sizeof(gpu::vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  auto readback = compute::Arena::create(device, compute::Memory::readback, "weft readback", reports);
  if (!readback) return readback.take_error();
  state->readback = std::move(*readback);
  for (const compute::Buffer& report : state->readback.buffers()) std::fill_n(report.mapped, report.bytes, std::byte{0});
  if (state->solver->has(buffers::candidates))
    if (auto made = state->create_saved(); !made) return made.take_error();
  // One advance records all of its dispatches at once.
  const double most_substeps = std::max(scene.solver.longest_advance, 1 / scene.solver.rate) / state->fabric.h + 1;
  const double dispatches = state->dispatches_of(most_substeps);
  if (dispatches > kMostDispatches)
    return fail("solver: the longest advance of ", scene.solver.longest_advance, " s takes about ", dispatches, " dispatches, more than ",
                kMostDispatches, "; take fewer substeps or iterations, or a shorter longest_advance");
  auto pool = compute::CommandPool::create(device, "weft");
  if (!pool) return pool.take_error();
  state->queue.pool = std::move(*pool);
  if (state->solver->has(buffers::candidates) || state->solver->has(buffers::reactions))
    for (compute::OwnedEvent& event : state->recorded.done) {
      auto made = compute::create_event(device, "weft recorded");
      if (!made) return made.take_error();
      event = std::move(*made);
    }
  if (device.features().timeline_semaphore) {
    auto ready = compute::create_timeline(device, "weft ready");
    if (!ready) return ready.take_error();
    state->queue.ready = std::move(*ready);
  }
  for (FrameSlot& slot : state->queue.slots) {
    auto commands = state->queue.pool.allocate("weft frame");
    if (!commands) return commands.take_error();
    slot.commands = *commands;
    if (!state->queue.ready) {
      auto fence = compute::create_fence(device, "weft frame");
      if (!fence) return fence.take_error();
      slot.done = std::move(*fence);
    }
    if (!options.timings) continue;
    auto timestamps = compute::Timestamps::create(device, "weft frame", static_cast<std::uint32_t>(std::min(dispatches, 60000.0)));
    if (!timestamps) return timestamps.take_error();
    slot.timestamps = std::move(*timestamps);
  }
  if (state->timed_on_cpu())
    if (auto made = state->create_saved(); !made) return made.take_error();

  state->kinematic.targets = anchors_at_rest(state->fabric, scene.pins);
  for (const AnchorTarget& anchor : state->fabric.anchors)
    state->kinematic.are_keyed |= !scene.cloths[anchor.cloth].anchors[anchor.entry].keys.empty();
  for (const ColliderMesh& mesh : state->fabric.collider_meshes) state->kinematic.are_keyed |= !scene.colliders[mesh.collider].keys.empty();
  state->kinematic.links = mean_links(state->fabric);
  for (std::size_t k = 0; k < scene.cloths.size(); ++k)
    if (const auto& inertia = scene.cloths[k].inertia) {   // what is not felt of their motion its frame carries along with them
      const double felt = std::min({inertia->linear, inertia->angular, inertia->centrifugal});
      state->kinematic.links[k] = felt > 0 ? static_cast<float>(state->kinematic.links[k] / felt) : 0;
    }
  state->kinematic.pending.resize(state->fabric.anchors.size() + scene.pins);
  state->kinematic.is_host_driven.resize(state->fabric.anchors.size() + scene.pins);
  state->skins.pose = std::as_const(state->fabric.own).of<SkinLists>().first_pose;
  state->skins.pending.resize(state->skinned_meshes().size());
  state->skins.is_host_driven.resize(state->skinned_meshes().size());
  state->skins.joints.reserve(state->skins.pose.size());   // a frame that has begun to move them needs no memory
  state->skins.weights = std::as_const(state->fabric.own).of<SkinLists>().first_weights;
  state->skins.pending_weights.resize(state->skinned_meshes().size());
  state->skins.has_host_weights.resize(state->skinned_meshes().size());
  state->skins.morph_weights.reserve(state->skins.weights.size());
  state->skins.pending_targets.resize(state->skinned_meshes().size());
  state->skins.are_kept.resize(state->skinned_meshes().size());
  state->skins.sources.reserve(state->skinned_meshes().size());
  state->skins.copies.reserve(2 * state->skinned_meshes().size());
  state->skins.limits = motion_limits_of(scene);
  if (state->solver->has(buffers::frame_changes)) {
    state->frames.at.resize(scene.cloths.size());
    state->frames.motion.resize(scene.cloths.size());
    state->frames.pending.resize(scene.cloths.size());
    state->frames.is_host_driven.resize(scene.cloths.size());
    state->frames.changes.resize(scene.cloths.size());
    for (std::size_t k = 0; k < scene.cloths.size(); ++k)
      if (const auto& joints = std::as_const(state->fabric.own).of<InertiaLists>().joints; joints[k] != kNone)
        state->frames.at[k] = state->frame_of_joint(k, state->skins.pose);
  }
  state->gas_amounts.resize(scene.cloths.size(), 1);
  state->grabs.corners.resize(3 * scene.grabs, gpu::Grab{WEFT_NONE, 0, 0, 0, 0, {}, {}});
  state->grabs.held.resize(scene.grabs);
  if (auto made = state->make_tears(); !made) return made.take_error();
  if (scene.pins > 0) (void)state->own_digest();   // of the cloth as it is described, whoever is held later
  const std::size_t colliders = scene.colliders.size();
  state->bodies.pending.resize(colliders);
  state->bodies.is_host_driven.resize(colliders);
  state->bodies.pending_sizes.resize(colliders);
  for (const Collider& collider : scene.colliders) {
    const Key key = pose_at(collider.keys, 0);
    state->bodies.poses.push_back(keyed_pose(collider, key));
    state->bodies.keys.push_back(key);
    state->bodies.sizes.push_back(size_of(collider));
  }
  for (const auto& [collider, joint] : std::as_const(state->fabric.own).of<SkinLists>().bones)
    state->bodies.poses[collider] = carried_pose(scene.colliders[collider], state->skins.pose[joint]);
  state->bodies.order = colliders_by_shape(scene);
  state->bodies.colliders.reserve(colliders);   // a frame that has begun to move them needs no memory
  state->bodies.from_sizes.reserve(state->bodies.order.size());
  state->bodies.in_world.reserve(colliders);
  if (scene.reactions) {
    state->reactions.quantum = reaction_quantum(state->fabric);
    state->bodies.meshes.resize(state->fabric.collider_meshes.size());
    state->reactions.between.resize(colliders);
    state->reactions.pulls.resize(scene.grabs);
    for (auto* sums : {&state->reactions.heard, &state->reactions.known, &state->reactions.told})
      sums->resize(colliders + scene.grabs);
  }
  std::unique_ptr<Simulation> simulation(new Simulation(std::move(state)));
  // The surface is drawable before the first frame.
  if (auto drawn = simulation->state_->draw_surface(); !drawn) return drawn.take_error();
  return simulation;
}

FrameView Simulation::positions() const {
  const compute::Buffer& buffer = state_->solver->buffer(buffers::vertex_positions);
  return {buffer.handle, 0, sizeof(gpu::vec4), VK_FORMAT_R32G32B32A32_SFLOAT,
          drawn_vertices(state_->fabric), buffer.usage};
}

FrameView Simulation::normals() const {
  const compute::Buffer& buffer = state_->solver->buffer(buffers::vertex_normals);
  FrameView view = positions();
  view.buffer = buffer.handle;
  view.usage = buffer.usage;
  return view;
}

Result<void> Simulation::move_anchors(std::uint32_t first, std::span<const Vec3> targets) try {
  const std::size_t anchors = state_->fabric.anchors.size();
  if (first > anchors || targets.size() > anchors - first)
    return fail("anchors ", first, " to ", first + targets.size(), " (exclusive) are beyond the simulation's ", anchors);
  for (std::size_t k = 0; k < targets.size(); ++k)
    if (!is_finite(targets[k])) return fail("the target of anchor ", first + k, " is not finite, or ", kTooLarge, " m away or more");
  for (std::size_t k = 0; k < targets.size(); ++k)
    if (state_->held_by(first + k) == WEFT_NONE) return fail("anchor ", first + k, " was released: it has no target");
  for (std::size_t k = 0; k < targets.size(); ++k) {
    state_->kinematic.pending[first + k] = targets[k] - state_->origin;
    state_->kinematic.is_host_driven[first + k] = true;
  }
  return {};
} catch (...) {
  return caught("the anchors");
}

Result<void> Simulation::set_gravity(Vec3 gravity) try {
  if (!is_finite(gravity)) return fail("the gravity is not finite, or ", kTooLarge, " m/s^2 or more");
  state_->gravity = gravity;
  return {};
} catch (...) {
  return caught("the gravity");
}

static bool is_wind(Vec3 v) {
  return is_finite(v) && std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) <= kFastestWind;
}

Result<void> Simulation::set_wind(Vec3 wind) try {
  if (!state_->scene.air) return fail("the scene has no air (its key \"air\") for a wind to blow in");
  if (!is_wind(wind)) return fail("the wind is not finite, or above ", kFastestWind, " m/s along an axis");
  state_->moving_air.wind = wind;
  return {};
} catch (...) {
  return caught("the wind");
}

Result<void> Simulation::move_air_field(std::uint32_t field, Vec3 centre, Vec3 velocity) try {
  std::vector<Air::Field>& fields = state_->moving_air.fields;
  if (field >= fields.size()) return fail("there is no field ", field, " of the air, the scene has ", fields.size());
  if (!is_finite(centre) || !is_wind(velocity))
    return fail("field ", field, " of the air: its place is not finite, or its velocity not, or above ", kFastestWind, " m/s along an axis");
  fields[field].centre = centre - state_->origin;
  fields[field].velocity = velocity;
  return {};
} catch (...) {
  return caught("the field of the air");
}

VkSemaphore Simulation::ready_semaphore() const { return state_->queue.ready.get(); }
std::uint64_t Simulation::ready_value() const { return state_->queue.submitted; }
double Simulation::time() const { return state_->now(); }
Vec3 Simulation::origin() const { return state_->origin; }
const Scene& Simulation::scene() const { return state_->described; }
const std::vector<Mesh>& Simulation::meshes() const { return state_->meshes; }
const CookedFabric& Simulation::fabric() const { return state_->fabric; }
const compute::Device& Simulation::device() const { return *state_->device; }

double Simulation::State::dispatches_of(double substeps) const {
  const FrameShape shape = shape_of(scene);
  double sum = 0;
  for (std::size_t k = 0; k < solver->plan().passes.size(); ++k) {
    const Stage stage = solver->plan().passes[k].pass->stage;
    const double once = runs_of(stage, shape, 0), a_substep = runs_of(stage, shape, 1) - once;
    sum += static_cast<double>(solver->rounds(k)) * solver->sweeps(k, 1) * (once + substeps * a_substep);
  }
  return sum;
}

std::vector<PassUse> Simulation::passes() const try {
  const State& s = *state_;
  // More than the scene's where springs need shorter ones.
  const auto substeps = static_cast<std::uint32_t>(std::lround(1 / (s.scene.solver.rate * s.fabric.h)));
  std::vector<PassUse> uses;
  for (std::size_t k = 0; k < s.solver->plan().passes.size(); ++k) {
    const PlannedPass& planned = s.solver->plan().passes[k];
    const bool idle = planned.pass->only_towards_targets && !s.kinematic.are_keyed && s.scene.pins == 0 && !s.solver->has(buffers::detection);
    auto runs = static_cast<std::uint32_t>(idle ? 0 : runs_of(planned.pass->stage, shape_of(s.scene), substeps));
    if (planned.pass->every != nullptr) {
      const std::uint32_t every = planned.pass->every(cooked_of(s.scene, s.fabric));
      runs = (runs + every - 1) / every;
    }
    uses.push_back({planned.label, runs * static_cast<std::uint32_t>(s.solver->rounds(k)),
                    static_cast<std::uint32_t>(compute::instructions_of(planned.spirv))});
  }
  return uses;
} catch (const std::bad_alloc&) {
  return {};
}

std::vector<BufferUse> Simulation::buffers() const try {
  std::vector<BufferUse> uses;
  for (const compute::Buffer* buffer : state_->solver->buffers()) uses.push_back({buffer->name, buffer->bytes});
  return uses;
} catch (const std::bad_alloc&) {
  return {};
}

Counts Simulation::counts() const {
  const auto place = state_->newest_place();
  const Report report = place ? state_->reported(*place) : state_->heard;
  const gpu::Counters& counters = report.counters;
  return {counters.non_finite, counters.coincident, counters.contacts_most, counters.contacts_overflowed,
          counters.contacts_room, counters.truncated,
          counters.detections, report.detection.crossings, counters.crossings_most, state_->split_count(), state_->tears.refused, std::bit_cast<float>(counters.tracking_error), counters.unconverged, counters.stopped,
          counters.residual, counters.unaccelerated};
}

}  // namespace weft
