// Targets in a buffer of the host's, which skins on its own GPU: anchors, motion constraints and mesh colliders go where its shader has written
// that they are, as if joints had taken them there.
#include <gtest/gtest.h>

#include "engine/effects/skin/skin.h"
#include "tests/support/host_skinning.h"
#include "tests/support/skins.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using SkinTargetCase = GpuTest;

// A sheet that is held at two corners, below it a plate that is a mesh collider.
struct Doll {
  Scene scene;
  std::vector<Mesh> meshes;
};

Doll doll(bool constrained, bool jointed, Vec3 place = {}) {
  Doll made;
  made.scene = sheet(12);
  Cloth& cloth = made.scene.cloths[0];
  cloth.transform.translate = place;
  cloth.anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  cloth.skin.emplace().takes_targets = true;
  if (constrained) cloth.motion_constraints = MotionConstraints{.max_distance = 0.1, .backstop_distance = 0.02, .backstop_radius = 0.5};
  made.meshes = must(make_meshes(made.scene));
  made.scene.contacts.enabled = true;
  Collider& plate = made.scene.colliders.emplace_back();
  plate.shape = ColliderShape::mesh;
  plate.centre = place + Vec3{0, -0.3f, 0};
  plate.skin.emplace().takes_targets = true;
  made.meshes.push_back(make_grid({{1.4f, 1.4f}, 4, 4, Topology::diagonal, false}));
  if (jointed)
    for (Mesh& mesh : made.meshes) mesh.skin = two_joints(mesh);
  return made;
}

// Where a map takes a mesh's render vertices.
std::vector<Vec3> moved(const Mesh& mesh, const Affine& map) {
  std::vector<Vec3> places;
  for (const std::uint32_t point : mesh.point_of) places.push_back(map * mesh.points[point]);
  return places;
}

class Host {
 public:
  Host(const compute::Device& device, const Doll& made, bool with_normals = false)
      : device_(device), cloth_(device, static_cast<std::uint32_t>(made.meshes[0].render.positions.size()), with_normals),
        body_(device, static_cast<std::uint32_t>(made.meshes[1].render.positions.size()), false) {}

  /// A frame that ends with these places: its shaders run right before it, with no barrier between.
  void frame(Simulation& simulation, Way way, std::span<const Vec3> cloth, std::span<const Vec3> body, std::span<const Vec3> normals = {}) {
    must(simulation.set_targets(0, cloth_.targets()));
    must(simulation.set_body_targets(0, body_.targets()));
    const auto skin = [&](VkCommandBuffer commands) { cloth_.record(commands, cloth, normals), body_.record(commands, body); };
    if (way == Way::record) {
      must(compute::run_once(device_, "host", [&](VkCommandBuffer commands) {
        skin(commands);
        must(simulation.record(commands, kFrame));
      }));
      return;
    }
    must(compute::run_once(device_, "host", skin));
    run_frame(device_, simulation, way);
  }
  const HostSkinning& cloth() const { return cloth_; }

 private:
  const compute::Device& device_;
  HostSkinning cloth_, body_;
};

Vec3 way_at(int frame) {
  const float t = static_cast<float>(frame) / 20;
  return {0.1f * t, 0.2f * t * t, -0.05f * t};
}

// The same bits as with a pose, where a pose takes points to the same places: one joint that moves all.
TEST_F(SkinTargetCase, are_as_good_as_a_pose_to_the_bit_in_all_ways) {
  for (const bool tight : {false, true})
    for (const Way way : kWays) {
      Doll made = doll(true, false);
      if (tight) made.scene.contacts.capacity = 64;   // too few: advance repeats frames
      const auto posed = must(Simulation::create(device(), made.scene, made.meshes));
      const auto told = must(Simulation::create(device(), made.scene, made.meshes));
      if (tight && way != Way::advance)
        for (Simulation* each : {posed.get(), told.get()}) must(each->reserve_contacts(20000));
      Host host(device(), made);
      for (int frame = 1; frame <= 12; ++frame) {
        const Affine map = moved_by(way_at(frame)), body = affine(made.scene.colliders[0].centre, {}) * map;
        must(posed->set_pose(0, std::array{map}));
        must(posed->set_body_pose(0, std::array{map}));
        run_frame(device(), *posed, way);
        host.frame(*told, way, moved(made.meshes[0], map), moved(made.meshes[1], body));
        ASSERT_EQ(hash_of(*told), hash_of(*posed)) << "frame " << frame;
      }
      for (Simulation* each : {posed.get(), told.get()}) {
        run_frame(device(), *each, way);
        run_frame(device(), *each, way);
      }
      EXPECT_EQ(hash_of(*told), hash_of(*posed)) << "a frame without either holds still";
      for (Simulation* each : {posed.get(), told.get()}) {   // and joints take over again
        must(each->set_pose(0, std::array{moved_by({0, 0.1f, 0})}));
        must(each->set_body_pose(0, std::array{moved_by({0, 0, 0.1f})}));
        run_frame(device(), *each, way);
        run_frame(device(), *each, way);
      }
      EXPECT_EQ(hash_of(*told), hash_of(*posed)) << "after the host's pose";
      EXPECT_EQ(told->counts().non_finite, 0u);
    }
}

