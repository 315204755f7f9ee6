// What surrounds the relaxing passes against its twins: predict, anchor, what finalize does (tethers, the velocity and the
// next prediction; colliders stand in tests/effects/collide/kernel_test.cpp) and surface, on random and degenerate particles.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "engine/simulation.h"
#include "shaders/anchor/anchor.ref.h"
#include "shaders/motion/motion.ref.h"
#include "shaders/surface/surface.ref.h"
#include "shaders/tether/tether.ref.h"
#include "tests/support/single_pass.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using MotionKernel = GpuTest;

TEST_F(MotionKernel, predict_does_what_its_twin_does_and_leaves_anchors_alone) {
  for (const bool gather_storage : {false, true}) {
    Random random(1);
    const Scene scene = loose_scene(12);
    const CookedFabric fabric = loose_particles(random, 300, scene.solver);
    SinglePass passes(device(), scene, fabric, gather_storage);
    passes.begin(falling(12));
    passes.run("predict");
    const auto predicted = passes.iterate(), velocities = passes.particles(buffers::velocities);
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      const bool held = fabric.positions[i].w == 0;
      const reference::Motion now{vector(fabric.positions[i]), vector(fabric.velocities[i])};
      const auto wanted = reference::predict(now, kGravity, kDampings[i % 2], fabric.h, held);
      EXPECT_LT((vector(predicted[i]) - wanted.position).norm(), 4 * kRounding * 1.8);
      if (!held) {
        EXPECT_LT((vector(velocities[i]) - wanted.velocity).norm(), 8 * kRounding * 3.5);
      }
      EXPECT_EQ(predicted[i].w, fabric.iterate_weights[i]);
      EXPECT_EQ(std::memcmp(&velocities[i].w, &fabric.velocities[i].w, 4), 0);   // the material's index stays
    }
  }
}

// Where finalize must put particles, and with what velocity and prediction it must go on.
void expect_finalized(const SinglePass& passes, const CookedFabric& fabric, const reference::Points& wanted, bool last_substep,
                      double gap) {
  const auto positions = passes.particles(buffers::positions), velocities = passes.particles(buffers::velocities), next = passes.iterate();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    ASSERT_LT((vector(positions[i]) - wanted[i]).norm(), gap) << "particle " << i;
    if (fabric.positions[i].w == 0) {
      ASSERT_EQ(vector(positions[i]), vector(fabric.positions[i]));
      continue;
    }
    const auto speed = reference::velocity(vector(fabric.positions[i]), wanted[i], fabric.h);
    auto after = reference::predict({wanted[i], speed}, kGravity, kDampings[i % 2], fabric.h, false);
    if (last_substep) after = {wanted[i], speed};
    ASSERT_LT((vector(velocities[i]) - after.velocity).norm(), 2 * gap / fabric.h) << "particle " << i;
    ASSERT_LT((vector(next[i]) - after.position).norm(), 3 * gap) << "particle " << i;
  }
}

TEST_F(MotionKernel, an_untouched_particle_ends_a_substep_as_its_twin_does) {
  for (const std::uint32_t substeps : {1u, 3u}) {
    Random random(2);
    const Scene scene = loose_scene(substeps);
    const CookedFabric fabric = loose_particles(random, 300, scene.solver);
    const auto p = moved(random, fabric, 0.05);
    SinglePass passes(device(), scene, fabric);
    passes.put(buffers::velocities, leading_to(p, fabric));
    passes.put_iterate(p);
    passes.begin(falling(substeps));
    passes.run("stretch");   // of no links: what is left is finalize
    expect_finalized(passes, fabric, points(p), substeps == 1, 16 * kRounding);
  }
}

// Up to `places` tethers for each particle that can move, to anchors among the fabric's; the twins of each.
std::vector<std::vector<reference::Tether>> tie(CookedFabric& fabric, std::uint32_t places, Random& random) {
  const auto particles = static_cast<std::uint32_t>(fabric.positions.size());
  std::vector<std::vector<reference::Tether>> twins(particles);
  fabric.tethers_per_particle = places;
  for (std::uint32_t i = 0; i < particles; ++i) {
    const std::uint32_t count = fabric.positions[i].w == 0 ? 0 : i % (places + 1);
    for (std::uint32_t k = 0; k < places; ++k) {
      const auto anchor = 3 + 8 * static_cast<std::uint32_t>(random() % (particles / 8));   // each eighth particle is held
      // Half are slack; one in 50 must bring its particle to the anchor itself.
      const float max_distance = random() % 50 == 0 ? 0.f : static_cast<float>(between(random, 0.2, 3));
      fabric.tethers.push_back(k < count ? gpu::Tether{anchor, max_distance} : gpu::Tether{WEFT_NONE, 0});
      if (k < count) twins[i].push_back({vector(fabric.positions[anchor]), max_distance});
    }
  }
  return twins;
}

