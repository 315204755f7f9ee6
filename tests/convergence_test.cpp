// The GPU's solvers solve the problem that the reference solves: given many iterations they converge to its run, and the
// default solver, given many substeps, to the cloth that its moduli describe.
#include <string>

#include "engine/reference/errors.h"
#include "tests/sheets.h"

namespace weft {
namespace {

using Convergence = GpuTest;

// A square sheet held along one side or by two corners, dropped from the horizontal.
enum class Held { side, corners };
Scene dropped(Held held, double stretch, double shear, double bend) {
  Scene scene = sheet(12);
  Cloth& cloth = scene.cloths[0];
  cloth.fabric.stretch = stretch;
  cloth.fabric.shear = shear;
  cloth.fabric.bend = bend;
  cloth.bending = bend > 0;
  cloth.tethers = false;
  if (held == Held::corners) cloth.anchors.push_back(held_at({Corner::low_high, Corner::high_high}));
  else cloth.anchors.emplace_back().box = Anchor::Box{{-1, -1, 0.49f}, {1, 1, 1}};
  scene.solver.relaxation = 1;
  scene.solver.longest_advance = 1 / scene.solver.rate;   // many iterations are many dispatches
  return scene;
}

constexpr std::uint32_t kFrames = 12;

reference::Trajectory run_on_gpu(const compute::Device& device, const Scene& scene, std::uint32_t frames) {
  const auto simulation = must(Simulation::create(device, scene));
  reference::Trajectory run;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    must(simulation->advance(1 / scene.solver.rate));
    run.poses.push_back(reference::pose_of(simulation->fabric(), must(simulation->read_positions())));
  }
  return run;
}

// Relative to the sheet's side, after kFrames frames with so many iterations a substep.
double distance_to_reference(const compute::Device& device, Scene scene, std::uint32_t iterations) {
  scene.solver.iterations = iterations;
  const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
  const auto reference = must(reference::integrate_newton(scene, fabric, kFrames, {.h = fabric.h}));
  EXPECT_EQ(reference.not_converged, 0u);
  return reference::run_error(run_on_gpu(device, scene, kFrames), reference, reference::sheet_size(fabric));
}

// A step of the reference is solved to 1e-10; what is left is the GPU's. With iterations its rounding adds up: positions of half a
// metre are rounded to 3e-8 m in every one of them, and a substep turns that into velocity.
TEST_F(Convergence, jacobi_comes_within_a_thousandth_of_the_reference_on_compliant_and_rigid_cloth) {
  struct Case {
    const char* name;
    Scene scene;
    std::uint32_t few, many;
  };
  const Case cases[] = {
      {"soft, by corners", dropped(Held::corners, 300, 30, 0), 4, 64},
      {"soft and bending, by corners", dropped(Held::corners, 300, 30, 1e-4), 4, 64},
      {"cotton, by its side", dropped(Held::side, 10e3, 45, 1e-5), 4, 64},
      {"rigid, by its side", dropped(Held::side, INFINITY, INFINITY, 0), 4, 64},
      {"rigid threads that bend, by their side", dropped(Held::side, INFINITY, 45, 1e-4), 4, 64},
  };
  for (const Case& c : cases) {
    const double few = distance_to_reference(device(), c.scene, c.few), many = distance_to_reference(device(), c.scene, c.many);
    EXPECT_LT(many, 1e-3) << c.name;
    EXPECT_LT(many, few / 2) << c.name;
    RecordProperty(c.name, std::to_string(few) + " " + std::to_string(many));
  }
}

// The default solver, one iteration with over-relaxation, on a strip that hangs by its top: it gets longer by rho g L^2 / (2 Y)
// of its length. A pass must not take over-relaxation for stiffness; what is left of it is the solver's own softness, W / omega
// beside alpha / h^2, a few percent with so many substeps.
TEST_F(Convergence, a_hanging_strip_stretches_as_much_as_its_modulus_says) {
  Scene scene;
  scene.solver.substeps = 100;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{0.1f, 1}, 3, 30, Topology::diagonal, true};
  cloth.fabric.stretch = 10;
  cloth.fabric.shear = 0.01;
  cloth.fabric.damping = 5;
  cloth.bending = cloth.tethers = false;
  cloth.anchors.emplace_back().top = 1e-4;
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 4);
  float lowest = 0;
  for (const gpu::vec4& p : must(simulation->read_positions())) lowest = std::min(lowest, p.y);
  const double longer = -0.5 - lowest, expected = cloth.fabric.area_density * 9.81 / (2 * cloth.fabric.stretch);
  double softness = 0;   // largest W / omega over alpha / h^2
  const CookedFabric& fabric = simulation->fabric();
  for (const StretchLink& link : fabric.links)
    softness = std::max(softness, (double(fabric.split_weights[link.a]) + fabric.split_weights[link.b]) / relaxation_of(scene.solver) /
                                      (link.compliance / (fabric.h * fabric.h)));
  RecordProperty("length_and_softness", std::to_string(longer / expected) + " " + std::to_string(softness));
  EXPECT_GT(longer / expected, 0.98);   // far links move strain about: reference_closed_forms_test.cpp
  EXPECT_LT(longer / expected, 1.02 + softness);
}

}  // namespace
}  // namespace weft
