// The relaxing passes against their twins, stretch and bend, on random and on degenerate elements; and whole frames against
// all twins in order. What ends a substep (tethers, colliders, velocity) and what surrounds it is in tests/effects/motion/kernel_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/effects/triangle/triangle.h"
#include "engine/simulation.h"
#include "shaders/bend/bend.ref.h"
#include "shaders/collide/collide.ref.h"
#include "shaders/motion/motion.ref.h"
#include "shaders/stretch/stretch.ref.h"
#include "shaders/tether/tether.ref.h"
#include "shaders/triangle/gap.ref.h"
#include "tests/support/bodies.h"
#include "tests/support/single_pass.h"
#include "tests/support/supports.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Kernel = GpuTest;

reference::Averaged averaging(Averaging averaging) {
  return averaging == Averaging::mass_split ? reference::Averaged::mass_split : reference::Averaged::count;
}

Scene plain_scene(Averaging averaging, std::uint32_t iterations) {
  Scene scene = without_contacts();
  scene.solver.substeps = 1;
  scene.solver.rate = 600;
  scene.solver.iterations = iterations;
  scene.solver.averaging = averaging;
  scene.solver.relaxation = 1.1;
  scene.gravity = {0, 0, 0};
  return scene;
}

enum class Compliance { rigid, soft, mixed };

// Links of 0.05 to 1 m between random particles, a third of them only pulling; inverse masses 1 to 100.
std::vector<StretchLink> random_links(Random& random, std::uint32_t particles, std::uint32_t count, Compliance compliance) {
  std::vector<StretchLink> links;
  while (links.size() < count) {
    const auto a = static_cast<std::uint32_t>(random() % particles), b = static_cast<std::uint32_t>(random() % particles);
    if (a == b) continue;
    const bool rigid = compliance == Compliance::rigid || (compliance == Compliance::mixed && links.size() % 2 == 0);
    const auto alpha = rigid ? 0.f : static_cast<float>(std::pow(10, between(random, -7, -4)));
    links.push_back({a, b, static_cast<float>(between(random, 0.05, 1)), alpha, links.size() % 3 == 0});
  }
  return links;
}

// With one iteration a substep the GPU has 1 / (W_a + W_b + omega alpha / h^2) in 8 bits of mantissa; the twin gets the compliance that
// makes it so. That those bits are right is for links_test and fabric_test to say.
std::vector<reference::Stretch> twins_of(const Scene& scene, const CookedFabric& fabric) {
  std::vector<reference::Stretch> links;
  for (const StretchLink& link : fabric.links) {
    const double weight = double(fabric.split_weights[link.a]) + fabric.split_weights[link.b];
    const double compliance = link.gain > 0 ? fabric.h * fabric.h * (1.0 / link.gain - weight) / scene.solver.relaxation : link.compliance;
    links.push_back({link.a, link.b, link.rest, compliance, link.only_pulls});
  }
  return links;
}

// Runs all iterations of a substep on both sides. Returns the gap in m and the number of counted coincident ends less what the
// twin skipped (two ends a link and iteration).
struct Outcome {
  double gap = 0;
  int miscounted = 0;
};
Outcome compare_stretch(const compute::Device& device, const Scene& scene, const CookedFabric& fabric, bool gather_storage) {
  SinglePass passes(device, scene, fabric, gather_storage);
  passes.put_iterate(fabric.positions);
  passes.begin(frame_of(1));
  reference::Points twin = points(fabric.positions);
  const auto links = twins_of(scene, fabric);
  const auto masses = inverse_masses(fabric);
  std::vector<double> lambda(links.size());
  int skipped_ends = 0;
  for (std::uint32_t k = 0; k < scene.solver.iterations; ++k) {
    std::uint32_t skipped = 0;
    twin = reference::relax_stretch(links, twin, masses, lambda, fabric.h, scene.solver.relaxation, averaging(scene.solver.averaging),
                                    skipped);
    skipped_ends += 2 * static_cast<int>(skipped);
    passes.run("stretch", static_cast<int>(k));
  }
  return {largest_gap(passes.iterate(), twin), static_cast<int>(passes.counters().coincident) - skipped_ends};
}