TEST_F(MotionKernel, tethers_do_what_their_twin_does_for_none_to_eight_a_particle) {
  for (const std::uint32_t places : {2u, 4u, 8u})
    for (const bool gather_storage : {false, true}) {
      Random random(places);
      const Scene scene = loose_scene(4);
      CookedFabric fabric = loose_particles(random, 400, scene.solver);
      const auto twins = tie(fabric, places, random);
      const auto p = moved(random, fabric, 0.1);
      reference::Points wanted;
      for (std::size_t i = 0; i < p.size(); ++i) wanted.push_back(reference::within_tethers(twins[i], vector(p[i])));
      SinglePass passes(device(), scene, fabric, gather_storage);
      passes.put(buffers::velocities, leading_to(p, fabric));
      passes.put_iterate(p);
      passes.begin(falling(4));
      passes.run("stretch");
      expect_finalized(passes, fabric, wanted, false, 32 * kRounding * 3.5);   // 3.5 m: the longest way to an anchor
    }
}

// In an iteration that is not a substep's last, so that nothing but tethers asks for the bound.
TEST_F(MotionKernel, with_contacts_tethers_take_up_a_share_of_the_displacement_bound_as_their_twin_does) {
  for (const auto& [gather_storage, meshes] : {std::pair(false, false), {true, false}, {true, true}}) {
    const double share = meshes ? reference::kTetherShareNearMeshes : reference::kTetherShare;
    Random random(9);
    Scene scene = loose_scene(4);
    scene.solver.iterations = 2;
    scene.contacts.enabled = true;
    scene.contacts.capacity = 16;
    CookedFabric fabric = loose_particles(random, 400, scene.solver);
    fabric.rest = fabric.positions;   // contacts are for fabrics that have a surface
    fabric.triangles = {{0, 1, 2}};
    fabric.cloth_triangles = 1;
    fabric.edges = {{0, 1}};
    fabric.mean_edge = 1;
    if (meshes) fabric.collider_meshes.emplace_back();   // of no vertices
    const auto twins = tie(fabric, 4, random);
    const auto p = moved(random, fabric, 0.1);
    std::vector<std::uint32_t> bounds;
    reference::Points wanted;
    int cut = 0, whole = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const float bound = i % 7 == 0 ? 0 : static_cast<float>(between(random, 0, 0.8 / share));   // m
      bounds.push_back(std::bit_cast<std::uint32_t>(bound) | (i % 3 == 0 ? WEFT_PAIRED : 0));
      const float kept = std::bit_cast<float>(bounds.back() & ~WEFT_PAIRED);
      const reference::Vector way = reference::within_tethers(twins[i], vector(p[i])) - vector(p[i]);
      wanted.push_back(vector(p[i]) + reference::share_of(way, kept, share));
      if (way.norm() > 0) ++(way.norm() > share * kept ? cut : whole);
    }
    EXPECT_GT(cut, 20);
    EXPECT_GT(whole, 20);
    SinglePass passes(device(), scene, fabric, gather_storage);
    passes.put(buffers::velocities, leading_to(p, fabric));
    passes.put(buffers::displacement_bounds, bounds);
    passes.put_iterate(p);
    passes.begin(falling(4));
    passes.run("stretch");
    EXPECT_LT(largest_gap(passes.iterate(), wanted), 32 * kRounding * 3.5);
  }
}

TEST_F(MotionKernel, a_particle_that_turns_non_finite_is_put_back_and_counted) {
  Random random(4);
  const Scene scene = loose_scene(1);
  const CookedFabric fabric = loose_particles(random, 64, scene.solver);
  auto p = moved(random, fabric, 0.01);
  p[0].y = NAN;
  p[1].x = INFINITY;
  p[2].z = 1e30f;
  SinglePass passes(device(), scene, fabric);
  passes.put(buffers::velocities, leading_to(moved(random, fabric, 0.01), fabric));
  passes.put_iterate(p);
  passes.begin(frame_of(1));
  passes.run("stretch");
  const auto positions = passes.particles(buffers::positions), velocities = passes.particles(buffers::velocities);
  for (std::size_t i : {0u, 1u, 2u}) {
    EXPECT_EQ(vector(positions[i]), vector(fabric.positions[i]));
    EXPECT_EQ(vector(velocities[i]), reference::Vector(0, 0, 0));
  }
  EXPECT_EQ(passes.counters().non_finite, 3u);
}

