// Second order in time: what it keeps, that its error falls with the square of the substep, and that nothing bounces or stays behind.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/support/ways.h"

namespace weft {
namespace {

using Bdf2 = GpuTest;

Scene in_second_order(Scene scene) {
  scene.solver.order = 2;
  return scene;
}

TEST_F(Bdf2, a_sheet_in_free_fall_follows_the_parabola) {
  const auto simulation = must(Simulation::create(device(), in_second_order(sheet(10))));
  for (int frame = 1; frame <= 60; ++frame) {
    must(simulation->advance(kFrame));
    const double t = frame * kFrame;
    EXPECT_NEAR(centre_of_mass(must(simulation->read_positions())).y, -0.5 * 9.81 * t * t, 1e-5 + 2e-5 * t * t) << frame;
    EXPECT_LT(strain_of(*simulation).max, 5e-5) << frame;
  }
}

// A sheet that falls through a medium, against the closed form: with half the substep a quarter of the error. In first order the velocity
// is exact, and the error is that of the way: half of it.
TEST_F(Bdf2, its_error_falls_with_the_square_of_the_substep) {
  const auto error_of = [&](std::uint32_t order, std::uint32_t substeps) {
    Scene scene = sheet(4);
    scene.solver.order = order;
    scene.solver.substeps = substeps;
    scene.cloths[0].fabric.damping = 4;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 0.5);
    const double c = 4, t = 0.5, g = -9.81, wanted = g / c * (t - (1 - std::exp(-c * t)) / c);
    return std::abs(centre_of_mass(must(simulation->read_positions())).y - wanted);
  };
  EXPECT_NEAR(error_of(2, 1) / error_of(2, 2), 4, 0.5);
  EXPECT_NEAR(error_of(1, 1) / error_of(1, 2), 2, 0.2);
  EXPECT_LT(error_of(2, 2), 0.1 * error_of(1, 2));
}

// Energy of motion (J) and angular momentum about the z axis through the origin (kg m^2 / s).
struct Turning {
  double energy = 0, momentum = 0;
};
Turning turning_of(const Simulation& simulation) {
  const auto x = must(simulation.read_positions()), v = must(simulation.read_velocities());
  Turning sum;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double m = 1 / double(x[i].w);
    sum.energy += 0.5 * m * (double(v[i].x) * v[i].x + double(v[i].y) * v[i].y + double(v[i].z) * v[i].z);
    sum.momentum += m * (double(x[i].x) * v[i].y - double(x[i].y) * v[i].x);
  }
  return sum;
}

// Of motion and height, over what a sheet of 1 m that hangs by an edge may fall by.
double energy_of(const Simulation& simulation) {
  const auto x = must(simulation.read_positions()), v = must(simulation.read_velocities());
  double energy = 0, mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].w == 0) continue;
    const double m = 1 / double(x[i].w);
    mass += m;
    energy += m * (0.5 * (double(v[i].x) * v[i].x + double(v[i].y) * v[i].y + double(v[i].z) * v[i].z) + 9.81 * double(x[i].y));
  }
  return energy / (mass * 9.81 * 0.5);
}

// At 6 rad/s for five seconds, in its own plane. In first order a fifth of the angular momentum and a third of the energy go.
TEST_F(Bdf2, a_free_sheet_that_turns_goes_on_turning) {
  for (const auto& [order, levels] : {std::pair(1u, false), {2u, false}, {2u, true}}) {
    Scene scene = sheet(24);
    scene.solver.order = order;
    scene.solver.method = Method::jacobi;
    scene.gravity = {0, 0, 0};
    scene.cloths[0].grid->upright = true;
    scene.cloths[0].start.imperfection = 0;
    scene.solver.levels = levels;
    const auto simulation = must(Simulation::create(device(), scene));
    auto velocities = must(simulation->read_velocities());
    const auto positions = must(simulation->read_positions());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      velocities[i].x = -6 * positions[i].y;
      velocities[i].y = 6 * positions[i].x;
    }
    must(simulation->write_velocities(velocities));
    const Turning start = turning_of(*simulation);
    run(*simulation, 5);
    const Turning end = turning_of(*simulation);
    const double momentum = end.momentum / start.momentum, energy = end.energy / start.energy;
    std::printf("order %u%s: %.4f of the angular momentum and %.4f of the energy are left\n", order, levels ? ", levels" : "", momentum,
                energy);
    if (order == 1) {
      EXPECT_LT(momentum, 0.85);
      EXPECT_LT(energy, 0.75);
    } else {
      EXPECT_NEAR(momentum, 1, 2e-3);
      EXPECT_NEAR(energy, 1, 1e-2);
    }
  }
}