TEST_F(Kernel, stretch_does_what_its_twin_does_on_random_links) {
  for (const Averaging averaging : {Averaging::mass_split, Averaging::count})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const Compliance compliance : {Compliance::rigid, Compliance::soft, Compliance::mixed}) {
        const auto seed = static_cast<std::uint64_t>(compliance) + 10 * iterations;
        const bool padded = iterations == 1 && compliance != Compliance::soft;   // rows of one length, or not
        Random random(seed);
        const Scene scene = plain_scene(averaging, iterations);
        CookedFabric fabric = loose_particles(random, 150, scene.solver);
        link_up(fabric, random_links(random, 150, 600, compliance), averaging, iterations, padded);
        const Outcome outcome = compare_stretch(device(), scene, fabric, seed % 2 == 0);
        // Lengths up to 3.5 m. Count-averaging lets the two ends of unlike mass overshoot, and each iteration carries the
        // error of the one before on.
        EXPECT_LT(outcome.gap, 40 * kRounding * 3.5 * iterations) << "averaging " << static_cast<int>(averaging) << ", compliance "
                                                                  << static_cast<int>(compliance) << ", " << iterations << " iterations";
        EXPECT_EQ(outcome.miscounted, 0);
      }
}

// What colliders hold goes less far; and a plane puts some out, and rubs by what was held, too. Then what they hold is renewed.
TEST_F(Kernel, stretch_moves_what_colliders_hold_as_its_twin_does) {
  for (const std::uint32_t iterations : {1u, 3u})
    for (const bool storage : {false, true}) {
      SCOPED_TRACE(std::to_string(iterations) + " iterations");
      Random random(50 + iterations);
      Scene scene = plain_scene(Averaging::mass_split, iterations);
      CookedFabric fabric = loose_particles(random, 150, scene.solver);
      link_up(fabric, random_links(random, 150, 600, Compliance::mixed), Averaging::mass_split, iterations);
      let_colliders_hold(scene, fabric);
      gpu::Collider ground{};
      ground.centre_from = ground.centre_to = {0, -0.2f, 0};
      ground.normal_from = ground.normal_to = {0, 1, 0};
      ground.friction = 0.5f;
      SinglePass passes(device(), scene, fabric, storage);
      passes.put_iterate(fabric.positions);
      FrameInput input = frame_of(1);
      input.colliders = std::span(&ground, 1);
      passes.begin(input);
      reference::Supports supports = put_supports(passes, random, fabric);
      const reference::Points x = points(fabric.positions);
      reference::Points twin = x;
      const auto links = twins_of(scene, fabric);
      const auto masses = inverse_masses(fabric);
      std::vector<double> lambda(links.size());
      double held = 0;
      int met = 0;
      for (std::uint32_t k = 0; k < iterations; ++k) {
        std::uint32_t skipped = 0;
        const auto free = reference::relax_stretch(links, twin, masses, lambda, fabric.h, scene.solver.relaxation,
                                                   reference::Averaged::mass_split, skipped);
        for (std::size_t i = 0; i < twin.size(); ++i) {
          if (masses[i] == 0) {
            supports.put_out[i].setZero();
            supports.held[i] = 0;
            continue;
          }
          twin[i] += supports.move(i, free[i] - twin[i]);
          held = std::max(held, (free[i] - twin[i]).norm());
          const gpu::Material& material = fabric.materials[i % 2];
          const reference::Body body = body_of(ground, ColliderShape::plane, 0, 1, material.friction);
          const reference::Vector& before = supports.put_out[i];
          const reference::Vector held_now = before.isZero(0) ? before : reference::Vector(supports.held[i] * before.normalized());
          const double depth = material.thickness - reference::signed_distance(body, twin[i]);
          twin[i] = reference::out_of_body(body, x[i], twin[i], material.thickness, held_now);
          met += depth > 0 && supports.held[i] != 0;
          const reference::Vector put_out = std::max(depth, 0.0) * reference::Vector::UnitY();
          supports.put_out[i] = reference::renewed(before, supports.held[i], put_out, k + 1 == iterations);
          supports.held[i] = 0;
        }
        passes.run("stretch", static_cast<int>(k));
      }
      EXPECT_GT(held, 1e-3) << "nothing to compare";
      EXPECT_GT(met, 5);
      EXPECT_LT(largest_gap(passes.iterate(), twin), 40 * kRounding * 3.5 * iterations);
      EXPECT_LT(largest_gap(passes.particles(buffers::supports), supports.put_out), 40 * kRounding * 3.5 * iterations);
      EXPECT_EQ(largest_gap_of_held(passes, supports), 0);
    }
}