// Any skinning: what one simulation's joints make of vertices is what the other is told.
TEST_F(SkinTargetCase, follow_skinning_of_any_kind_to_the_bit) {
  const Doll made = doll(false, true);
  const auto posed = must(Simulation::create(device(), made.scene, made.meshes)), told = must(Simulation::create(device(), made.scene, made.meshes));
  Host host(device(), made);
  const std::size_t cloth = made.meshes[0].render.positions.size();
  for (int frame = 1; frame <= 10; ++frame) {
    const float c = std::cos(0.05f * static_cast<float>(frame)), s = std::sin(0.05f * static_cast<float>(frame));
    const std::array joints{Affine{{c, s, 0}, {-s, c, 0}, {0, 0, 1}, way_at(frame)}, Affine{{1, 0, 0}, {0, c, s}, {0, -s, c}, {0, 0.1f, 0}}};
    must(posed->set_pose(0, joints));
    must(posed->set_body_pose(0, joints));
    must(posed->advance(kFrame));
    const std::vector<Vec3> there = must(posed->read_vertex_positions());   // of those that are held exactly where joints take them
    host.frame(*told, Way::advance, std::span(there).first(cloth), std::span(there).subspan(cloth));
    ASSERT_EQ(hash_of(*told), hash_of(*posed)) << frame;
  }
}

// m: how far render vertices that are held are from where they should be.
double off(const Simulation& simulation, std::span<const Vec3> cloth, std::span<const Vec3> body) {
  const auto there = must(simulation.read_vertex_positions());
  const auto& fabric = simulation.fabric();
  double most = 0;
  for (const AnchorTarget& anchor : fabric.anchors) most = std::max(most, double(length(there[anchor.vertex] - cloth[anchor.vertex])));
  for (std::size_t k = 0; k < body.size(); ++k) most = std::max(most, double(length(there[cloth.size() + k] - body[k])));
  return most;
}

// Wherever the origin is, to the rounding of floats there; and with normals of the host, on whose far side backstops lie.
TEST_F(SkinTargetCase, are_in_world_space_and_normals_turn_backstops) {
  for (const Vec3 place : {Vec3{}, Vec3{1000, 0, -500}})
    for (const float up : {2.0f, -3.0f}) {
      const Doll made = doll(true, false, place);
      const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
      Host host(device(), made, true);
      const std::vector<Vec3> normals(made.meshes[0].render.positions.size(), Vec3{0, up, 0});
      std::vector<Vec3> cloth;
      for (int frame = 1; frame <= 40; ++frame) {
        const Affine map = moved_by(way_at(std::min(frame, 20)));
        const auto body = moved(made.meshes[1], affine(made.scene.colliders[0].centre + Vec3{0, -1, 0}, {}) * map);
        cloth = moved(made.meshes[0], map);
        host.frame(*simulation, Way::advance, cloth, body, normals);
        ASSERT_LT(off(*simulation, cloth, body), place == Vec3{} ? 1e-6 : 2e-4) << frame;
      }
      // Behind normals that point down lies what is above: then cloth falls to its max distance, else on the backstop.
      const float middle = must(simulation->read_vertex_positions())[84].y - cloth[84].y;
      if (up < 0) { EXPECT_LT(middle, -0.05f); }
      else { EXPECT_NEAR(middle, -0.02f, 0.004f); }
    }
}

TEST_F(SkinTargetCase, go_on_from_a_snapshot_and_are_taken_along) {
  const Doll made = doll(true, false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes)), other = must(Simulation::create(device(), made.scene, made.meshes));
  Host host(device(), made);
  const Affine map = moved_by({0.2f, 0.1f, 0}), below = affine(made.scene.colliders[0].centre, {}) * map;
  host.frame(*simulation, Way::advance, moved(made.meshes[0], map), moved(made.meshes[1], below));
  must(other->restore(must(parse_snapshot(snapshot_bytes(must(simulation->save()))))));
  for (Simulation* each : {simulation.get(), other.get()}) run(*each, 0.1);
  EXPECT_EQ(hash_of(*simulation), hash_of(*other));
  EXPECT_LT(off(*other, moved(made.meshes[0], map), moved(made.meshes[1], below)), 1e-6);

  // A quarter of a turn about y, and away.
  const float half = std::sqrt(0.5f);
  const MovingFrame from{{0, 0, 0}, {}}, to{{3, 1, 0}, {0, half, 0, half}};
  const Affine turn{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {3, 1, 0}};
  must(simulation->teleport(0, from, to));
  must(simulation->place_collider(0, {.centre = turn * made.scene.colliders[0].centre, .rotation = {0, half, 0, half}}));
  const auto cloth = moved(made.meshes[0], turn * map), body = moved(made.meshes[1], turn * below);
  EXPECT_LT(off(*simulation, cloth, body), 1e-5);
  run(*simulation, 0.1);
  EXPECT_LT(off(*simulation, cloth, body), 1e-5) << "it stays there";
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

