// See samples/view/stage.h.
#include "samples/view/stage.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "samples/view/carry.h"
#include "samples/weft/files.h"
#include "samples/weft/subject.h"

namespace weft::view {
namespace {

constexpr std::uint32_t kPins = 64;   // besides those that the scene has
constexpr double kNever = 1000;       // a strain
constexpr Vec3 kAway{0, -1000, 0};    // m: where the ball is until the pointer says

std::uint32_t nearest_to(std::span<const Vec3> vertices, Vec3 point) {
  std::uint32_t nearest = 0;
  float least = std::numeric_limits<float>::max();
  for (std::uint32_t k = 0; k < vertices.size(); ++k)
    if (const float away = length(vertices[k] - point); away < least) {
      least = away;
      nearest = k;
    }
  return nearest;
}

}  // namespace

Result<std::unique_ptr<Stage>> Stage::open(const compute::Device& device, const std::filesystem::path& file,
                                           std::span<const Assignment> assignments) {
  auto scene = command::load_subject(file, assignments);
  if (!scene) return scene.take_error();
  std::unique_ptr<Stage> stage(new Stage(device));
  stage->file_ = file;
  if (auto done = stage->replace(*scene); !done) return done.take_error();
  auto snapshot = stage->simulation_->save();
  if (!snapshot) return snapshot.take_error();
  stage->start_ = Keepsake{0, 0, std::move(*snapshot), {}, {}};
  return stage;
}

// What is simulated: the scene and what the viewer adds.
Scene Stage::prepared(const Scene& scene) const {
  Scene all = scene;
  all.grabs = std::max(all.grabs, 1u);
  all.pins += kPins;
  for (Cloth& cloth : all.cloths)
    if (has_knife_ && !cloth.tear && !cloth.pressure && !cloth.skin && !cloth.motion_constraints && cloth.render_mesh.empty())
      cloth.tear = Tear{.strain = kNever};
  if (!ball_radius_) return all;
  Collider ball;
  ball.shape = ColliderShape::sphere;
  ball.radius = *ball_radius_;
  ball.centre = ball_centre_;
  ball.colour = {0.8f, 0.35f, 0.1f};
  all.colliders.push_back(std::move(ball));
  return all;
}

Result<std::unique_ptr<Simulation>> Stage::make(const Scene& prepared) const {
  SimulationOptions options;
  options.timings = times_;
  options.pipeline_cache = command::pipeline_cache();
  auto made = Simulation::create(*device_, prepared, options);
  if (!made) return made;
  // Normals are made by a frame.
  if (auto none = (*made)->advance(0); !none) return none.take_error();
  return made;
}

Result<void> Stage::replace(const Scene& scene) {
  auto made = make(prepared(scene));
  if (!made) return made.take_error();
  std::vector<Room> was_rooms, rooms;
  if (simulation_) {
    was_rooms = rooms_of(*simulation_);
    for (std::uint32_t c = 0; c < std::min(scene.cloths.size(), scene_.cloths.size()); ++c) {
      const auto torn = simulation_->splits_of(c);
      const Mesh &was = simulation_->meshes()[c], &whole = (*made)->meshes()[c];
      const bool is_same = whole.triangles.size() == was.triangles.size() && whole.points.size() + torn.size() == was.points.size();
      if (!torn.empty() && is_same) (void)(*made)->split(c, torn);   // one that may not tear now stays whole
    }
    rooms = rooms_of(**made);
    auto was = simulation_->save(), fresh = (*made)->save();
    if (!was || !fresh) return was ? fresh.take_error() : was.take_error();
    // The ball comes last: those that were there keep their numbers.
    was->colliders.resize(std::min(was->colliders.size(), scene.colliders.size()));
    const Snapshot moved = carried({std::move(*was), was_rooms, simulation_->fabric().h}, {*fresh, rooms, (*made)->fabric().h});
    if (auto done = (*made)->restore(moved); !done) {
      if (auto begun = (*made)->restore(*fresh); !begun) return begun;
    }
    renumber(was_rooms, rooms);
    if (!pinned_.empty()) (void)(*made)->pin(pinned_);         // of another mesh: none of these
    if (!released_.empty()) (void)(*made)->release(released_);
  }
  if (ball_radius_) ball_ = static_cast<std::uint32_t>(scene.colliders.size());
  else ball_.reset();
  if (!simulation_ || !are_alike(was_rooms, rooms)) frame_ = 0;
  simulation_ = std::move(*made);
  scene_ = scene;
  grabbed_.reset();
  kept_.clear();   // they were of the scene as it was
  ++generation_;
  return {};
}

// Vertices of a later cloth have other numbers where one before it has more of them.
void Stage::renumber(std::span<const Room> was, std::span<const Room> now) {
  if (!are_alike(was, now)) return;
  for (auto* vertices : {&pinned_, &released_})
    for (std::uint32_t& v : *vertices)
      for (std::size_t r = was.size(); r-- > 0;)
        if (v - was[r].first_vertex < was[r].vertices) {
          v += now[r].first_vertex - was[r].first_vertex;
          break;
        }
}

// What a simulation takes while it runs.
bool Stage::differs_in_forces_alone(const Scene& scene) const {
  Scene same = scene;
  same.gravity = scene_.gravity;
  if (same.air && scene_.air) same.air->wind = scene_.air->wind;
  return scene_text(same) == scene_text(scene_);
}

Result<void> Stage::change(const Scene& scene) {
  if (differs_in_forces_alone(scene)) {
    if (auto done = simulation_->set_gravity(scene.gravity); !done) return done;
    if (scene.air)
      if (auto done = simulation_->set_wind(scene.air->wind); !done) return done;
    scene_ = scene;
    start_.reset();
    return {};
  }
  if (auto done = replace(scene); !done) return done;
  start_.reset();
  return {};
}

Result<void> Stage::time_passes(bool on) {
  if (times_ == on) return {};
  times_ = on;
  auto kept = std::exchange(kept_, {});
  const std::uint64_t frame = frame_;
  if (auto done = replace(scene_); !done) {
    times_ = !on;
    kept_ = std::move(kept);
    return done;
  }
  kept_ = std::move(kept);   // the scene is the same
  frame_ = frame;
  return {};
}

Result<void> Stage::put_ball(std::optional<double> radius) {
  const auto had = std::exchange(ball_radius_, radius);
  ball_centre_ = kAway;
  if (auto done = replace(scene_); !done) {
    ball_radius_ = had;
    return done;
  }
  start_.reset();
  return {};
}

Result<void> Stage::move_ball(Vec3 centre) {
  if (!ball_) return {};
  ColliderPose pose;
  pose.centre = centre;
  // From far away it comes without meeting anything.
  const bool arrives = std::exchange(ball_centre_, centre) == kAway;
  return arrives ? simulation_->place_collider(*ball_, pose) : simulation_->move_collider(*ball_, pose);
}

Result<void> Stage::take_knife(bool on) {
  if (has_knife_ == on) return {};
  has_knife_ = on;
  if (!on) {
    has_knife_ = simulation_->splits() > 0;   // it has to stay as it is cut
    return {};
  }
  if (auto done = replace(scene_); !done) {
    has_knife_ = false;
    return done;
  }
  start_.reset();
  return {};
}

Result<std::uint32_t> Stage::cut(const Ray& from, const Ray& to) { return simulation_->cut(from.origin, from.direction, to.direction); }

Result<void> Stage::step() {
  auto done = simulation_->submit(1 / scene_.solver.rate);
  if (!done) return done.take_error();
  ++frame_;
  return {};
}

Result<void> Stage::reset() {
  pinned_.clear();
  released_.clear();
  if (start_) {
    if (auto done = simulation_->restore(start_->snapshot); !done) return done;
  } else {
    auto made = make(prepared(scene_));
    if (!made) return made.take_error();
    simulation_ = std::move(*made);
    ++generation_;
    auto snapshot = simulation_->save();
    if (!snapshot) return snapshot.take_error();
    start_ = Keepsake{0, 0, std::move(*snapshot), {}, {}};
  }
  frame_ = 0;
  grabbed_.reset();
  return {};
}

Result<void> Stage::keep() {
  auto snapshot = simulation_->save();
  if (!snapshot) return snapshot.take_error();
  kept_.push_back({frame_, simulation_->time(), std::move(*snapshot), pinned_, released_});
  return {};
}

Result<void> Stage::go_back_to(std::size_t kept) {
  if (auto done = simulation_->restore(kept_[kept].snapshot); !done) return done;
  frame_ = kept_[kept].frame;
  pinned_ = kept_[kept].pinned;
  released_ = kept_[kept].released;
  grabbed_.reset();
  return {};
}

Result<bool> Stage::grab(const Ray& ray) {
  auto found = simulation_->grab(ray.origin, ray.direction);
  if (!found) return found.take_error();
  grabbed_ = *found;
  return grabbed_.has_value();
}

Result<void> Stage::drag(const Ray& ray, Vec3 ahead) {
  if (!grabbed_) return {};
  const float depth = dot(grabbed_->point - ray.origin, ahead), along = dot(ray.direction, ahead);
  if (!(along > 1e-6f)) return {};
  return simulation_->move_grab(grabbed_->grab, ray.origin + (depth / along) * ray.direction);
}

Result<void> Stage::let_go() {
  if (!grabbed_) return {};
  return simulation_->let_go(std::exchange(grabbed_, std::nullopt)->grab);
}

Result<std::optional<std::string>> Stage::pin_or_release(const Ray& ray) {
  // A hold that is let go of at once says where the ray meets cloth.
  auto found = simulation_->grab(ray.origin, ray.direction);
  if (!found) return found.take_error();
  if (!*found) return std::optional<std::string>();
  if (auto done = simulation_->let_go((*found)->grab); !done) return done.take_error();
  auto vertices = simulation_->read_vertex_positions();
  if (!vertices) return vertices.take_error();
  const ClothRange& cloth = simulation_->fabric().cloths[(*found)->cloth];
  const std::uint32_t vertex =
      cloth.first_vertex + nearest_to(std::span(*vertices).subspan(cloth.first_vertex, cloth.vertices), (*found)->point);
  const auto pinned = std::ranges::find(pinned_, vertex);
  const std::vector<AnchorTarget>& anchors = simulation_->fabric().anchors;
  const bool is_anchor = std::ranges::find(anchors, vertex, &AnchorTarget::vertex) != anchors.end() &&
                         std::ranges::find(released_, vertex) == released_.end();
  const std::uint32_t one[] = {vertex};
  if (pinned != pinned_.end() || is_anchor) {
    if (auto done = simulation_->release(one); !done) return done.take_error();
    if (pinned != pinned_.end()) pinned_.erase(pinned);
    else released_.push_back(vertex);
    return std::optional("released vertex " + std::to_string(vertex));
  }
  if (auto done = simulation_->pin(one); !done) return done.take_error();
  if (const auto was = std::ranges::find(released_, vertex); was != released_.end()) released_.erase(was);
  else pinned_.push_back(vertex);
  return std::optional("pinned vertex " + std::to_string(vertex));
}

Result<std::pair<Vec3, Vec3>> Stage::bounds() const {
  auto vertices = simulation_->read_vertex_positions();
  if (!vertices) return vertices.take_error();
  const ClothRange& last = simulation_->fabric().cloths.back();
  Vec3 low = vertices->front(), high = low;
  for (const Vec3 p : std::span(*vertices).first(last.first_vertex + last.vertices)) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::pair(low, high);
}

Result<std::vector<Vec3>> Stage::contacts() const {
  auto snapshot = simulation_->save();
  if (!snapshot) return snapshot.take_error();
  auto particles = simulation_->read_positions();
  if (!particles) return particles.take_error();
  const auto content = std::ranges::find(snapshot->contents, "candidates", &Snapshot::Content::name);
  std::vector<Vec3> ends;
  if (content == snapshot->contents.end()) return ends;
  const Vec3 origin = simulation_->origin();
  const auto at = [&](std::uint32_t particle) {
    const gpu::vec4& p = (*particles)[particle];
    return Vec3{p.x, p.y, p.z} + origin;
  };
  for (std::size_t k = 0; k + sizeof(gpu::uvec4) <= content->bytes.size(); k += sizeof(gpu::uvec4)) {
    gpu::uvec4 packed{};
    std::memcpy(&packed, content->bytes.data() + k, sizeof packed);
    const gpu::Candidate pair = gpu::unpack_candidate(packed);
    const auto& p = pair.particle;
    ends.push_back(pair.edges ? 0.5f * (at(p[0]) + at(p[1])) : at(p[0]));
    ends.push_back(pair.edges ? 0.5f * (at(p[2]) + at(p[3])) : (1 / 3.0f) * (at(p[1]) + at(p[2]) + at(p[3])));
  }
  return ends;
}

}  // namespace weft::view
