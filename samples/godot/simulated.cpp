// See samples/godot/simulated.h.
#include "samples/godot/simulated.h"

#include <algorithm>
#include <atomic>
#include <deque>

#include "samples/godot/skin.h"

namespace weft_godot {
namespace {

using weft::ColliderPose;
using weft::fail;
using weft::Key;
using weft::Result;
using weft::Vec3;

std::atomic<int> simulations = 0;

// One device for all of them. The render thread's.
std::unique_ptr<weft::compute::Device>& device() {
  static std::unique_ptr<weft::compute::Device> borrowed;
  return borrowed;
}

// What is given up is still Godot's texture until the main thread has given it the next one, and may be drawn with in the frames that are
// under way, three at most.
constexpr int kWait = 8, kForgotten = 4;   // frames
struct GivenUp {
  std::unique_ptr<VertexTexture> texture;
  int frames = kWait;
};
std::deque<GivenUp>& given_up() {
  static std::deque<GivenUp> waiting;
  return waiting;
}

// What a key of the scene's does to a collider, to the bit.
ColliderPose pose_of(const weft::Collider& collider, const Key& key) {
  const weft::Rotation rotation = weft::rotation_about(key.axis, key.degrees);
  return {collider.centre + key.translate, weft::rotated(rotation, collider.normal), rotation * weft::rest_rotation(collider)};
}

std::vector<std::vector<Vec3>> centres_of(const weft::Simulation& simulation) {
  std::vector<std::vector<Vec3>> sums;
  std::vector<std::vector<int>> counts;
  for (const weft::Cloth& cloth : simulation.scene().cloths)
    sums.emplace_back(cloth.anchors.size()), counts.emplace_back(cloth.anchors.size());
  for (const weft::AnchorTarget& held : simulation.fabric().anchors)
    sums[held.cloth][held.entry] = sums[held.cloth][held.entry] + held.rest, ++counts[held.cloth][held.entry];
  for (std::size_t c = 0; c < sums.size(); ++c)
    for (std::size_t a = 0; a < sums[c].size(); ++a)
      if (counts[c][a] > 0) sums[c][a] = (1.0f / float(counts[c][a])) * sums[c][a] + simulation.origin();
  return sums;
}

}  // namespace

struct Simulated::Running {
  std::unique_ptr<weft::Simulation> simulation;
  std::unique_ptr<VertexTexture> texture;
  std::unique_ptr<Bounds> bounds;
  std::unique_ptr<Commands> commands;   // waits, so it goes first
  std::unique_ptr<Recording> recording;
  weft::Scene keyed;                              // with a single key each: where anchors are in this tick
  std::vector<std::vector<Vec3>> centres;         // of each cloth's anchors, in the world
  std::vector<std::optional<weft::Skin>> skins;   // of each cloth, in the world
  Hands hands;
  std::uint32_t splits = 0;                                   // that were looked at
  std::uint64_t ticks = 1;                                    // the start is the first
  std::array<std::uint64_t, Commands::kUnderWay> tick_of{};   // each place's

