// Morph targets in a simulation: what a skin moves goes where the weights of an animation or of the host take it, before joints carry it.
#include <gtest/gtest.h>

#include "engine/effects/skin/skin.h"
#include "tests/support/skins.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using SkinMorphCase = GpuTest;

// A sheet that is held at two corners and otherwise kept near, and below it a plate that is a mesh collider. Each has two joints, or none, and
// two morph targets: the first lifts what is at high x, the second moves all along z.
struct Faces {
  Scene scene;
  std::vector<Mesh> meshes;
};

void give_targets(Mesh& mesh, bool jointed, bool animated) {
  Skin& skin = mesh.skin.emplace();
  if (jointed) skin = two_joints(mesh);
  skin.morphs.resize(2);
  skin.morphs[1].weight = 0.25f;
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    if (mesh.points[p].x > 0.2f) {
      skin.morphs[0].points.push_back(p);
      skin.morphs[0].deltas.push_back({0, 0.3f, 0});
      skin.morphs[0].normal_deltas.push_back({0.5f, -0.5f, 0});
    }
    skin.morphs[1].points.push_back(p);
    skin.morphs[1].deltas.push_back({0, 0, 0.4f});
  }
  if (animated)
    skin.animations.push_back({"talk", {{0, Skin::Moves::weight, Skin::Interpolation::linear, {0, 1}, {{0.5f, 0, 0, 0}, {1, 0, 0, 0}}}}});
}

Faces faces(bool jointed, bool animated, Vec3 place = {}) {
  Faces made;
  made.scene = sheet(12);
  Cloth& cloth = made.scene.cloths[0];
  cloth.transform.translate = place;
  cloth.anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  cloth.motion_constraints = MotionConstraints{.max_distance = 0.1, .backstop_distance = 0.05, .backstop_radius = 0.5};
  cloth.skin.emplace().loops = false;
  made.meshes = must(make_meshes(made.scene));
  made.scene.contacts.enabled = true;
  Collider& plate = made.scene.colliders.emplace_back();
  plate.shape = ColliderShape::mesh;
  plate.centre = place + Vec3{0, -0.6f, 0};
  plate.skin.emplace().loops = false;
  made.meshes.push_back(make_grid({{1.4f, 1.4f}, 4, 4, Topology::diagonal, false}));
  for (Mesh& mesh : made.meshes) give_targets(mesh, jointed, animated);
  return made;
}

using Weights = std::array<float, 2>;

// m: how far those that the skins hold are from where weights and joints take them; `beyond`: others from their max distance, if more.
double off(const Simulation& simulation, Weights cloth, Weights body, const std::vector<Affine>& joints) {
  const auto& lists = simulation.fabric().own.of<SkinLists>();
  std::vector<Affine> maps = joints;
  for (const SkinnedMesh& skinned : lists.meshes)
    if (skinned.is_collider)
      for (std::uint32_t k = 0; k < skinned.joints; ++k) {
        const ColliderPose& pose = simulation.colliders()[skinned.index];
        maps[skinned.first_joint + k] = affine(pose.centre - simulation.origin(), pose.rotation) * maps[skinned.first_joint + k];
      }
  const float weights[] = {cloth[0], cloth[1], body[0], body[1]};
  double most = 0;
  const auto positions = must(simulation.read_positions());
  for (std::size_t k = 0; k < lists.points.size(); ++k) {
    const gpu::vec4& x = positions[lists.points[k].particle];
    const double away = double(length(skinned_point(morphed(lists, k, weights), maps) - Vec3{x.x, x.y, x.z}));
    most = std::max(most, x.w == 0 ? away : away - 0.1005);   // as near as one iteration keeps it
  }
  return most;
}

TEST_F(SkinMorphCase, weights_of_the_host_move_anchors_constraints_and_bodies_with_and_without_joints) {
  for (const Way way : kWays)
    for (const bool jointed : {true, false})
      for (const Vec3 place : {Vec3{}, Vec3{1000, 0, -500}}) {
        const Faces made = faces(jointed, false, place);
        const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
        std::vector<Affine> joints(jointed ? 4 : 2);
        EXPECT_LT(off(*simulation, {0, 0.25f}, {0, 0.25f}, joints), 1e-6) << "it begins with the weights of its file";
        Weights cloth{}, body{};
        for (int frame = 1; frame <= 20; ++frame) {
          const float t = 0.05f * static_cast<float>(frame);
          cloth = {t, 0.25f - t / 2};
          body = {-t, 0.25f};
          must(simulation->set_morphs(0, cloth));
          must(simulation->set_body_morphs(0, body));
          if (jointed) {
            joints[1] = moved_by({0, 0, t / 4});
            joints[2] = moved_by({t / 8, 0, 0});
            must(simulation->set_pose(0, std::span(joints).first(2)));
            must(simulation->set_body_pose(0, std::span(joints).last(2)));
          }
          run_frame(device(), *simulation, way);
          EXPECT_LT(off(*simulation, cloth, body, joints), 2e-6) << frame;
        }
        run_frame(device(), *simulation, way);
        EXPECT_LT(off(*simulation, cloth, body, joints), 2e-6) << "a frame without weights holds still";
        must(simulation->place_collider(0, {.centre = place + Vec3{0, -1, 0}}));
        EXPECT_LT(off(*simulation, cloth, body, joints), 2e-6) << "put elsewhere in the shape that it has";
        EXPECT_EQ(simulation->counts().non_finite, 0u);
      }
}

