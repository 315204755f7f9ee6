// Vertex block descent solves the reference's problem: what it is compared by (engine/reference/vbd.h).
#include "engine/reference/errors.h"
#include "engine/reference/vbd.h"
#include "tests/support/reference_scenes.h"

namespace weft::reference {
namespace {

double distance_to_reference(const Scene& scene, std::uint32_t frames, const VbdSettings& settings) {
  const CookedFabric fabric = cooked(scene);
  const auto run = integrate_vbd(scene, fabric, frames, settings);
  EXPECT_TRUE(run) << run.error();
  return run ? run_error(run->trajectory, reference::run(scene, fabric, frames, fabric.h), sheet_size(fabric)) : NAN;
}

// Descent by particles goes on for as long as doubles resolve; a step of the reference is solved to 1e-10.
TEST(VertexBlockDescent, with_many_sweeps_it_takes_the_references_steps_on_cloth_that_gives_way) {
  Scene scene = hung_sheet(4, false);
  scene.cloths[0].fabric.stretch = 100;
  EXPECT_LT(distance_to_reference(scene, 3, {.sweeps = 400}), 1e-9);
}

// Augmented links let a sheet fall that springs as stiff hold in the air: it comes nearer, and nearer still with more sweeps.
TEST(VertexBlockDescent, the_augmented_form_frees_rigid_cloth_that_freezes_without_it) {
  Scene scene = hung_sheet(6, false);
  scene.cloths[0].fabric.stretch = scene.cloths[0].fabric.shear = INFINITY;
  const double frozen = distance_to_reference(scene, 6, {.sweeps = 4, .augmented = false});
  const double few = distance_to_reference(scene, 6, {.sweeps = 4}), many = distance_to_reference(scene, 6, {.sweeps = 16});
  EXPECT_LT(few, frozen / 2);
  EXPECT_LT(many, few / 1.5);
}

TEST(VertexBlockDescent, what_it_cannot_do_is_refused_by_a_sentence) {
  Scene scene = hung_sheet(2, false);
  const CookedFabric fabric = cooked(scene);
  scene.cloths[0].anchors[0].keys.push_back({});
  EXPECT_EQ(integrate_vbd(scene, fabric, 1, {}).error(), "cloths[0].anchors[0].keys: vertex block descent has no anchors that move here");
  scene.colliders.emplace_back();
  EXPECT_EQ(integrate_vbd(scene, fabric, 1, {}).error(), "colliders[0]: vertex block descent has no colliders here; it was given 1");
}

}  // namespace
}  // namespace weft::reference
