// A host that sets a scene elsewhere between two frames: cloth and anchors by write_positions, colliders by place_collider. The
// scene goes on as if it had been there all along: nothing is swept over on the way.
#include <gtest/gtest.h>

#include "engine/reference/intersections.h"
#include "tests/support/mesh_files.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using Teleport = GpuTest;

constexpr Vec3 kBy{2, 1, -2};
void teleport(Simulation& simulation) {
  auto positions = must(simulation.read_positions());
  for (gpu::vec4& p : positions) p = {p.x + kBy.x, p.y + kBy.y, p.z + kBy.z, p.w};
  must(simulation.write_positions(positions));
  for (std::uint32_t k = 0; k < simulation.scene().colliders.size(); ++k) {
    ColliderPose pose = simulation.colliders()[k];
    pose.centre = pose.centre + kBy;
    must(simulation.place_collider(k, pose));
    EXPECT_EQ(simulation.colliders()[k].centre, pose.centre);
  }
}

// The farthest that a particle of the second is from where it is in the first and `by` further on, m.
double farthest(const Simulation& stays, const Simulation& goes, Vec3 by) {
  const auto a = must(stays.read_positions()), b = must(goes.read_positions());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::hypot(double(b[i].x) - by.x - a[i].x, double(b[i].y) - by.y - a[i].y, double(b[i].z) - by.z - a[i].z));
  return most;
}

// Positions some metres further off are rounded by 2.4e-7 m, which is 1.4e-4 m/s in each substep of 1/600 s; ten of them make 1e-5 m
// of a frame. A swing over a sphere makes a hundred times that of it in the next ten: one vertex slides where it stuck.
constexpr double kAFrame = 1e-4, kTenFrames = 1e-2;

TEST_F(Teleport, cloth_set_elsewhere_with_its_anchors_and_colliders_goes_on_as_if_nothing_had_happened) {
  Scene scene = sheet(12);
  scene.cloths[0].start.imperfection = 0;   // one that buckles tells roundings apart
  scene.cloths[0].fabric.damping = 1;
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
  scene.colliders = {sphere({0, -0.4f, 0}, 0.25), plane(-0.7f)};
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {2, {}, {0, 1, 0}, 60}};   // turns
  const auto stays = must(Simulation::create(device(), scene)), goes = must(Simulation::create(device(), scene));
  for (Simulation* simulation : {stays.get(), goes.get()}) run(*simulation, 0.5);
  teleport(*goes);
  // Keys are relative to the old place: the host drives what has any.
  const auto turning = [&](Simulation& simulation, Vec3 by) {
    const Key key = pose_at(scene.colliders[0].keys, simulation.time() + kFrame);
    must(simulation.move_collider(0, {scene.colliders[0].centre + by, {0, 1, 0}, rotation_about(key.axis, key.degrees)}));
    must(simulation.advance(kFrame));
  };
  turning(*stays, {}), turning(*goes, kBy);
  EXPECT_LT(farthest(*stays, *goes, kBy), kAFrame);
  for (int frame = 0; frame < 10; ++frame) turning(*stays, {}), turning(*goes, kBy);
  EXPECT_LT(farthest(*stays, *goes, kBy), kTenFrames);
  for (const Simulation* simulation : {stays.get(), goes.get()}) EXPECT_EQ(simulation->counts().non_finite, 0u);
}

TEST_F(Teleport, a_mesh_collider_takes_the_cloth_that_lies_on_it_along) {
  const test::Folder folder;
  folder.write("floor.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n");
  Scene scene = sheet(8);
  scene.folder = folder / "";
  scene.cloths[0].transform.translate = {0, 0.02f, 0};
  scene.cloths[0].fabric.damping = 1;
  scene.contacts.enabled = true;
  Collider& floor = scene.colliders.emplace_back();
  floor.shape = ColliderShape::mesh;
  floor.mesh = "floor.obj";
  const auto stays = must(Simulation::create(device(), scene)), goes = must(Simulation::create(device(), scene));
  for (Simulation* simulation : {stays.get(), goes.get()}) run(*simulation, 0.25);
  teleport(*goes);
  for (Simulation* simulation : {stays.get(), goes.get()}) run(*simulation, 0.25);
  EXPECT_LT(farthest(*stays, *goes, kBy), kAFrame) << "it lies still";
  std::vector<Vec3> places;
  for (const gpu::vec4& p : must(goes->read_positions())) places.push_back({p.x, p.y, p.z});
  EXPECT_EQ(count_crossings(places, goes->fabric().triangles, goes->fabric().cloth_triangles), 0u);
  // The collider alone: its particles are where its pose says, and stay there.
  const ColliderPose pose{{0, -3, 0}, {0, 1, 0}, rotation_about({1, 0, 0}, 30)};
  must(goes->place_collider(0, pose));
  must(goes->advance(kFrame));
  const ColliderMesh& mesh = goes->fabric().collider_meshes[0];
  const std::vector<Vec3> points = collider_points(goes->fabric(), mesh, pose.centre, goes->colliders()[0].rotation);
  const auto particles = must(goes->read_positions());
  for (std::uint32_t k = 0; k < mesh.particles; ++k) {
    const gpu::vec4& p = particles[mesh.first_particle + k];
    EXPECT_EQ((Vec3{p.x, p.y, p.z}), points[k]);
  }
}

TEST_F(Teleport, keys_take_a_collider_that_was_placed_on_from_there) {
  Scene scene = sheet(2);
  scene.colliders = {sphere({0, -5, 0}, 0.1)};
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {1, {1, 0, 0}, {0, 1, 0}, 90}};
  const auto simulation = must(Simulation::create(device(), scene));
  must(simulation->move_collider(0, {{9, 9, 9}, {0, 1, 0}, {}}));   // forgotten
  must(simulation->place_collider(0, {{0, -7, 0}, {0, 1, 0}, {}}));
  must(simulation->advance(kFrame));
  EXPECT_EQ(simulation->colliders()[0].centre, (Vec3{0, -7, 0})) << "the host leads it";
  const auto refused = simulation->place_collider(1, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("collider 1 is not below the scene's 1"), std::string::npos) << refused.error();

  const auto keyed = must(Simulation::create(device(), scene));
  must(keyed->advance(0.25));
  must(keyed->place_collider(0, {{0, -7, 0}, {0, 1, 0}, {}}));
  EXPECT_EQ(keyed->colliders()[0].centre.y, -7);
  must(keyed->advance(kFrame));
  EXPECT_EQ(keyed->colliders()[0].centre.y, -5);
}

}  // namespace
}  // namespace weft