// The same bits in all three ways, and through a snapshot between two frames, with weights that wait for the next one.
TEST_F(SkinMorphCase, is_the_same_in_all_ways_and_after_a_snapshot) {
  const Faces made = faces(true, true);
  const auto weights_of = [](int frame) { return Weights{0.05f * static_cast<float>(frame), 1 - 0.1f * static_cast<float>(frame)}; };
  std::uint64_t first = 0;
  for (const Way way : kWays) {
    const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
    for (int frame = 1; frame <= 12; ++frame) {
      if (frame > 4) must(simulation->set_morphs(0, weights_of(frame)));
      run_frame(device(), *simulation, way);
    }
    must(simulation->set_morphs(0, weights_of(13)));
    must(simulation->set_body_morphs(0, weights_of(2)));
    const auto other = must(Simulation::create(device(), made.scene, made.meshes));
    must(other->restore(must(parse_snapshot(snapshot_bytes(must(simulation->save()))))));
    for (Simulation* each : {simulation.get(), other.get()}) run(*each, 0.1);
    EXPECT_EQ(hash_of(*simulation), hash_of(*other));
    first = way == Way::advance ? hash_of(*simulation) : first;
    EXPECT_EQ(hash_of(*simulation), first);
  }
}

// It begins where the animation does; what no channel moves stays as the file has it; the host takes over one, and the other goes on.
TEST_F(SkinMorphCase, an_animation_moves_the_weights_until_the_host_does) {
  const Faces made = faces(true, true);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto at = [](double seconds) { return Weights{static_cast<float>(0.5 + 0.5 * std::min(seconds, 1.0)), 0.25f}; };
  EXPECT_LT(off(*simulation, at(0), at(0), std::vector<Affine>(4)), 1e-6);
  for (int frame = 1; frame <= 70; ++frame) {
    must(simulation->advance(kFrame));
    EXPECT_LT(off(*simulation, at(frame / 60.0), at(frame / 60.0), std::vector<Affine>(4)), 2e-6) << frame;
  }
  const auto again = must(Simulation::create(device(), made.scene, made.meshes));
  must(again->set_morphs(0, Weights{0, 0}));
  run(*again, 0.5);
  EXPECT_LT(off(*again, {0, 0}, at(0.5), std::vector<Affine>(4)), 2e-6);
}

// Through a frame targets go in a straight line, evenly: after half of a frame's substeps half of the way.
TEST_F(SkinMorphCase, weights_go_evenly_through_the_frame) {
  Faces made = faces(false, false);
  made.scene.solver.substeps = 2;
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto height = [&] {
    float highest = -1;
    for (const gpu::vec4& x : must(simulation->read_positions()))
      if (x.w == 0) highest = std::max(highest, x.y);
    return highest;
  };
  must(simulation->set_morphs(0, Weights{1, 0.25f}));
  must(simulation->advance(kFrame));
  EXPECT_NEAR(height(), 0.3f, 1e-6f);
  const auto velocities = must(simulation->read_velocities());
  const auto positions = must(simulation->read_positions());
  for (const gpu::SkinPoint& point : simulation->fabric().own.of<SkinLists>().points)
    if (point.rest.x > 0.2f && positions[point.particle].w != 0) {
      EXPECT_LT(velocities[point.particle].y, 0.31f * 60 + 1) << "no faster than the frame's way";
    }
}

TEST_F(SkinMorphCase, a_scene_without_targets_that_move_anything_has_nothing_of_them) {
  const auto has = [](const Simulation& simulation, std::string_view name) {
    return std::ranges::any_of(simulation.buffers(), [&](const BufferUse& use) { return use.name == name; });
  };
  Faces made = faces(true, false);
  const auto with = must(Simulation::create(device(), made.scene, made.meshes));
  for (const char* name : {"morph_rows", "morph_deltas", "morph_normals", "morph_weights"}) EXPECT_TRUE(has(*with, name)) << name;
  made.scene.cloths[0].motion_constraints->backstop_radius = 0;
  EXPECT_FALSE(has(*must(Simulation::create(device(), made.scene, made.meshes)), "morph_normals")) << "no backstop asks for them";
  for (Mesh& mesh : made.meshes)
    for (Skin::Morph& morph : mesh.skin->morphs) morph.points.clear(), morph.deltas.clear(), morph.normal_deltas.clear();
  const auto idle = must(Simulation::create(device(), made.scene, made.meshes));
  for (const char* name : {"morph_rows", "morph_deltas", "morph_normals", "morph_weights"}) EXPECT_FALSE(has(*idle, name)) << name;
  must(idle->set_morphs(0, Weights{1, 1}));
  must(idle->advance(kFrame));
}

TEST_F(SkinMorphCase, what_the_host_cannot_mean_is_refused) {
  const Faces made = faces(true, false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto fault = [](const Result<void>& result) { return result ? std::string() : result.error(); };
  EXPECT_EQ(fault(simulation->set_morphs(0, std::array{1.0f})), "1 weights were given for the 2 morph targets of cloth 0");
  EXPECT_EQ(fault(simulation->set_body_morphs(0, std::array{1.0f, NAN})),
            "weight 1 of collider 0's morph targets is nan, not from -1e+06 to 1e+06");
  EXPECT_EQ(fault(simulation->set_morphs(0, std::array{2e6f, 0.0f})), "weight 0 of cloth 0's morph targets is 2e+06, not from -1e+06 to 1e+06");
  EXPECT_NE(fault(simulation->set_morphs(1, std::array{1.0f, 0.0f})).find("cloth 1 has no skin"), std::string::npos);
  must(simulation->advance(kFrame));
  EXPECT_LT(off(*simulation, {0, 0.25f}, {0, 0.25f}, std::vector<Affine>(4)), 1e-6);
  Snapshot snapshot = must(simulation->save());
  snapshot.skins[0].weights.pop_back();
  EXPECT_NE(fault(simulation->restore(snapshot)).find("skin 0 has another number of weights than 2"), std::string::npos);
}

}  // namespace
}  // namespace weft
