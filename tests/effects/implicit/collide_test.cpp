// What colliders decide of an implicit substep: the filtered equations against their twin (engine/reference/implicit.h), and sheets on
// planes that go where they go on the processor, and that friction holds.
#include <gtest/gtest.h>

#include <bit>

#include "tests/effects/implicit/columns.h"
#include "tests/support/sheets.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using reference::Columns;
using reference::ImplicitEquations;

using ImplicitFilter = GpuTest;

gpu::Collider at_rest(const Collider& plane) {
  gpu::Collider made{};
  made.centre_from = made.centre_to = {plane.centre.x, plane.centre.y, plane.centre.z};
  made.normal_from = made.normal_to = {plane.normal.x, plane.normal.y, plane.normal.z};
  return made;
}

// A crumpled sheet of 9 x 11 vertices, held by two corners, that three planes cut: a wall through its middle, an aslant one and the floor.
// So some particles are free, some meet one of them, some lie in an edge and a few in a corner.
struct Cornered {
  Scene scene = without_contacts();
  CookedFabric fabric;
  ImplicitEquations equations;
  Columns flight;   // before anything was met (m/s)

  Cornered(Linear linear, std::uint32_t iterations, unsigned seed, bool levels = false) {
    scene.solver = {.rate = 100, .substeps = 1, .iterations = iterations, .method = Method::implicit, .linear = linear, .levels = levels};
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.8f, 1}, 8, 10, Topology::diagonal, true};
    cloth.tethers = false;
    cloth.springs = Springs{{5, 0.02}, {4, 0.01}, {0.5, 0.001}};
    cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
    for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{0.8f, 0, 0.6f}, Vec3{0, 1, 0}}) scene.colliders.emplace_back().normal = normal;
    scene.colliders[1].centre = {-0.1f, 0, 0};
    scene.colliders[2].centre = {0, -0.2f, 0};
    fabric = must(cook(scene, must(make_meshes(scene))));
    Random random(seed);
    fabric.positions = moved(random, fabric, 0.02);
    for (gpu::vec4& v : fabric.velocities) v = anywhere(random, 0.5, v.w);
    for (const AnchorTarget& anchor : fabric.anchors) fabric.velocities[anchor.particle] = {0, 0, 0, fabric.velocities[anchor.particle].w};
    equations = must(reference::ImplicitSystem::create(scene, fabric)).assemble();
    flight = Columns::Zero(3, equations.flight.cols());
    for (Eigen::Index i = 0; i < flight.cols(); ++i) {
      const gpu::vec4& v = fabric.velocities[static_cast<std::size_t>(i)];
      if (fabric.positions[static_cast<std::size_t>(i)].w > 0)
        flight.col(i) = fabric.materials[std::bit_cast<std::uint32_t>(v.w)].damping_factor *
                        (vector(v) + fabric.h * vector({scene.gravity.x, scene.gravity.y, scene.gravity.z, 0}));
    }
  }

  // What predict leaves behind, then the passes up to the solve.
  SinglePass passes(const compute::Device& device, bool gather_storage) const {
    SinglePass passes(device, scene, fabric, gather_storage);
    std::vector<gpu::vec4> driven = fabric.velocities;
    for (std::size_t i = 0; i < driven.size(); ++i) {
      const auto v = flight.col(static_cast<Eigen::Index>(i));
      driven[i] = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), driven[i].w};
    }
    passes.put(buffers::velocities, driven);
    std::vector<gpu::Collider> planes;
    for (const Collider& plane : scene.colliders) planes.push_back(at_rest(plane));
    FrameInput input = frame_of(1);
    input.gravity = scene.gravity;
    input.colliders = planes;
    passes.begin(input);
    passes.run("implicit_assemble");
    passes.run("implicit_filter");
    return passes;
  }

  // How many particles are left so many directions.
  std::ptrdiff_t left_with(int directions) const {
    return std::count_if(equations.filter.begin(), equations.filter.end(),
                         [&](const reference::Matrix& s) { return std::lround(s.trace()) == directions; });
  }
};

