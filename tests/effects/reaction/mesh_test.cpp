// What mesh colliders are given by contacts: the momentum that cloth loses, whatever lies on them or strikes them, to the bit in every way.
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "tests/support/mesh_files.h"
#include "tests/support/momentum.h"

namespace weft {
namespace {

using MeshReaction = GpuTest;

// A closed box about its origin, its sides facing outwards.
std::string box_text(Vec3 half) {
  std::ostringstream text;
  for (int k = 0; k < 8; ++k)
    text << "v " << (k & 1 ? half.x : -half.x) << ' ' << (k & 2 ? half.y : -half.y) << ' ' << (k & 4 ? half.z : -half.z) << '\n';
  text << "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
  return text.str();
}

Collider mesh(const std::string& file, Vec3 centre) {
  Collider collider;
  collider.shape = ColliderShape::mesh;
  collider.mesh = file;
  collider.centre = centre;
  return collider;
}

class Bodies {
 public:
  Bodies() {
    folder_.write("box.obj", box_text({0.2f, 0.1f, 0.2f}));
    folder_.write("plate.obj", box_text({0.4f, 0.01f, 0.4f}));
  }
  // A sheet of 0.3 m and these bodies.
  Scene scene(std::vector<Collider> colliders, std::uint32_t cells = 12) const {
    Scene scene = sheet(cells);
    scene.contacts.enabled = true;
    scene.folder = folder_ / "";
    scene.cloths[0].grid->size = {0.3f, 0.3f};
    scene.colliders = std::move(colliders);
    return scene;
  }