TEST_F(Kernel, stretch_counts_coincident_ends_and_bears_slivers_and_anchors) {
  for (const std::uint32_t iterations : {1u, 3u})
    for (const Averaging averaging : {Averaging::mass_split, Averaging::count}) {
      Random random(77);
      const Scene scene = plain_scene(averaging, iterations);
      CookedFabric fabric = loose_particles(random, 64, scene.solver);
      std::vector<StretchLink> links = random_links(random, 64, 100, Compliance::mixed);
      // Held at both ends, rigid and soft: particles 3, 11, 19, 27 are held.
      links.push_back({3, 11, 0.5f, 0, false});
      links.push_back({19, 27, 0.1f, 1e-5f, false});
      // Ends at one place; both are held, so that they stay there over iterations.
      fabric.positions[3] = {0.25f, 0.5f, -0.125f, 0};
      fabric.positions[35] = fabric.positions[3];
      links.push_back({3, 35, 0.3f, 0, false});
      // A rest length of a micrometre between ends a micrometre apart, and one between ends a metre apart.
      fabric.positions[40] = fabric.positions[41];
      fabric.positions[40].x += 1e-6f;
      fabric.positions[40].w = 50;
      links.push_back({40, 41, 1e-6f, 0, false});
      links.push_back({50, 52, 1e-6f, 0, false});
      link_up(fabric, links, averaging, iterations);
      const Outcome outcome = compare_stretch(device(), scene, fabric, false);
      EXPECT_LT(outcome.gap, 40 * kRounding * 3.5 * iterations) << iterations << " iterations";
      EXPECT_EQ(outcome.miscounted, 0);
    }
}

TEST_F(Kernel, ends_that_fall_together_are_pushed_apart_and_counted) {
  Random random(5);
  const Scene scene = plain_scene(Averaging::mass_split, 1);
  CookedFabric fabric = loose_particles(random, 16, scene.solver);
  for (gpu::vec4& p : fabric.positions) p = {0.5f, 0.5f, 0.5f, p.w};
  link_up(fabric, random_links(random, 16, 40, Compliance::rigid), Averaging::mass_split);
  const Outcome outcome = compare_stretch(device(), scene, fabric, false);
  EXPECT_LT(outcome.gap, 40 * kRounding);
  EXPECT_EQ(outcome.miscounted, 0);
}

// A cloth whose points are shaken within the plane, so that stencils are irregular, and then crumpled.
struct Crumpled {
  Scene scene = without_contacts();
  CookedFabric fabric;
  std::vector<gpu::vec4> pose;
};

Crumpled crumpled(std::uint64_t seed, Averaging averaging, std::uint32_t iterations, Topology topology, double shake) {
  Random random(seed);
  Crumpled c;
  c.scene = plain_scene(averaging, iterations);
  c.scene.solver.method = Method::jacobi;
  Cloth& cloth = c.scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = 14, .cells_y = 11, .topology = topology};
  cloth.fabric.bend = std::pow(10, between(random, -5, -1));   // from limp to a board
  cloth.tethers = false;   // they would be fused into bend
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  std::vector<Mesh> meshes = must(make_meshes(c.scene));
  for (Vec3& p : meshes[0].points) {
    const gpu::vec4 d = anywhere(random, shake, 0);
    p = {p.x + d.x, p.y, p.z + d.z};
  }
  c.fabric = must(cook(c.scene, meshes));
  for (const gpu::vec4& x : c.fabric.positions) {
    const gpu::vec4 d = anywhere(random, 0.05, 0);
    c.pose.push_back({x.x + d.x, x.y + d.y, x.z + d.z, 0});
  }
  return c;
}

std::vector<reference::Bend> bends_of(const CookedFabric& fabric) {
  std::vector<reference::Bend> bends;
  for (const gpu::Bend& bend : fabric.bends)
    bends.push_back({{bend.particle[0], bend.particle[1], bend.particle[2], bend.particle[3]},
                     {bend.k[0], bend.k[1], bend.k[2], bend.k[3]}, bend.compliance});
  return bends;
}

