// Cloths and colliders that do not meet: each goes through the other as if it were not there, with every method and on every way through a
// frame; and where all meet there is no mask.
#include <gtest/gtest.h>

#include "engine/effects/collide/collide.h"
#include "engine/effects/contact/contact.h"
#include "tests/support/cooked.h"
#include "tests/support/single_pass.h"
#include "tests/support/ways.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Masks = GpuTest;

Cloth named(const char* name, float height, std::uint32_t cells = 8) {
  Cloth cloth = sheet(cells).cloths[0];
  cloth.name = name;
  cloth.transform.translate = {0, height, 0};
  cloth.fabric.damping = 2;
  return cloth;
}

Collider block(Vec3 centre, Vec3 size) {
  Collider collider;
  collider.shape = ColliderShape::box;
  collider.centre = centre;
  collider.size = size;
  return collider;
}

double lowest(const Simulation& simulation, std::size_t cloth) {
  const ClothRange& range = simulation.fabric().cloths[cloth];
  const auto positions = must(simulation.read_positions());
  double low = INFINITY;
  for (std::uint32_t k = 0; k < range.particles; ++k) low = std::min(low, double(positions[range.first_particle + k].y));
  return low;
}

// Two sheets side by side over a table, its legs' tops and a floor far below; 40 colliders before them fill a word of the masks.
Scene table(const std::vector<std::string>& meets) {
  Scene scene = without_contacts();
  scene.cloths = {named("skirt", 0.02f), named("cape", 0.02f)};
  scene.cloths[1].transform.translate.x = 3;
  for (int k = 0; k < 40; ++k) scene.colliders.push_back(sphere({50, static_cast<float>(k), 0}, 0.1));
  for (const float x : {0.0f, 3.0f}) {
    scene.colliders.push_back(block({x, -0.1f, 0}, {0.6f, 0.2f, 0.6f}));
    scene.colliders.push_back(sphere({x, -0.06f, 0.4f}, 0.06));
  }
  for (Collider& collider : scene.colliders) collider.meets = meets;
  scene.colliders.push_back(plane(-1));
  return scene;
}

TEST_F(Masks, a_collider_holds_the_cloths_that_it_meets_alone) {
  for (const Method method : {Method::jacobi, Method::gauss_seidel, Method::implicit}) {
    SCOPED_TRACE(static_cast<int>(method));
    Scene scene = table({"skirt"});
    scene.solver.method = method;
    scene.solver.iterations = method == Method::implicit ? 30 : 1;
    scene.reactions = method != Method::implicit;
    std::uint64_t hash = 0;
    for (const Way way : kWays) {
      const auto simulation = must(Simulation::create(device(), scene));
      for (int k = 0; k < 40; ++k) run_frame(device(), *simulation, way);
      const double free = 0.02 - 0.5 * 9.81 * 0.4;   // m: well past the block, less damping
      EXPECT_GT(lowest(*simulation, 0), -0.45) << "it hangs over the block's sides";
      EXPECT_LT(lowest(*simulation, 1), free / 2);
      if (hash == 0) hash = hash_of(*simulation);
      EXPECT_EQ(hash_of(*simulation), hash) << "way " << static_cast<int>(way);
      if (!scene.reactions) continue;
      const auto given = simulation->take_reactions();
      EXPECT_LT(given[40].impulse.y, -0.01f);
      EXPECT_EQ(length(given[42].impulse), 0) << "the block that the cape alone passes";
    }
  }
}