 private:
  test::Folder folder_;
};

TEST_F(MeshReaction, a_sheet_at_rest_weighs_on_a_mesh_box_what_it_weighs_and_where_it_lies) {
  const Bodies bodies;
  for (const Way way : kWays) {
    Scene scene = bodies.scene({mesh("box.obj", {0, 0, 0})});
    scene.reactions = true;
    scene.cloths[0].transform.translate = {0.03f, 0.102f, 0};   // 2 mm above it, where it rests
    const auto simulation = must(Simulation::create(device(), scene));
    const auto frames = [&](int count) {
      for (int k = 0; k < count; ++k) run_frame(device(), *simulation, way);
      must(simulation->read_positions());   // waits
      return simulation->take_reactions()[0];
    };
    frames(40);
    const Reaction given = frames(60);
    const double weight = 9.81 * mass_of(*simulation);
    EXPECT_NEAR(given.impulse.y, -weight, 1e-4 * weight);
    EXPECT_NEAR(std::hypot(given.impulse.x, given.impulse.z), 0, 1e-3 * weight);
    EXPECT_NEAR(given.angular_impulse.z, -0.03 * weight, 1e-4 * weight);
    EXPECT_NEAR(given.angular_impulse.x, 0, 1e-4 * weight);
    for (int k = 0; k < 2; ++k) EXPECT_EQ(frames(0).impulse.y, 0) << "told twice";
  }
}

// About the centre of the plate, which stands still.
Sum angular_momentum_of(const Simulation& simulation) {
  const auto positions = must(simulation.read_positions()), velocities = must(simulation.read_velocities());
  Sum sum;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const gpu::vec4 &x = positions[i], &v = velocities[i];
    if (x.w > 0)
      sum += {(double(x.y) * v.z - double(x.z) * v.y) / x.w, (double(x.z) * v.x - double(x.x) * v.z) / x.w,
              (double(x.x) * v.y - double(x.y) * v.x) / x.w};
  }
  return sum;
}

TEST_F(MeshReaction, a_free_sheet_that_strikes_a_mesh_plate_gives_it_what_it_loses) {
  const Bodies bodies;
  for (const Way way : kWays)
    for (const double speed : {0.5, 2.0, 6.0}) {
      SCOPED_TRACE(std::to_string(speed) + " m/s");
      Scene scene = bodies.scene({mesh("plate.obj", {0, 0, 0})});
      scene.gravity = {};
      scene.cloths[0].transform.translate = {0.05f, 0.03f, 0.02f};
      scene.cloths[0].transform.axis = {0.8f, 0, 0.6f};
      scene.cloths[0].transform.degrees = 4;
      scene.cloths[0].start.velocity = {static_cast<float>(0.3 * speed), static_cast<float>(-speed), 0};
      expect_balance(device(), scene, 30, way);

      scene.reactions = true;
      const auto simulation = must(Simulation::create(device(), scene));
      const Sum start = angular_momentum_of(*simulation);
      for (int k = 0; k < 30; ++k) run_frame(device(), *simulation, way);
      const Sum end = angular_momentum_of(*simulation);
      const Reaction given = simulation->take_reactions()[0];
      const double exchanged = double(length(given.impulse)) * 0.3;   // m: levers; links do not keep more of it in steps of 1 cm
      EXPECT_NEAR(end.x - start.x + given.angular_impulse.x, 0, 3e-3 * exchanged);
      EXPECT_NEAR(end.y - start.y + given.angular_impulse.y, 0, 3e-3 * exchanged);
      EXPECT_NEAR(end.z - start.z + given.angular_impulse.z, 0, 3e-3 * exchanged);
    }
}

// A sheet that falls on a plate which moves and turns, and one that falls on a formula and a mesh beside it, that have their share each. No
// sheet is folded: where cloth turns steps along itself, nobody gets what that takes.
Scene between_bodies(const Bodies& bodies) {
  Collider turning = mesh("plate.obj", {0, 0, 0}), still = mesh("plate.obj", {1, 0, 0});
  turning.friction = 0.8;
  turning.keys = {{0, {}, {0, 1, 0}, 0}, {1, {0.1f, 0.2f, 0}, {0, 1, 0}, 90}};
  Scene scene = bodies.scene({plane(-0.3f), turning, sphere({5, 0, 0}, 0.2), still}, 16);
  scene.cloths[0].transform.translate = {0.02f, 0.03f, 0};
  scene.cloths[0].start.velocity = {0.3f, -1, 0.1f};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {1.03f, 0.03f, 0};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[2].transform.translate = {-1, -0.25f, 0};
  return scene;
}

TEST_F(MeshReaction, bodies_that_move_and_turn_are_given_what_they_take_beside_others) {
  const Bodies bodies;
  for (const Way way : kWays) expect_balance(device(), between_bodies(bodies), 40, way);
}

TEST_F(MeshReaction, layers_of_cloth_hand_on_what_they_are_given) {
  const Bodies bodies;
  Scene scene = bodies.scene({mesh("plate.obj", {0, 0, 0})});
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[0].transform.translate = {0, 0.014f, 0};
  scene.cloths[1].transform.translate = {0.02f, 0.018f, 0.02f};
  expect_balance(device(), scene, 60);
}

std::vector<Reaction> told(Simulation& simulation) {
  must(simulation.read_positions());   // waits
  const auto now = simulation.take_reactions();
  return {now.begin(), now.end()};
}

TEST_F(MeshReaction, the_same_bits_in_every_way_twice_and_from_a_snapshot) {
  const Bodies bodies;
  Scene scene = between_bodies(bodies);
  scene.reactions = true;
  std::vector<std::vector<Reaction>> all, later;
  for (const Way way : {Way::advance, Way::submit, Way::record, Way::advance}) {
    auto simulation = must(Simulation::create(device(), scene));
    for (int k = 0; k < 20; ++k) run_frame(device(), *simulation, way);
    all.push_back(told(*simulation));
    simulation = resumed(device(), *simulation, scene);
    EXPECT_EQ(simulation->take_reactions()[1].impulse.y, 0) << "what was told before";
    for (int k = 0; k < 10; ++k) run_frame(device(), *simulation, way);
    later.push_back(told(*simulation));
  }
  EXPECT_LT(all[0][1].impulse.y, -1e-3);
  EXPECT_LT(later[0][1].impulse.y, -1e-3);
  for (const auto& runs : {all, later})
    for (const auto& run : runs)
      EXPECT_EQ(std::memcmp(run.data(), runs[0].data(), run.size() * sizeof(Reaction)), 0);
}

TEST_F(MeshReaction, who_does_not_ask_has_no_byte_and_the_same_bits) {
  const Bodies bodies;
  Scene scene = bodies.scene({mesh("box.obj", {0, -0.13f, 0})});
  scene.cloths[0].start.velocity = {0, -1, 0};
  const auto silent = must(Simulation::create(device(), scene));
  scene.reactions = true;
  const auto telling = must(Simulation::create(device(), scene));
  run(*silent, 0.3);
  run(*telling, 0.3);
  EXPECT_EQ(hash_of(*silent), hash_of(*telling));
  const auto has = [](const Simulation& simulation, std::string_view name) {
    for (const BufferUse& buffer : simulation.buffers())
      if (buffer.name == name) return true;
    return false;
  };
  for (const char* name : {"reactions", "colliders"}) {
    EXPECT_FALSE(has(*silent, name)) << name;
    EXPECT_TRUE(has(*telling, name)) << name;
  }
  EXPECT_LT(telling->take_reactions()[0].impulse.y, 0);
}

}  // namespace
}  // namespace weft