TEST_F(ImplicitFilter, filtered_equations_are_those_of_the_twin) {
  for (const bool gather_storage : {false, true}) {
    const Cornered sheet(Linear::cg, 1, 3);
    for (const int directions : {0, 1, 2, 3})
      ASSERT_GT(sheet.left_with(directions), directions == 0 ? 2 : 0) << directions << " directions are left";
    const SinglePass passes = sheet.passes(device(), gather_storage);
    const std::size_t n = sheet.fabric.positions.size();
    const auto filters = passes.get<gpu::vec4>(buffers::collider_filters, 2 * n);
    // Heights are rounded, and divided by h.
    const double rounding = 4 * kRounding / sheet.fabric.h;
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      EXPECT_LT((vector(filters[2 * i + 1]) - (sheet.equations.flight.col(k) - sheet.flight.col(k))).norm(), rounding) << i;
      const reference::Vector v(0.3, -0.5, 0.7), direction = vector(filters[2 * i]);
      const double s = filters[2 * i].w;
      EXPECT_LT((s * v + (1 - 2 * s) * direction.dot(v) * direction - sheet.equations.filter[i] * v).norm(), 16 * kRounding) << i;
    }
    const Columns right = columns(passes.get<gpu::vec4>(buffers::solve_vectors, n), 0, n);
    EXPECT_LT(largest(right - sheet.equations.right), (kSummed + rounding) * largest(sheet.equations.right));
    const Columns guess = columns(passes.get<gpu::vec4>(buffers::exchanged, n), 0, n);
    EXPECT_LT(largest(guess - sheet.equations.guess), 32 * kRounding);
  }
}

TEST_F(ImplicitFilter, a_filtered_solve_goes_where_its_twin_goes) {
  for (const auto& [linear, levels] : {std::pair(Linear::cg, false), {Linear::cg, true}, {Linear::jacobi, false}})
    for (const std::uint32_t iterations : {2u, 5u, 40u}) {
      const Cornered sheet(linear, iterations, 4, levels);
      ASSERT_EQ(sheet.fabric.own.of<LevelLists>().ends.empty(), !levels);
      SinglePass passes = sheet.passes(device(), iterations == 5);
      const bool jacobi = linear == Linear::jacobi;
      for (std::uint32_t k = 0; k < iterations; ++k) {
        const int dispatch = static_cast<int>(k);
        if (jacobi) passes.run("implicit_relax", dispatch);
        else iterate_gradients(passes, dispatch, sheet.fabric);
      }
      const std::size_t n = sheet.fabric.positions.size();
      const Columns got = jacobi ? columns(passes.get<gpu::vec4>(buffers::exchanged, 3 * n), n * ((iterations - 1) % 3), n)
                                 : columns(passes.get<gpu::vec4>(buffers::solve_vectors, 2 * n), n, n);
      const Columns wanted = (jacobi ? solve_jacobi(sheet.equations, iterations, sheet.fabric.jacobi_weight)
                                     : solve_conjugate_gradients(sheet.equations, iterations))
                                 .change;
      // As without colliders (tests/effects/implicit/kernel_test.cpp).
      EXPECT_LT((got - wanted).norm(), 1e-3 * wanted.norm()) << (jacobi ? "jacobi " : levels ? "cg on levels " : "cg ") << iterations;
    }
}

// A sheet of springs with 24 neighbours, h = 0.01 s, over a plane.
Scene over_a_plane(const Collider& plane, Linear linear) {
  Scene scene = sheet(10);
  scene.solver = {.rate = 100, .substeps = 1, .iterations = 20, .method = Method::implicit, .linear = linear};
  Cloth& cloth = scene.cloths[0];
  cloth.tethers = false;
  cloth.springs = Springs{{500, 0.01}, {500, 0.01}, {5, 0.001}};
  cloth.fabric.friction = plane.friction;
  scene.colliders = {plane};
  return scene;
}