TEST_F(MotionKernel, anchors_go_straight_to_their_targets_and_arrive_to_the_bit) {
  Random random(5);
  const Scene scene = loose_scene(7);
  CookedFabric fabric = loose_particles(random, 200, scene.solver);
  std::vector<gpu::Anchor> anchors;
  for (std::uint32_t i = 3; i < 200; i += 8) {
    const gpu::vec4& x = fabric.positions[i];
    const gpu::vec4 to = anywhere(random, 10, 0);
    anchors.push_back({i, {x.x, x.y, x.z}, {to.x, to.y, to.z}});
    fabric.anchors.push_back({0, 0, i, i, {x.x, x.y, x.z}});
  }
  SinglePass passes(device(), scene, fabric);
  FrameInput input = frame_of(7);
  input.anchors_move = true;
  input.anchors = anchors;
  passes.begin(input);
  passes.run("predict");
  for (int s = 0; s < 7; ++s) {
    passes.run("anchor", s);
    const auto iterate = passes.iterate();
    for (const gpu::Anchor& anchor : anchors) {
      const auto wanted = reference::anchor_at(vector(anchor.from), vector(anchor.to), (s + 1) / 7.0);
      EXPECT_LT((vector(iterate[anchor.particle]) - wanted).norm(), 8 * kRounding * 18);   // up to 10 m in each direction
      EXPECT_EQ(iterate[anchor.particle].w, 0);
    }
    passes.run("stretch", s);
  }
  const auto positions = passes.particles(buffers::positions);
  for (const gpu::Anchor& anchor : anchors) EXPECT_EQ(std::memcmp(&positions[anchor.particle], &anchor.to, sizeof anchor.to), 0);
}

// Cloth has held them back by up to 3 cm, some of them beyond the kinematic lag limit.
TEST_F(MotionKernel, anchors_that_were_held_back_go_after_their_targets_also_when_those_have_stopped) {
  Random random(6);
  Scene scene = loose_scene(5);
  scene.contacts.enabled = true;
  CookedFabric fabric = loose_particles(random, 400, scene.solver);
  for (const gpu::vec4& x : fabric.positions) fabric.rest.push_back({x.x, x.y, x.z, 0.002f});
  fabric.triangles = {{0, 1, 2}};
  fabric.cloth_triangles = 1;
  fabric.edges = {{0, 1}};
  std::vector<gpu::Anchor> anchors;
  for (std::uint32_t i = 3; i < 400; i += 8) {
    const gpu::vec4& x = fabric.positions[i];
    const gpu::vec4 behind = anywhere(random, 0.02, 0), way = anywhere(random, 0.02, 0);
    const gpu::vec3 from{x.x + behind.x, x.y + behind.y, x.z + behind.z};
    anchors.push_back({i, from, {from.x + way.x, from.y + way.y, from.z + way.z}});
    fabric.anchors.push_back({0, 0, i, i, {x.x, x.y, x.z}});
  }
  FrameInput input = frame_of(5);
  input.anchors = anchors;
  int waited = 0, beyond_limit = 0;
  const auto go_after = [&](SinglePass& passes, bool moves, double recover) {
    input.anchors_move = moves;
    passes.begin(input);
    for (int s = 0; s < 5; ++s) {
      passes.run("anchor", s);
      const auto iterate = passes.iterate();
      for (const gpu::Anchor& anchor : anchors) {
        const auto from = vector(anchor.from), to = vector(anchor.to), x = vector(fabric.positions[anchor.particle]);
        const auto target = reference::anchor_at(from, to, moves ? (s + 1) / 5.0 : 1);
        const double lag = (reference::anchor_at(from, to, moves ? s / 5.0 : 1) - x).norm(), limit = scene.contacts.kinematic_lag_limit;
        const auto wanted = reference::anchor_after(target, x, moves ? (to - from).norm() / 5 : 0, lag, recover, 0.002, limit);
        EXPECT_LT((vector(iterate[anchor.particle]) - wanted).norm(), 16 * kRounding * 2)
            << "substep " << s << " of anchor " << anchor.particle;
        const auto lags = passes.get<std::uint32_t>(buffers::kinematic_lags, 400);
        EXPECT_NEAR(std::bit_cast<float>(lags[anchor.particle]), lag, 16 * kRounding * 2);
        waited += wanted != target;
        beyond_limit += lag > limit * 0.002;
      }
    }
  };
  for (const auto& [recover, kinematic_lag_limit] : {std::pair(0.25, 8.0), std::pair(0.0, 12.0)}) {   // m/s, thicknesses
    scene.contacts.recover = recover;
    scene.contacts.kinematic_lag_limit = kinematic_lag_limit;
    SinglePass passes(device(), scene, fabric);
    double tracking_error = 0;
    for (const gpu::Anchor& anchor : anchors)
      tracking_error = std::max(tracking_error, (vector(anchor.from) - vector(fabric.positions[anchor.particle])).norm());
    go_after(passes, true, recover * fabric.h);
    EXPECT_GE(std::bit_cast<float>(passes.counters().tracking_error), tracking_error * (1 - 1e-6));
    go_after(passes, false, recover * fabric.h);
    for (const gpu::Anchor& anchor : anchors)
      tracking_error = std::max(tracking_error, (vector(anchor.to) - vector(fabric.positions[anchor.particle])).norm());
    EXPECT_NEAR(std::bit_cast<float>(passes.counters().tracking_error), tracking_error, 16 * kRounding * 2);
  }
  EXPECT_GT(waited, 100);
  EXPECT_GT(beyond_limit, 100);
}