// A sheet that swings down from the horizontal about one edge: what it has lost after 0.9 s, of the energy that it may fall by.
TEST_F(Bdf2, a_sheet_that_swings_loses_a_fraction_of_what_it_loses_in_first_order) {
  const auto lost = [&](std::uint32_t order, std::uint32_t substeps = 10) {
    Scene scene = sheet(24);
    scene.solver.order = order;
    scene.solver.substeps = substeps;
    Anchor& edge = scene.cloths[0].anchors.emplace_back();
    edge.box = Anchor::Box{{-1, -1, -0.501f}, {1, 1, -0.499f}};
    const auto simulation = must(Simulation::create(device(), scene));
    const double start = energy_of(*simulation);
    run(*simulation, 0.9);
    return start - energy_of(*simulation);
  };
  const double first = lost(1), finer = lost(1, 40), second = lost(2);
  std::printf("lost: %.4f in first order, %.4f with 40 substeps; %.4f in second\n", first, finer, second);
  EXPECT_GT(first, 0.05);
  EXPECT_LT(second, 0.3 * first);
  EXPECT_LT(second, finer);
  EXPECT_GT(second, -0.01);
}

// By the formula alone it would leave the floor at up to 5/4 of the speed with which it strikes. The heights are spread over the 4.1 mm
// that a substep goes there.
TEST_F(Bdf2, what_strikes_a_floor_stays_there) {
  for (const float height : {0.3f, 0.3007f, 0.3014f, 0.3021f, 0.3028f, 0.3035f}) {
    Scene scene = in_second_order(sheet(12));
    scene.cloths[0].transform.translate = {0, height, 0};
    scene.colliders = {plane(0)};
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 0.3);   // it strikes after 0.25 s
    const double thickness = scene.cloths[0].fabric.thickness;
    for (int frame = 0; frame < 30; ++frame) {
      must(simulation->advance(kFrame));
      for (const gpu::vec4& x : must(simulation->read_positions())) ASSERT_NEAR(x.y, thickness, 1e-4);
      ASSERT_LT(top_speed(*simulation), 2e-3);
    }
  }
}

// On an incline: where friction holds it does not creep, and without it goes as far as a block.
TEST_F(Bdf2, friction_is_coulombs) {
  for (const double friction : {0.0, 0.3, 1.0}) {
    Scene scene = in_second_order(sheet(8));
    const double slope = 30 * std::numbers::pi / 180;
    scene.cloths[0].fabric.friction = friction;
    scene.gravity = {static_cast<float>(9.81 * std::sin(slope)), static_cast<float>(-9.81 * std::cos(slope)), 0};
    scene.cloths[0].transform.translate = {0, static_cast<float>(scene.cloths[0].fabric.thickness), 0};
    scene.cloths[0].start.imperfection = 0;
    scene.colliders = {plane(0, friction)};
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 1);
    const double wanted = 0.5 * 9.81 * std::max(0.0, std::sin(slope) - friction * std::cos(slope));
    EXPECT_NEAR(centre_of_mass(must(simulation->read_positions())).x, wanted, 0.01 * wanted + 1e-4) << friction;
  }
}

// A sheet that hangs by two corners is thrown up, falls back and is caught by tethers and links at once. Formulas of second order throw
// back what is caught, but give nothing: at no time is there more energy than in the beginning.
TEST_F(Bdf2, what_tethers_catch_gains_no_energy) {
  for (const float speed : {1.f, 2.f, 3.f}) {
    Scene scene = in_second_order(sheet(20));
    scene.cloths[0].grid->upright = true;
    scene.cloths[0].anchors = {held_at({Corner::low_high, Corner::high_high})};
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 0.5);
    auto velocities = must(simulation->read_velocities());
    for (gpu::vec4& v : velocities) v.y += speed;
    must(simulation->write_velocities(velocities));
    const double start = energy_of(*simulation);
    double most = start;
    for (int frame = 0; frame < 180; ++frame) {
      must(simulation->advance(kFrame));
      most = std::max(most, energy_of(*simulation));
    }
    EXPECT_LT(most, start + 0.01) << speed << " m/s";
  }
}

// Held at four sides, nearly all links of its levels pull. It sags and swings as a drum does, and comes to rest.
TEST_F(Bdf2, a_taut_sheet_on_levels_comes_to_rest) {
  Scene scene = in_second_order(sheet(32));
  scene.solver.levels = true;
  scene.cloths[0].tethers = false;
  scene.cloths[0].fabric.damping = 3;
  for (const auto& [low, high] : {std::pair(Vec3{-1, -1, -0.51f}, Vec3{1, 1, -0.49f}), {Vec3{-1, -1, 0.49f}, Vec3{1, 1, 0.51f}},
                                  {Vec3{-0.51f, -1, -1}, Vec3{-0.49f, 1, 1}}, {Vec3{0.49f, -1, -1}, Vec3{0.51f, 1, 1}}})
    scene.cloths[0].anchors.emplace_back().box = Anchor::Box{low, high};
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 8);
  EXPECT_LT(top_speed(*simulation), 0.05);
}