// Held by a corner above the floor, so that part of it lies and part of it hangs.
TEST_F(ImplicitFilter, a_sheet_that_falls_on_a_plane_goes_where_it_goes_on_the_processor) {
  for (const Linear linear : {Linear::cg, Linear::jacobi}) {
    Scene scene = over_a_plane(plane(-0.05f, 0), linear);
    scene.cloths[0].anchors.push_back(held_at({Corner::low_low}));
    const auto simulation = must(Simulation::create(device(), scene));
    reference::ImplicitSystem system = must(reference::ImplicitSystem::create(scene, simulation->fabric()));
    double gap = 0, lowest = 1;
    for (int k = 0; k < 40; ++k) {
      must(simulation->advance(0.01));
      system.step();
      for (const gpu::vec4& p : must(simulation->read_positions())) lowest = std::min<double>(lowest, p.y);
    }
    const auto positions = must(simulation->read_positions());
    for (std::size_t i = 0; i < positions.size(); ++i)
      gap = std::max(gap, (vector(positions[i]) - system.positions.col(static_cast<Eigen::Index>(i))).norm());
    const double surface = -0.05 + scene.cloths[0].fabric.thickness;
    EXPECT_LT(std::abs(system.positions.row(1).minCoeff() - surface), 1e-9) << "it never fell as far as the plane";
    EXPECT_GT(lowest, surface - 1e-6);
    // Rounding of 6e-8 in every step, which a sheet that buckles enlarges.
    EXPECT_LT(gap, 1e-4) << (linear == Linear::cg ? "cg" : "jacobi");
  }
}

// Cotton is stiff and light, so the solve has to know the collider. With particles pushed out of the floor only after the solve, this
// sheet was a heap that shook at 15 m/s, strained by 15 %.
TEST_F(ImplicitFilter, a_stiff_sheet_that_falls_aslant_on_the_floor_spreads_out_and_comes_to_rest) {
  Scene scene = over_a_plane(plane(-0.7f), Linear::cg);
  Cloth& cloth = scene.cloths[0];
  cloth.springs.reset();
  cloth.grid = Grid{{1, 1}, 16, 16, Topology::diagonal, true};
  cloth.transform = {.translate = {}, .axis = {0.957826f, 0, 0.287348f}, .degrees = 50, .scale = 1};
  cloth.fabric.damping = 0.5;
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 2, 0.01);
  EXPECT_LT(strain_of(*simulation).rms, 0.03);
  EXPECT_LT(top_speed(*simulation), 0.5);
}

// Slope 1 : 2. Friction follows from the way out of a collider, which the solve must not have gone already.
TEST_F(ImplicitFilter, friction_holds_a_sheet_on_an_incline_or_lets_it_slide) {
  for (const bool sticks : {true, false}) {
    Collider incline = plane(0, sticks ? 0.55 : 0.45);
    incline.normal = {-1 / std::sqrt(5.f), 2 / std::sqrt(5.f), 0};
    Scene scene = over_a_plane(incline, Linear::cg);
    scene.cloths[0].transform.axis = {0, 0, 1};
    scene.cloths[0].transform.degrees = std::atan(0.5) * 180 / 3.14159265358979;
    scene.cloths[0].transform.translate = {-0.002f / std::sqrt(5.f), 0.004f / std::sqrt(5.f), 0};
    const auto simulation = must(Simulation::create(device(), scene));
    const Point start = centre_of_mass(must(simulation->read_positions()));
    run(*simulation, 1, 0.01);
    const Point end = centre_of_mass(must(simulation->read_positions()));
    const double way = std::hypot(end.x - start.x, end.y - start.y);
    // Sliding: half of (sin - 0.45 cos) g.
    if (sticks) EXPECT_LT(way, 1e-3);
    else EXPECT_NEAR(way / (0.5 * 9.81 * (1 - 0.45 * 2) / std::sqrt(5.0)), 1, 0.05);
  }
}

}  // namespace
}  // namespace weft