  Running() { ++simulations; }
  ~Running() {
    commands.reset();
    bounds.reset();
    if (texture) given_up().push_back({std::move(texture)});
    simulation.reset();
    --simulations;
  }
};

Simulated::Simulated() = default;
Simulated::~Simulated() = default;

int Simulated::alive() { return simulations; }

Seen Simulated::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

void Simulated::fail_with(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  seen_.failure = sentence;
  seen_.is_running = false;
}

void Simulated::make(Setup setup) {
  {
    const std::lock_guard lock(mutex_);
    seen_.setup = setup.number;
    seen_.is_running = false;
    seen_.failure.clear();
  }
  if (auto made = try_make(setup); !made) fail_with(made.error());
}

Result<void> Simulated::try_make(Setup& setup) {
  if (!device()) {
    auto borrowed = borrow_device();
    if (!borrowed) return borrowed.take_error();
    device() = std::move(*borrowed);
  }
  auto next = std::make_unique<Running>();
  next->keyed = setup.scene;
  for (std::size_t c = 0; c < setup.scene.cloths.size(); ++c) next->skins.push_back(setup.meshes[c].skin);
  std::vector<weft::Mesh> to_record = setup.recording.empty() ? std::vector<weft::Mesh>() : setup.meshes;
  weft::SimulationOptions options;   // Godot's shaders read a copy
  options.readers = {VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                     VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
  auto simulation = weft::Simulation::create(*device(), setup.scene, std::move(setup.meshes), options);
  if (!simulation) return simulation.take_error();
  next->simulation = std::move(*simulation);
  next->centres = centres_of(*next->simulation);
  if (!setup.recording.empty()) next->recording = std::make_unique<Recording>(setup.recording, *next->simulation, std::move(to_record));

  if (running_) {   // what goes on does so from where it is
    running_->commands->wait();
    if (auto done = carry(*running_->simulation, *next->simulation, setup.carried); !done) return done;
    if (auto done = next->hands.carry(running_->hands, *next->simulation, setup.carried); !done) return done;
    if (next->recording) next->recording->spoil("a cloth or a collider came or went");
    end();
  }
  auto texture = VertexTexture::create(*next->simulation);
  if (!texture) return texture.take_error();
  next->texture = std::move(*texture);
  auto bounds = Bounds::create(*next->simulation);
  if (!bounds) return bounds.take_error();
  next->bounds = std::move(*bounds);
  auto commands = Commands::create(*device());
  if (!commands) return commands.take_error();
  next->commands = std::move(*commands);
  const auto begun = next->commands->begin();
  if (!begun) return begun.why();
  next->texture->record(begun->commands, 0);
  next->bounds->record(begun->commands, begun->place);
  if (auto done = next->commands->submit(); !done) return done;
  next->tick_of[begun->place] = next->ticks;
  running_ = std::move(next);

  {
    const std::lock_guard lock(mutex_);
    seen_ = {};
    seen_.setup = setup.number;
    seen_.is_running = true;
    seen_.texture = running_->texture->rid();
    for (const weft::ClothRange& cloth : running_->simulation->fabric().cloths) seen_.first_vertices.push_back(cloth.first_vertex);
  }
  look_at_tears();
  return {};
}

// Positions are relative to the simulations' origins; a cloth has its particles in the same order in both, and is torn alike.
Result<void> Simulated::carry(const weft::Simulation& from, weft::Simulation& to, std::span<const std::optional<std::uint32_t>> carried) {
  for (std::uint32_t c = 0; c < carried.size(); ++c)
    if (carried[c] && !from.splits_of(*carried[c]).empty() && to.scene().cloths[c].tear)
      if (auto split = to.split(c, from.splits_of(*carried[c])); !split) return split.take_error();
  const auto positions = from.read_positions(), velocities = from.read_velocities();
  auto next = to.read_positions(), next_velocities = to.read_velocities();
  if (!positions || !velocities || !next || !next_velocities) return fail("the cloth's state cannot be read back");
  const Vec3 shift = from.origin() - to.origin();
  for (std::size_t c = 0; c < carried.size(); ++c) {
    if (!carried[c]) continue;
    const weft::ClothRange &a = from.fabric().cloths[*carried[c]], &b = to.fabric().cloths[c];
    if (a.particles != b.particles) continue;
    for (std::uint32_t k = 0; k < a.particles; ++k) {
      auto& at = (*next)[b.first_particle + k];
      const auto& was = (*positions)[a.first_particle + k];
      at.x = was.x + shift.x, at.y = was.y + shift.y, at.z = was.z + shift.z;
      (*next_velocities)[b.first_particle + k] = (*velocities)[a.first_particle + k];
    }
  }
  if (auto done = to.write_positions(*next); !done) return done;
  return to.write_velocities(*next_velocities);
}

void Simulated::tick(const Tick& tick) {
  if (!running_) return;
  look_at_bounds();
  if (auto done = try_tick(tick); !done) {
    fail_with(done.error());
    end();
  }
}

Result<void> Simulated::move(const Tick& tick) {
  weft::Simulation& simulation = *running_->simulation;
  for (std::uint32_t k = 0; k < tick.colliders.size(); ++k) {
    if (!tick.colliders[k]) continue;
    const ColliderPose pose = pose_of(simulation.scene().colliders[k], *tick.colliders[k]);
    const bool at_once = std::ranges::find(tick.placed, k) != tick.placed.end();
    if (at_once) running_->commands->wait();
    if (at_once) spoil("a collider was put elsewhere at once");
    if (auto done = at_once ? simulation.place_collider(k, pose) : simulation.move_collider(k, pose); !done) return done;
  }
  for (const auto& [k, size] : tick.resized) {
    if (auto done = simulation.resize_collider(k, size); !done) return done;
    spoil("a collider changed its size");
  }
  act(tick.hands);
  if (auto done = move_anchors(tick); !done) return done;
  if (auto done = move_cloths(tick); !done) return done;
  return move_air(tick);
}

// What a script asks for and cannot have is said, and stops nothing.
void Simulated::act(std::span<const Hand> hands) {
  for (const Hand& hand : hands) {
    if (auto done = running_->hands.act(*running_->simulation, hand); !done) godot::print_warning("Weft: " + done.error());
    spoil("hands held cloth");
  }
}

Result<void> Simulated::move_cloths(const Tick& tick) {
  weft::Simulation& simulation = *running_->simulation;
  for (std::uint32_t c = 0; c < tick.cloths.size(); ++c) {
    const ClothTick& cloth = tick.cloths[c];
    if (!cloth.bones.empty() && running_->skins[c]) {
      set_keys(*running_->skins[c], cloth.bones);
      if (auto done = simulation.set_pose(c, weft::joints_at(*running_->skins[c], 0, 0)); !done) return done;
    }
    if (cloth.gas) {
      if (auto done = simulation.inflate(c, *cloth.gas); !done) return done;
      spoil("a gas was let in or out");
    }
    if (cloth.motion) {
      if (auto done = simulation.limit_motion(c, cloth.motion->scale, cloth.motion->stiffness); !done) return done;
      spoil("motion constraints were changed");
    }
  }
  return {};
}

Result<void> Simulated::move_air(const Tick& tick) {
  for (const auto& [k, field] : tick.fields) {
    if (auto done = running_->simulation->move_air_field(k, field.centre, field.velocity); !done) return done;
    spoil("a field of the air was moved");
  }
  if (!tick.wind) return {};
  spoil("the wind was changed");
  return running_->simulation->set_wind(*tick.wind);
}

void Simulated::spoil(const char* why) {
  if (running_->recording) running_->recording->spoil(why);
}

// A scene turns an anchor about the centre of its vertices.
Result<void> Simulated::move_anchors(const Tick& tick) {
  weft::Simulation& simulation = *running_->simulation;
  for (std::size_t c = 0; c < tick.cloths.size(); ++c)
    for (std::size_t a = 0; a < tick.cloths[c].anchors.size(); ++a) {
      const Placed& moved = tick.cloths[c].anchors[a];
      const Vec3 centre = running_->centres[c][a];
      std::vector<Key>& keys = running_->keyed.cloths[c].anchors[a].keys;
      if (!keys.empty()) keys[0] = key_of(moved.at + weft::rotated(moved.rotation, centre) - centre, moved.rotation, keys[0]);
    }
  std::vector<Vec3> targets = weft::anchor_targets(running_->keyed, simulation.fabric(), simulation.time());
  for (Vec3& target : targets) target = target + simulation.origin();
  // Those that go with a skin, and those that hands have, are left alone: the others come in runs.
  const std::vector<weft::AnchorTarget>& anchors = simulation.fabric().anchors;
  const auto is_ours = [&](std::size_t k) {
    return !running_->keyed.cloths[anchors[k].cloth].anchors[anchors[k].entry].keys.empty() &&
           !running_->hands.have(simulation, anchors[k]);
  };
  for (std::size_t first = 0, end = 0; first < targets.size(); first = end + 1) {
    for (end = first; end < targets.size() && is_ours(end);) ++end;
    if (end == first) continue;
    if (auto done = simulation.move_anchors(static_cast<std::uint32_t>(first), std::span(targets).subspan(first, end - first)); !done)
      return done;
  }
  return {};
}

Result<void> Simulated::try_tick(const Tick& tick) {
  if (auto done = move(tick); !done) return done;
  const auto begun = running_->commands->begin();
  if (!begun) return begun.why();
  const auto advanced = running_->simulation->record(begun->commands, tick.seconds);
  if (!advanced) return advanced.why();
  running_->texture->record(begun->commands, tick.slot);
  running_->bounds->record(begun->commands, begun->place);
  if (auto done = running_->commands->submit(); !done) return done;
  running_->tick_of[begun->place] = ++running_->ticks;
  if (running_->recording) running_->recording->add(running_->simulation->time(), tick, running_->keyed);
  look_at_tears();
  return {};
}

// Triangles have other vertices from this tick on.
void Simulated::look_at_tears() {
  const weft::Simulation& simulation = *running_->simulation;
  if (simulation.splits() == running_->splits) return;
  running_->splits = simulation.splits();
  const std::lock_guard lock(mutex_);
  seen_.torn.assign(simulation.scene().cloths.size(), nullptr);
  for (std::uint32_t c = 0; c < seen_.torn.size(); ++c)
    if (!simulation.splits_of(c).empty()) seen_.torn[c] = std::make_shared<weft::RenderMesh>(simulation.meshes()[c].render);
  seen_.torn_in_tick = running_->ticks;
}

void Simulated::look_at_bounds() {
  std::optional<std::size_t> newest;
  for (std::size_t k = 0; k < Commands::kUnderWay; ++k)
    if (running_->tick_of[k] > 0 && running_->commands->is_done(k) && (!newest || running_->tick_of[k] > running_->tick_of[*newest]))
      newest = k;
  if (!newest) return;
  const std::lock_guard lock(mutex_);
  running_->bounds->read(*newest, seen_.boxes);
  seen_.boxes_of_tick = running_->tick_of[*newest];
}

void Simulated::end() {
  if (!running_) return;
  running_->commands->wait();
  if (running_->recording)
    if (auto done = running_->recording->write(*running_->simulation); !done) godot::print_error("Weft's recording: " + done.error());
  running_.reset();
  const std::lock_guard lock(mutex_);
  seen_.is_running = false;
  seen_.texture = {};
}

Result<std::vector<Vec3>> Simulated::read_vertices(std::uint32_t cloth) {
  if (!running_) return fail("the simulation does not run");
  running_->commands->wait();
  auto all = running_->simulation->read_vertex_positions();
  if (!all) return all;
  const weft::ClothRange& range = running_->simulation->fabric().cloths[cloth];
  return std::vector<Vec3>(all->begin() + range.first_vertex, all->begin() + range.first_vertex + range.vertices);
}

Result<std::optional<Hands::Held>> Simulated::grab(Vec3 origin, Vec3 direction, const weft::Grip& grip) {
  if (!running_) return fail("the simulation does not run");
  running_->commands->wait();
  spoil("hands held cloth");
  return running_->hands.grab(*running_->simulation, origin, direction, grip);
}

Result<std::uint32_t> Simulated::cut(Vec3 origin, Vec3 a, Vec3 b) {
  if (!running_) return fail("the simulation does not run");
  running_->commands->wait();
  spoil("cloth was cut");
  return running_->simulation->cut(origin, a, b);
}

void destroy_given_up(bool all) {
  if (all && device()) device()->vk().vkQueueWaitIdle(device()->queue());
  for (GivenUp& waiting : given_up())
    if (--waiting.frames == kForgotten) waiting.texture->free_rid();
  while (!given_up().empty() && (all || given_up().front().frames <= 0)) given_up().pop_front();
  if (all) device().reset();
}

}  // namespace weft_godot