double compare_bend(const compute::Device& device, const Crumpled& c, bool gather_storage) {
  SinglePass passes(device, c.scene, c.fabric, gather_storage);
  passes.put_iterate(c.pose);
  passes.begin(frame_of(1));
  reference::Points twin = points(c.pose);
  const auto bends = bends_of(c.fabric);
  std::vector<reference::Vector> lambda(bends.size(), reference::Vector::Zero());
  const auto masses = inverse_masses(c.fabric);
  for (std::uint32_t k = 0; k < c.scene.solver.iterations; ++k) {
    if (c.scene.solver.iterations == 1) {
      twin = reference::bend_in_one_step(bends, twin, masses, c.fabric.h);
      passes.run("bend");
    } else {
      twin = reference::relax_bend(bends, twin, masses, lambda, c.fabric.h, c.scene.solver.relaxation, averaging(c.scene.solver.averaging));
      passes.run("bend_lambda", static_cast<int>(k));
      passes.run("bend_gather", static_cast<int>(k));
    }
  }
  return largest_gap(passes.iterate(), twin);
}

TEST_F(Kernel, bend_does_what_its_twin_does_on_crumpled_sheets) {
  for (const Averaging averaging : {Averaging::mass_split, Averaging::count})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const Topology topology : {Topology::diagonal, Topology::centre}) {
        const Crumpled c = crumpled(3 * iterations + static_cast<std::uint64_t>(topology), averaging, iterations, topology, 0.02);
        // Poses within 1 m. A stencil's share of a particle is at most half the root of a mass ratio, which is below 10.
        EXPECT_LT(compare_bend(device(), c, iterations == 3), 64 * kRounding * iterations)
            << "averaging " << static_cast<int>(averaging) << ", topology " << static_cast<int>(topology) << ", " << iterations
            << " iterations";
      }
}

// Shaken by half a cell: angles down to nothing, triangles turned over, cotangents at their limit.
TEST_F(Kernel, bend_does_what_its_twin_does_on_slivers) {
  for (const std::uint32_t iterations : {1u, 3u}) {
    const Crumpled c = crumpled(9, Averaging::mass_split, iterations, Topology::diagonal, 0.036);
    EXPECT_FALSE(c.fabric.notes.empty()) << "no sliver among the triangles";
    // Masses of slivers differ by up to 1e4, so the largest share is about 50.
    EXPECT_LT(compare_bend(device(), c, false), 64 * 50 * kRounding * iterations);
  }
}

TEST_F(Kernel, stretch_does_what_its_twin_does_on_a_sheet_that_bends_too) {
  for (const std::uint32_t iterations : {1u, 3u}) {
    Crumpled c = crumpled(21, Averaging::mass_split, iterations, Topology::diagonal, 0.01);
    for (std::size_t i = 0; i < c.pose.size(); ++i) {
      c.pose[i].w = c.fabric.positions[i].w;
      c.fabric.positions[i] = c.pose[i];
    }
    EXPECT_LT(compare_stretch(device(), c.scene, c.fabric, true).gap, 40 * kRounding * iterations);
  }
}

constexpr double kBall = 0.3;   // m, its radius

