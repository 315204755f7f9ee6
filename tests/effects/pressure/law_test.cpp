// The gas law, measured from outside: by the tension that holds it, and by what a press has to give.
//
// Scale a body in equilibrium about the origin: no work is done. A gas at the pressure p above the ambient does 3 p V, springs that pull
// with f at the length l take the sum of f l, and whatever pushes with F in x the sum of -F . x (the virial theorem; for a thin sphere
// it is Laplace's law p = 2 T / r). So p follows from lengths and forces, whatever the shape; the gas law says what it has to be.
#include <gtest/gtest.h>

#include "tests/effects/pressure/inside.h"

namespace weft {
namespace {

using PressureLaw = GpuTest;

// Rubber, about: it stretches by a few per cent. Springs' forces are the same at rest in every method, to the bit of their length.
Scene rubber(const Gas& gas, Method method) {
  Scene scene = gas_scene(gas);
  scene.solver.method = method;
  if (method == Method::implicit) scene.solver.iterations = 30;
  Fabric& fabric = scene.cloths[0].fabric;
  fabric.area_density = 0.3;
  fabric.stretch = 200;
  fabric.shear = 100;
  fabric.damping = 5;
  fabric.friction = 0;
  fabric.thickness = 0.002;
  return scene;
}

// The sum of f l over all springs (J).
double virial_of_springs(const Simulation& simulation) {
  const reference::Points x = places_of(simulation);
  double sum = 0;
  for (const ParticleSpring& spring : simulation.fabric().springs) {
    const double l = (x[spring.b] - x[spring.a]).norm(), longer = l - double(spring.rest);
    if (longer > 0 || !spring.only_pulls) sum += double(spring.stiffness) * longer * l;
  }
  return sum;
}

TEST_F(PressureLaw, tension_balances_the_pressure_that_the_volume_has) {
  for (const Method method : {Method::implicit, Method::mass_spring, Method::verlet})
    for (const Gas& gas : {Gas{.rest_pressure = 200, .ambient = 1000}, Gas{.rest_pressure = 100, .ambient = 101325},
                           Gas{.rest_pressure = 60, .ambient = 0}}) {
      SCOPED_TRACE(testing::Message() << "method " << int(method) << ", ambient " << gas.ambient);
      const Mesh mesh = ball(0.2, 3);
      const auto simulation = must(Simulation::create(device(), rubber(gas, method), std::vector{mesh}));
      const double rest = volume_of(*simulation);
      run(*simulation, 4);
      const double v = volume_of(*simulation), measured = virial_of_springs(*simulation) / (3 * v);
      EXPECT_GT(v, rest) << "it has given way";
      // A volume in single precision is as good as its last digit, of which a stiff gas makes more.
      EXPECT_NEAR(measured, gauge(gas, rest, v), 0.01 * measured + 0x1p-22 * gas.ambient) << "volume " << v / rest << " of that at rest";
      RecordProperty("volume", std::to_string(v / rest));
    }
}

// Between a floor and a plate that comes down slowly and stops, on its way and after it.
TEST_F(PressureLaw, a_press_finds_the_pressure_that_the_volume_has) {
  const Gas gas{.rest_pressure = 100, .ambient = 2000};
  Scene scene = rubber(gas, Method::mass_spring);
  scene.reactions = true;
  const double thickness = scene.cloths[0].fabric.thickness;
  Collider lid = plane(0.42f, 0);
  lid.normal = {0, -1, 0};
  lid.keys = lowered({{1, 0}, {3, 0.09f}, {5, 0.09f}, {7, 0.18f}});
  scene.colliders = {plane(0, 0), lid};
  const auto simulation = must(Simulation::create(device(), scene, std::vector{ball(0.2, 3, {0, 0.21f, 0})}));
  const double rest = volume_of(*simulation);
  double before = INFINITY;
  for (const double height : {0.33, 0.24}) {
    run(*simulation, height > 0.3 ? 4.5 : 4);
    simulation->take_reactions();
    constexpr int kFrames = 30;
    run(*simulation, kFrames * kFrame);
    const auto told = simulation->take_reactions();
    const double lid_force = double(told[1].impulse.y) / (kFrames * kFrame), floor_force = -double(told[0].impulse.y) / (kFrames * kFrame);
    const double v = volume_of(*simulation), p = gauge(gas, rest, v);
    EXPECT_GT(lid_force, 0);
    EXPECT_NEAR(floor_force, lid_force, 0.01 * lid_force) << "nothing else pushes";
    const double measured = (virial_of_springs(*simulation) + lid_force * (height - 2 * thickness)) / (3 * v);
    EXPECT_LT(v, before);
    EXPECT_NEAR(measured, p, 0.02 * p) << "at " << height << " m, volume " << v / rest << " of that at rest";
    EXPECT_NEAR((measured + gas.ambient) * v, (gas.rest_pressure + gas.ambient) * rest, 0.005 * (gas.rest_pressure + gas.ambient) * rest);
    before = v;
  }
}

// With twice the gas the volume is up to twice as large, as far as the links let it; with none, the ambient closes on what is left.
TEST_F(PressureLaw, more_gas_takes_more_room_and_none_takes_none) {
  const Gas gas{.rest_pressure = 0, .ambient = 5000};
  Scene scene = rubber(gas, Method::implicit);
  scene.cloths[0].fabric.stretch = scene.cloths[0].fabric.shear = 20;   // hardly resists
  const auto simulation = must(Simulation::create(device(), scene, std::vector{ball(0.2, 3)}));
  const double rest = volume_of(*simulation);
  for (const double amount : {1.0, 2.0, 0.5}) {
    must(simulation->inflate(0, amount));
    run(*simulation, 4);
    EXPECT_NEAR(volume_of(*simulation) / rest, amount, 0.05 * amount);
  }
  must(simulation->inflate(0, 0));
  run(*simulation, 4);
  EXPECT_LT(std::abs(volume_of(*simulation)), 0.15 * rest);
}

}  // namespace
}  // namespace weft