// A tube whose two ends of the picture meet in a seam: render vertices double there, points do not.
Mesh tube() {
  RenderMesh render;
  constexpr std::uint32_t kRound = 16, kRows = 9;
  for (std::uint32_t j = 0; j <= kRows; ++j)
    for (std::uint32_t i = 0; i <= kRound; ++i) {
      const double angle = 2 * 3.14159265358979 * (i % kRound) / kRound;
      render.positions.push_back({static_cast<float>(std::cos(angle)), 0.2f * static_cast<float>(j), static_cast<float>(std::sin(angle))});
      render.uvs.push_back({static_cast<float>(i) / kRound, static_cast<float>(j) / kRows});
    }
  for (std::uint32_t j = 0; j < kRows; ++j)
    for (std::uint32_t i = 0; i < kRound; ++i) {
      const std::uint32_t a = j * (kRound + 1) + i, b = a + 1, c = a + kRound + 1, d = c + 1;
      render.triangles.push_back({a, c, b});
      render.triangles.push_back({b, c, d});
    }
  return must(weld_mesh(std::move(render)));
}

TEST_F(MotionKernel, surface_does_what_its_twin_does_and_gives_a_seam_one_normal) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().mesh = "tube";
  const Mesh mesh = tube();
  ASSERT_LT(mesh.points.size(), mesh.render.positions.size()) << "no seam";
  for (const bool gather_storage : {false, true}) {
    Random random(6);
    SimulationOptions options;
    options.gather_storage = gather_storage;
    const auto simulation = must(Simulation::create(device(), scene, {mesh}, options));
    auto pose = must(simulation->read_positions());
    for (gpu::vec4& p : pose) {
      const gpu::vec4 d = anywhere(random, 0.1, 0);
      p = {p.x + d.x, p.y + d.y, p.z + d.z, p.w};
    }
    must(simulation->write_positions(pose));
    const auto positions = must(simulation->read_vertex_positions()), normals = must(simulation->read_vertex_normals());
    const CookedFabric& fabric = simulation->fabric();
    const auto wanted = reference::point_normals(points(pose), fabric.triangles);
    ASSERT_EQ(normals.size(), mesh.render.positions.size());
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const std::uint32_t particle = fabric.surface_rows[v].x;
      EXPECT_EQ(positions[v], (Vec3{pose[particle].x, pose[particle].y, pose[particle].z}));
      // Areas about 0.04 m^2 from coordinates up to 2 m; opposite triangles of the crumpled tube cancel to a tenth.
      EXPECT_LT((reference::Vector(normals[v].x, normals[v].y, normals[v].z) - wanted[particle]).norm(), 16 * kRounding * 2 / 0.04);
      for (std::size_t u = 0; u < v; ++u)
        if (fabric.surface_rows[u].x == particle) {
          EXPECT_EQ(normals[u], normals[v]);
        }
    }
  }
}

}  // namespace
}  // namespace weft