// A sheet hangs by one edge, at rest, so that nothing changes its velocity. Then all of it is held, and let go: it falls by the parabola,
// as if it had never hung there. (What it keeps of hanging would make it slower by h g / 2.)
TEST_F(Bdf2, what_is_released_falls_by_the_parabola) {
  Scene scene = in_second_order(sheet(2));
  scene.cloths[0].fabric.damping = 4;
  scene.pins = 9;
  const auto simulation = must(Simulation::create(device(), scene));
  must(simulation->pin(std::vector<std::uint32_t>{0, 1, 2}));
  run(*simulation, 4);
  const std::vector<std::uint32_t> all{0, 1, 2, 3, 4, 5, 6, 7, 8};
  must(simulation->pin(all));
  run(*simulation, 0.1);
  Vec3 held;
  for (const Vec3& x : must(simulation->read_vertex_positions())) held = held + (1 / 9.f) * x;
  must(simulation->release(all));
  run(*simulation, 0.1);
  Vec3 fallen;
  for (const Vec3& x : must(simulation->read_vertex_positions())) fallen = fallen + (1 / 9.f) * x;
  const double c = 4, t = 0.1, wanted = -9.81 / c * (t - (1 - std::exp(-c * t)) / c);
  EXPECT_NEAR(fallen.y - held.y, wanted, 1e-4);   // 0.5 mm otherwise
}

// The host puts and throws cloth: it flies from there at that speed, as if it had never been elsewhere.
TEST_F(Bdf2, what_is_thrown_flies_at_that_speed) {
  const auto simulation = must(Simulation::create(device(), in_second_order(sheet(8))));
  run(*simulation, 0.5);
  auto positions = must(simulation->read_positions()), velocities = must(simulation->read_velocities());
  for (gpu::vec4& x : positions) x.x += 2, x.y = 3;
  for (gpu::vec4& v : velocities) v.x = 4, v.y = 2, v.z = 0;
  must(simulation->write_positions(positions));
  must(simulation->write_velocities(velocities));
  run(*simulation, 0.5);
  const Point end = centre_of_mass(must(simulation->read_positions()));
  EXPECT_NEAR(end.x, 4, 1e-4);
  EXPECT_NEAR(end.y, 3 + 1 - 0.5 * 9.81 * 0.25, 2e-4);
}

// A swinging sheet that is turned about the vertical at once goes on as if it had not been.
TEST_F(Bdf2, a_teleport_leaves_no_trace) {
  Scene scene = in_second_order(sheet(12));
  scene.cloths[0].anchors = {held_at({Corner::low_low, Corner::high_low})};
  scene.cloths[0].start.imperfection = 0;
  const auto stays = must(Simulation::create(device(), scene)), goes = must(Simulation::create(device(), scene));
  run(*stays, 0.5);
  run(*goes, 0.5);
  const float half = std::sqrt(0.5f);
  MovingFrame to;
  to.rotation = {0, half, 0, half};   // a quarter turn about y
  must(goes->teleport(0, MovingFrame{}, to));
  run(*stays, 0.1);
  run(*goes, 0.1);
  const auto a = must(stays->read_positions()), b = must(goes->read_positions());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(b[i].x, a[i].z, 5e-5);
    ASSERT_NEAR(b[i].y, a[i].y, 5e-5);
    ASSERT_NEAR(b[i].z, -a[i].x, 5e-5);
  }
}

TEST(SecondOrder, what_it_does_not_go_with_is_refused_by_name) {
  const auto fault_of = [](auto change) {
    Scene scene = in_second_order(sheet(4));
    change(scene);
    return order_fault(scene);
  };
  EXPECT_EQ(fault_of([](Scene&) {}), "");
  EXPECT_EQ(fault_of([](Scene& s) { s.solver.method = Method::jacobi, s.solver.iterations = 4; }), "");
  EXPECT_NE(fault_of([](Scene& s) { s.contacts.enabled = true; }).find("contacts"), std::string::npos);
  EXPECT_NE(fault_of([](Scene& s) { s.reactions = true; }).find("reactions"), std::string::npos);
  const std::string pushed = fault_of([](Scene& s) { s.colliders = {plane(0)}, s.solver.iterations = 3; });
  EXPECT_NE(pushed.find("solver.iterations is 3"), std::string::npos);
  const std::string constrained = fault_of([](Scene& s) { s.cloths[0].motion_constraints.emplace(), s.solver.iterations = 3; });
  EXPECT_NE(constrained.find("solver.iterations is 3"), std::string::npos);
  for (const std::uint32_t order : {0u, 3u})
    EXPECT_EQ(fault_of([&](Scene& s) { s.solver.order = order; }), std::to_string(order) + " is neither 1 nor 2");
  for (const Method method : {Method::automatic, Method::strands, Method::gauss_seidel, Method::chebyshev, Method::mass_spring,
                              Method::verlet, Method::implicit})
    EXPECT_NE(fault_of([&](Scene& s) { s.solver.method = method; }).find("solver.method is"), std::string::npos) << int(method);
}

}  // namespace
}  // namespace weft