TEST_F(SkinTargetCase, that_are_no_places_are_counted_and_their_points_hold_still) {
  const Doll made = doll(true, false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  Host host(device(), made);
  const Affine body = affine(made.scene.colliders[0].centre, {});
  auto places = moved(made.meshes[0], moved_by({0, 0.1f, 0}));
  const std::vector<Vec3> rest = moved(made.meshes[0], {});
  const auto& anchors = simulation->fabric().anchors;
  places[anchors[0].vertex] = {NAN, 0, 0};
  places[80] = {0, INFINITY, 0};
  places[81] = {0, 0, 2e10f};
  host.frame(*simulation, Way::advance, places, moved(made.meshes[1], body));
  EXPECT_EQ(simulation->counts().non_finite, 3u);
  const auto there = must(simulation->read_vertex_positions());
  EXPECT_EQ(there[anchors[0].vertex], rest[anchors[0].vertex]);
  EXPECT_EQ(there[anchors[1].vertex], places[anchors[1].vertex]);
  run(*simulation, 0.2);
  EXPECT_EQ(simulation->counts().non_finite, 3u);
}

// Pass by pass, timed on the CPU; and a frame without a substep leaves the buffer for the next one.
TEST_F(SkinTargetCase, wait_for_a_frame_that_takes_a_substep_and_go_pass_by_pass) {
  const Doll made = doll(true, false);
  SimulationOptions options;
  options.timings = options.timings_on_cpu = true;
  const auto plain = must(Simulation::create(device(), made.scene, made.meshes)), timed = must(Simulation::create(device(), made.scene, made.meshes, options));
  Host host(device(), made);
  const Affine map = moved_by({0, 0.1f, 0});
  const auto cloth = moved(made.meshes[0], map), body = moved(made.meshes[1], affine(made.scene.colliders[0].centre, {}) * map);
  for (Simulation* each : {plain.get(), timed.get()}) {
    must(each->set_targets(0, host.cloth().targets()));
    EXPECT_EQ(must(each->advance(0)).substeps, 0u);
    host.frame(*each, Way::advance, cloth, body);
    EXPECT_LT(off(*each, cloth, body), 1e-6);
  }
  EXPECT_EQ(hash_of(*plain), hash_of(*timed));
}

TEST_F(SkinTargetCase, that_the_host_cannot_mean_are_refused_and_a_scene_that_asks_for_none_has_nothing_of_them) {
  Doll made = doll(true, false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto fault = [](const Result<void>& result) { return result ? std::string() : result.error(); };
  EXPECT_EQ(fault(simulation->set_targets(0, {})), "the targets of cloth 0: `positions` is VK_NULL_HANDLE");
  Host host(device(), made);
  TargetBuffer targets = host.cloth().targets();
  targets.vertices = 3;
  EXPECT_EQ(fault(simulation->set_targets(0, targets)), "the targets of cloth 0 are of 3 vertices, and it has 169");
  EXPECT_NE(fault(simulation->set_body_targets(1, targets)).find("collider 1 takes no targets"), std::string::npos);
  must(simulation->advance(kFrame));
  const auto has = [](const Simulation& of, std::string_view name) {
    return std::ranges::any_of(of.buffers(), [&](const BufferUse& use) { return use.name == name; });
  };
  const char* names[] = {"target_rows", "skin_sources", "host_targets", "host_normals", "skin_ends"};
  for (const char* name : names) EXPECT_TRUE(has(*simulation, name)) << name;
  made.scene.cloths[0].skin->takes_targets = made.scene.colliders[0].skin->takes_targets = false;
  const auto without = must(Simulation::create(device(), made.scene, made.meshes));
  for (const char* name : names) EXPECT_FALSE(has(*without, name)) << name;
  EXPECT_NE(fault(without->set_targets(0, host.cloth().targets())).find("the key \"takes_targets\" of its \"skin\""), std::string::npos);
}

}  // namespace
}  // namespace weft