// A frame as physics.md has it, by the twins alone. Colliders stand still.
void twin_frame(const Scene& scene, const CookedFabric& fabric, reference::Points& x, reference::Points& v) {
  const auto links = twins_of(scene, fabric);
  const auto bends = bends_of(fabric);
  const auto masses = inverse_masses(fabric);
  const auto& material = scene.cloths[0].fabric;
  const reference::Vector gravity(scene.gravity.x, scene.gravity.y, scene.gravity.z);
  // A triangle's corners on a sphere of the radius R are the root of R^2 - c^2 from its middle, c the radius of the smallest circle about it: at
  // most half of a cell's longer side here, and a tenth more where it is stretched. Where triangles do not collide vertices stand off by that.
  const bool triangles_collide = fabric.own.of<TriangleLists>().most_around > 0;
  const Grid& grid = *scene.cloths[0].grid;
  const double circle = 1.1 * 0.5 * std::max(double(grid.size.x) / grid.cells_x, double(grid.size.y) / grid.cells_y);
  const double stand_off = std::max(0.0, std::hypot(kBall, circle) - kBall - material.thickness);
  std::vector<reference::Body> bodies;
  for (const Collider& c : scene.colliders) {
    const reference::Vector centre(c.centre.x, c.centre.y, c.centre.z), normal(c.normal.x, c.normal.y, c.normal.z);
    bodies.push_back({.shape = static_cast<reference::Shape>(c.shape),
                      .centre_before = centre,
                      .centre_after = centre,
                      .normal_before = normal,
                      .normal_after = normal,
                      .radius = c.radius + (c.shape == ColliderShape::sphere && !triangles_collide ? stand_off : 0),
                      .friction = std::sqrt(c.friction * material.friction)});
  }
  for (std::uint32_t s = 0; s < substeps_of(scene.solver); ++s) {
    reference::Points p = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      p[i] = reference::predict({x[i], v[i]}, gravity, material.damping, fabric.h, masses[i] == 0).position;
    std::vector<double> stretch_lambda(links.size());
    std::vector<reference::Vector> bend_lambda(bends.size(), reference::Vector::Zero());
    for (std::uint32_t k = 0; k < scene.solver.iterations; ++k) {
      std::uint32_t skipped = 0;
      const reference::Averaged averaged = averaging(scene.solver.averaging);
      p = reference::relax_stretch(links, p, masses, stretch_lambda, fabric.h, scene.solver.relaxation, averaged, skipped);
      p = scene.solver.iterations == 1 ? reference::bend_in_one_step(bends, p, masses, fabric.h)
                                       : reference::relax_bend(bends, p, masses, bend_lambda, fabric.h, scene.solver.relaxation, averaged);
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (masses[i] == 0) continue;
        std::vector<reference::Tether> tethers;
        for (std::uint32_t t = 0; t < fabric.tethers_per_particle; ++t) {
          const gpu::Tether& tether = fabric.tethers[i * fabric.tethers_per_particle + t];
          if (tether.anchor != WEFT_NONE) tethers.push_back({p[tether.anchor], tether.max_distance});
        }
        p[i] = reference::within_tethers(tethers, p[i]);
      }
      const auto asked = triangles_collide ? reference::ask_triangles(bodies, fabric.triangles, x, p, masses, material.thickness)
                                           : std::vector<reference::Asked>(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (masses[i] == 0) continue;
        p[i] += asked[i].out_of + asked[i].friction;
        for (const reference::Body& body : bodies)
          p[i] = reference::out_of_body(body, x[i] + asked[i].out_of, p[i], material.thickness);
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = reference::velocity(x[i], p[i], fabric.h);
    x = p;
  }
}

TEST_F(Kernel, whole_frames_do_what_all_twins_do_in_order) {
  for (const Averaging averaging : {Averaging::mass_split, Averaging::count})
    for (const auto& [iterations, cells] : {std::pair(1u, 12u), std::pair(3u, 12u), std::pair(1u, 4u)}) {   // 4: triangles collide, too
      Scene scene = without_contacts();
      scene.solver.substeps = 4;
      scene.solver.iterations = iterations;
      scene.solver.averaging = averaging;
      scene.solver.relaxation = 1;
      Cloth& cloth = scene.cloths.emplace_back();
      cloth.grid = Grid{{1, 1}, cells, cells - 2, Topology::centre, false};
      cloth.transform.translate = {0, 0.31f, 0};
      cloth.fabric.bend = 1e-3;
      cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
      scene.colliders.emplace_back().centre = {0, 0.2f, 0};
      Collider& ball = scene.colliders.emplace_back();
      ball.shape = ColliderShape::sphere;
      ball.radius = kBall;
      const auto simulation = must(Simulation::create(device(), scene));
      const CookedFabric& fabric = simulation->fabric();
      reference::Points x = points(fabric.positions), v(x.size(), reference::Vector::Zero());
      for (int frame = 0; frame < 4; ++frame) {
        must(simulation->advance(1 / scene.solver.rate));
        twin_frame(scene, fabric, x, v);
      }
      // Rounding is carried through 16 substeps; a kick that a substep makes of it is h times a velocity of gap / h.
      EXPECT_LT(largest_gap(must(simulation->read_positions()), x), 40 * kRounding * 16 * iterations)
          << "averaging " << static_cast<int>(averaging) << ", " << iterations << " iterations";
    }
}

}  // namespace
}  // namespace weft