TEST_F(Masks, none_is_there_where_all_meet) {
  Scene scene = table({"skirt", "cape"});
  scene.contacts.enabled = true;
  scene.cloths[0].meets = {"cape"};
  const CookedFabric fabric = cooked(scene);
  const Needs needs = needs_of(cooked_of(scene, fabric), 64, true);
  EXPECT_EQ(needs.constants[gpu::constant::has_body_masks], 0u);
  EXPECT_EQ(needs.constants[gpu::constant::contact_mask_words], 0u);
  scene.colliders[3].meets->pop_back();
  scene.cloths[0].meets.emplace();
  const CookedFabric parted = cooked(scene);
  const Needs masked = needs_of(cooked_of(scene, parted), 64, true);
  EXPECT_EQ(masked.constants[gpu::constant::has_body_masks], 1u);
  EXPECT_EQ(masked.constants[gpu::constant::contact_mask_words], 1u);
}

// A sheet over another that lies on a plate, a mesh collider: by contacts each pair alone can be parted.
Scene pile(std::vector<Mesh>& meshes) {
  Scene scene;
  scene.cloths = {named("lower", 0.02f), named("upper", 0.05f)};
  scene.contacts.enabled = true;
  Collider& plate = scene.colliders.emplace_back();
  plate.shape = ColliderShape::mesh;
  Scene without = scene;
  without.colliders.clear();
  meshes = must(make_meshes(without));
  meshes.push_back(make_grid({{1.6f, 1.6f}, 5, 5, Topology::diagonal, false}));
  return scene;
}

TEST_F(Masks, cloth_passes_cloth_and_a_mesh_that_it_does_not_meet) {
  struct Trial {
    bool cloths_meet;
    std::vector<std::string> on_plate;
    bool lower_rests, upper_rests;
  };
  const Trial kTrials[] = {{true, {"lower", "upper"}, true, true}, {false, {"lower", "upper"}, true, true}, {true, {"upper"}, false, true},
                           {false, {"upper"}, false, true},        {true, {"lower"}, true, true},           {false, {"lower"}, true, false}};
  for (const Trial& trial : kTrials) {
    std::vector<Mesh> meshes;
    Scene scene = pile(meshes);
    if (!trial.cloths_meet) scene.cloths[0].meets.emplace();
    scene.colliders[0].meets = trial.on_plate;
    SCOPED_TRACE(std::to_string(&trial - kTrials));
    std::uint64_t hash = 0;
    for (const Way way : kWays) {
      const std::ptrdiff_t which = &trial - kTrials;
      if (which > 0 && way != kWays[which % 3]) continue;   // all ways once, then in turns
      const auto simulation = must(Simulation::create(device(), scene, meshes));
      for (int k = 0; k < 30; ++k) run_frame(device(), *simulation, way);
      EXPECT_EQ(lowest(*simulation, 0) > -0.01, trial.lower_rests) << lowest(*simulation, 0);
      EXPECT_EQ(lowest(*simulation, 1) > -0.01, trial.upper_rests) << lowest(*simulation, 1);
      EXPECT_EQ(simulation->counts().crossings, 0u) << "what does not meet is not tangled either";
      if (hash == 0) hash = hash_of(*simulation);
      EXPECT_EQ(hash_of(*simulation), hash) << "way " << static_cast<int>(way);
    }
  }
}

// Parted, two sheets are as if each were alone.
TEST_F(Masks, sheets_that_start_through_each_other_and_do_not_meet_are_left_alone) {
  Scene scene;
  scene.cloths = {named("lower", 0), named("upper", 0.0005f, 9)};
  scene.cloths[1].transform.axis = {0, 0, 1};
  scene.cloths[1].transform.degrees = 20;
  scene.contacts.enabled = true;
  scene.gravity = {0, 0, 0};
  const auto tangled = must(Simulation::create(device(), scene));
  run(*tangled, 0.1);
  EXPECT_GT(tangled->counts().crossings_most, 0u) << "the scene tests nothing";
  scene.cloths[1].meets.emplace();
  const auto apart = must(Simulation::create(device(), scene));
  run(*apart, 0.1);
  EXPECT_EQ(apart->counts().crossings_most, 0u);
  EXPECT_EQ(apart->counts().contacts_most, 0u);
  EXPECT_LT(top_speed(*apart), 1e-3);
}

}  // namespace
}  // namespace weft
