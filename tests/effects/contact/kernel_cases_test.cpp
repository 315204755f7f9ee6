// The contact passes in edge cases: displacement bounds, colliders, sides without a distance or without extent, predictions that are
// not finite, more layers than passes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/contact_passes.h"

namespace weft {
namespace {

using ContactEdgeCase = GpuTest;

// What the detection left for every particle: a predicted trajectory, the displacement bound about it, and the steps since then.
void put_bound(Passes& passes, std::size_t particles, const gpu::vec4& detected, const gpu::vec4& trajectory, float bound,
               std::uint32_t steps, bool paired = true) {
  passes.put(buffers::detected_positions, std::vector<gpu::vec4>(particles, detected));
  passes.put(buffers::trajectories, std::vector<gpu::vec4>(particles, trajectory));
  passes.put(buffers::displacement_bounds, std::vector<std::uint32_t>(particles, std::bit_cast<std::uint32_t>(bound) | (paired ? WEFT_PAIRED : 0)));
  auto detection = passes.detection();
  detection.steps = steps;
  passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
}

// The software driver would end its loops, and leave the rest of the contacts undone.
TEST_F(ContactEdgeCase, contacts_that_are_too_many_for_one_workgroup_make_their_particles_wait) {
  Random random(18);
  Tufts t = reference::tufts(random, 20, 12, 0.5);
  const std::vector<reference::Pair> pairs = t.pairs;
  while (t.pairs.size() < 1'000'000) t.pairs.insert(t.pairs.end(), pairs.begin(), pairs.end());
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  FrameInput input = frame_of(1);
  input.few_contacts = true;
  passes.begin(input);
  const auto before = points(passes.iterate());
  for (const char* pass : {"contact_prepare", "contact_alone"}) passes.run(pass);
  EXPECT_EQ(passes.detection().falls_back, WEFT_ALL_WAIT);
  EXPECT_EQ(passes.detection().needs_detection, 1u);
  EXPECT_EQ(passes.counters().contacts_overflowed, t.pairs.size());
  EXPECT_EQ(points(passes.iterate()), before);
  passes.run("contact_finalize");
  const auto ended = passes.particles(buffers::positions);
  for (std::size_t i = 0; i < ended.size(); ++i) EXPECT_EQ(vector(ended[i]), vector(fabric.positions[i])) << i;
}

// By its contacts, or where the solve's last iteration ends.
TEST_F(ContactEdgeCase, a_particle_ends_on_its_displacement_bound) {
  for (const char* pass : {"contact_apply", "stretch"}) {
    Random random(16);
    const Tufts t = reference::tufts(random, 10, 1, 0.5);
    const Scene scene = scene_of(t);
    const CookedFabric fabric = fabric_of(t, scene.solver);
    Passes passes(device(), scene, fabric, t, false);
    put_bound(passes, t.x.size(), {0.1f, 0.2f, 0.3f, 0}, {1, 0, -2, 0}, 0.5f, 3);
    passes.touch_all();
    passes.run(pass);
    const auto got = passes.iterate();
    const reference::Vector step = 1.0 / WEFT_LONGEST_LIFETIME * reference::Vector(1, 0, -2);
    const reference::Vector from = reference::Vector(0.1, 0.2, 0.3) + 3 * step;
    std::uint32_t held = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      // The nearest point of the part of its trajectory that belongs to the substep.
      const reference::Vector expected = from + std::clamp((t.p[i] - from).dot(step) / step.squaredNorm(), 0.0, 1.0) * step;
      const bool leaves = t.inverse_masses[i] > 0 && (t.p[i] - expected).norm() > 0.5;
      held += leaves;
      const reference::Vector wanted = leaves ? reference::Vector(expected + 0.5 * (t.p[i] - expected).normalized()) : t.p[i];
      EXPECT_LT((vector(got[i]) - wanted).norm(), 8 * kRounding) << pass << " " << i;
    }
    EXPECT_GT(held, 10u);
    EXPECT_EQ(passes.counters().truncated, held);
  }
}

TEST_F(ContactEdgeCase, a_particle_of_displacement_bound_zero_stays) {
  for (const char* pass : {"contact_apply", "stretch"}) {
    Random random(17);
    const Tufts t = reference::tufts(random, 10, 1, 0.5);
    const Scene scene = scene_of(t);
    const CookedFabric fabric = fabric_of(t, scene.solver);
    Passes passes(device(), scene, fabric, t, false);
    put_bound(passes, t.x.size(), {0, 0, 0, 0}, {0, 0, 0, 0}, 0, 0);
    passes.touch_all();
    passes.run(pass);
    const auto got = passes.iterate();
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(vector(got[i]), t.inverse_masses[i] == 0 ? t.p[i] : t.x[i]) << pass << " " << i;
  }
}

// Pairs may overflow where none of a particle's was stored: it ends its substep with the solve.
TEST_F(ContactEdgeCase, a_particle_of_displacement_bound_zero_stays_where_it_has_no_candidates) {
  Random random(17);
  const Tufts t = reference::tufts(random, 10, 1, 0.5);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  put_bound(passes, t.x.size(), {0, 0, 0, 0}, {1, 0, -2, 0}, 0, 0, false);
  auto detection = passes.detection();
  detection.margin = 1000;   // m: no particle leaves its bound
  passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
  passes.run("stretch");
  const auto got = passes.particles(buffers::positions);
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(vector(got[i]), t.inverse_masses[i] == 0 ? t.p[i] : t.x[i]) << i;
  EXPECT_EQ(passes.detection().needs_detection, 1u) << "they wait for a detection";
}

// Four particles in a row that stand still, and a pair of them.
Tufts four(double first_inverse_mass) {
  Tufts t;
  for (int i = 0; i < 4; ++i) {
    t.x.push_back(reference::Vector(i, 0, 0));
    t.inverse_masses.push_back(i == 0 ? first_inverse_mass : 10);
  }
  t.p = t.x;
  t.pairs.push_back({{0, 1, 2, 3}, 0.001, false});
  return t;
}

// Displacement bounds of four particles (m), which have candidates or not.
void put_bounds(Passes& passes, float bound, bool paired) {
  passes.put(buffers::displacement_bounds, std::vector<std::uint32_t>(4, std::bit_cast<std::uint32_t>(bound) | (paired ? WEFT_PAIRED : 0)));
}

// Whether a particle needs a detection that was predicted to go `expected` in each of ten substeps, and goes `way` in this one.
// `substeps`: of its frame.
struct Watched {
  std::uint32_t needed_by_finalize, needed_by_predict;
};
Watched watched(const compute::Device& device, const reference::Vector& expected, const reference::Vector& way, std::uint32_t substeps,
                bool paired) {
  Tufts t = four(10);
  for (std::size_t i = 0; i < 4; ++i) t.p[i] = (t.x[i] + (i == 0 ? way : expected)).cast<float>().cast<double>();
  const Scene scene = scene_of(t);
  CookedFabric fabric = fabric_of(t, scene.solver);
  for (gpu::Material& material : fabric.materials) material.damping_factor = 1;   // no damping
  Passes passes(device, scene, fabric, t, false);
  passes.put(buffers::trajectories, std::vector<gpu::vec4>(t.x.size(), with(WEFT_LONGEST_LIFETIME * expected, 0)));
  put_bounds(passes, 0.001f, paired);
  passes.begin(frame_of(substeps));
  passes.run(paired ? "contact_finalize" : "stretch");
  const std::uint32_t needed_by_finalize = passes.detection().needs_detection;
  passes.begin(frame_of(1));
  passes.run("predict");
  return {needed_by_finalize, passes.detection().needs_detection};
}

TEST_F(ContactEdgeCase, a_particle_on_its_trajectory_needs_no_detection_and_one_about_to_leave_it_does) {
  const reference::Vector fast(0.01, 0, 0.02), off(0.0005, 0, 0), far(0.0006, 0, 0);   // of a bound of 1 mm
  for (const std::uint32_t k : {0u, 1u, 2u, 3u}) {
    const std::uint32_t substeps = 1 + k / 2;   // at a frame's end there is no prediction to look at
    const bool paired = k % 2 == 1;             // which of the passes ends its substep
    const auto [on_it, still_on_it] = watched(device(), fast, fast, substeps, paired);
    EXPECT_EQ(on_it, 0u) << substeps;
    EXPECT_EQ(still_on_it, 0u) << substeps;
    // It is half a millimetre off and about to be a whole one.
    const auto [leaving, left] = watched(device(), fast, fast + off, substeps, paired);
    EXPECT_EQ(leaving, substeps == 1 ? 0u : 1u);
    EXPECT_EQ(left, 1u) << substeps;
    const auto [gone, anyway] = watched(device(), fast, fast + 2 * far, substeps, paired);
    // One that ends with the solve was kept within its bound: at a frame's end nothing shows that it wanted more.
    if (paired || substeps > 1) {
      EXPECT_EQ(gone, 1u) << substeps;
    }
    EXPECT_EQ(anyway, 1u) << substeps;
  }
}

TEST_F(ContactEdgeCase, an_anchor_that_leaves_its_trajectory_needs_a_detection) {
  for (const float lead : {0.0008f, 0.001f}) {   // m, off its trajectory at the substep's end, of a bound of 1 mm
    const Tufts t = four(0);
    const Scene scene = scene_of(t);
    CookedFabric fabric = fabric_of(t, scene.solver);
    fabric.anchors.push_back({0, 0, 0, 0, {0, 0, 0}});
    Passes passes(device(), scene, fabric, t, false);
    put_bounds(passes, 0.001f, true);
    const gpu::Anchor anchor{0, {0, 0, 0}, {0, lead, 0}};
    FrameInput input = frame_of(1);
    input.anchors = {&anchor, 1};
    input.anchors_move = true;
    passes.begin(input);
    passes.run("anchor");
    EXPECT_EQ(passes.detection().needs_detection, lead > 0.0009f ? 1u : 0u) << lead;
  }
}

TEST_F(ContactEdgeCase, contacts_do_not_push_into_colliders) {
  Random random(18);
  const Tufts t = reference::tufts(random, 40, 12, 0.01);
  Scene scene = scene_of(t);
  scene.colliders.resize(1);
  scene.colliders[0].shape = ColliderShape::plane;
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  gpu::Collider floor{};
  floor.normal_from = floor.normal_to = {0, 1, 0};
  FrameInput input = frame_of(1);
  input.colliders = {&floor, 1};
  passes.begin(input);
  for (const char* pass : {"contact_prepare", "stretch", "contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
  const auto got = passes.iterate();
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_TRUE(t.inverse_masses[i] == 0 || got[i].y >= 0.002f - kRounding) << i;
}

// Four particles that would all go the same way, and what becomes of them.
void run_degenerate(const compute::Device& device, const reference::Quad& x, bool edges, const reference::Vector& way, bool stays) {
  Tufts t;
  for (const reference::Vector& at : x) {
    t.x.push_back(at.cast<float>().cast<double>());
    t.p.push_back((at + way).cast<float>().cast<double>());
    t.inverse_masses.push_back(10);
  }
  t.pairs.push_back({{0, 1, 2, 3}, 0.00390625, edges});
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, false);
  for (const char* pass : {"contact_prepare", "contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
  passes.slide();
  passes.limit();
  passes.run("contact_finalize");
  const auto got = passes.particles(buffers::positions);
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(std::isfinite(got[i].x) && std::isfinite(got[i].y) && std::isfinite(got[i].z));
    EXPECT_EQ(vector(got[i]), stays ? t.x[i] : t.p[i]) << i;
  }
  EXPECT_EQ(passes.counters().non_finite, 0u);
}

TEST_F(ContactEdgeCase, sides_that_meet_stay_where_they_are) {
  const reference::Vector way(0.01, -0.02, 0.01);
  const reference::Vector a(-0.05, 0, -0.05), b(0.05, 0, -0.05), c(0, 0, 0.05);
  run_degenerate(device(), {reference::Vector(0, 0, 0), a, b, c}, false, way, true);   // in the triangle
  run_degenerate(device(), {a, a, b, c}, false, way, true);                            // on its corner
  run_degenerate(device(), {a, -a, b, -b}, true, way, true);                           // edges through each other
  run_degenerate(device(), {a, a, a, a}, true, way, true);                             // all at one place
}

TEST_F(ContactEdgeCase, sides_without_extent_or_parallel_go_their_way) {
  const reference::Vector way(0.01, -0.02, 0.01), up(0, 0.005, 0);
  const reference::Vector a(-0.05, 0, -0.05), b(0.05, 0, -0.05);
  run_degenerate(device(), {up, a, a, a}, false, way, false);
  run_degenerate(device(), {up, a, 0.5 * a, -a}, false, way, false);   // a triangle without area, below the vertex
  run_degenerate(device(), {a + up, b + up, a, b}, true, way, false);
  run_degenerate(device(), {a + up, b + up, b, a}, true, way, false);
  run_degenerate(device(), {up, up, a, b}, true, way, false);
  run_degenerate(device(), {up, up, a, a}, true, way, false);
}

TEST_F(ContactEdgeCase, a_prediction_that_is_not_finite_takes_nobody_along) {
  Tufts t = violent_tufts(19, 0.02);
  for (std::size_t i = 2; i < t.p.size(); i += 5)
    if (t.inverse_masses[i] > 0) t.p[i][static_cast<Eigen::Index>(i % 3)] = i % 2 == 0 ? NAN : INFINITY;
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  for (const char* pass : {"contact_prepare", "contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
  passes.slide();
  passes.limit();
  passes.run("contact_finalize");
  const auto got = points(passes.particles(buffers::positions));
  for (const reference::Vector& at : got) ASSERT_TRUE(at.allFinite());
  EXPECT_EQ(reference::meetings(t.pairs, t.x, got), 0u);
}

// Kinematic particles go no further here than the kinematic lag limit, a number of separations: so all can stop.
TEST_F(ContactEdgeCase, nothing_crosses_where_kinematic_particles_can_wait) {
  for (const std::uint64_t seed : {20u, 21u, 22u}) {
    Random random(seed);
    Tufts t = reference::tufts(random, 40, 12, 0.02);
    std::vector<double> separations(t.x.size(), INFINITY);
    for (const reference::Pair& pair : t.pairs)
      for (const std::uint32_t particle : pair.particle) separations[particle] = std::min(separations[particle], pair.separation);
    int kinematic = 0;
    for (std::size_t i = 0; i < t.x.size(); ++i) {
      if (t.inverse_masses[i] > 0) continue;
      const reference::Vector way = t.p[i] - t.x[i] + reference::Vector(0.01, -0.01, 0.01);
      const double limit = 0.99 * reference::kKinematicLagLimit * separations[i];
      t.p[i] = (t.x[i] + std::min(1.0, limit / way.norm()) * way).cast<float>().cast<double>();
      ++kinematic;
    }
    ASSERT_GT(kinematic, 5);
    const Scene scene = scene_of(t);
    const CookedFabric fabric = fabric_of(t, scene.solver);
    Passes passes(device(), scene, fabric, t, false);
    for (const char* pass : {"contact_prepare", "contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
    passes.slide();
    passes.limit();
    const auto fractions = passes.step_fractions();
    int waiting = 0;
    for (std::size_t i = 0; i < fractions.size(); ++i) waiting += t.inverse_masses[i] == 0 && fractions[i] < 1;
    EXPECT_GT(waiting, 0);
    passes.run("contact_finalize");
    EXPECT_EQ(reference::meetings(t.pairs, t.x, points(passes.particles(buffers::positions))), 0u) << seed;
    const auto next = passes.iterate();
    for (std::size_t i = 0; i < t.x.size(); ++i) {
      if (t.inverse_masses[i] > 0) continue;
      EXPECT_EQ(vector(next[i]), t.p[i]) << "where it goes on to";
    }
  }
}

// A vertex that has no room left above a triangle that stands still, or in the corner of two. A step fraction alone would hold it.
TEST_F(ContactEdgeCase, a_step_into_a_plane_or_a_corner_goes_on_along_it) {
  using reference::Vector;
  for (const bool corner : {false, true}) {
    Tufts t;
    const double gap = 0.0001;
    t.x = {Vector(0, gap, gap), Vector(-0.1, 0, -0.1), Vector(0.1, 0, -0.1), Vector(0, 0, 0.1)};
    t.inverse_masses = {10, 0, 0, 0};
    t.pairs.push_back({{0, 1, 2, 3}, 0.005, false});
    if (corner) {
      for (const Vector& at : {Vector(-0.1, -0.1, 0), Vector(0.1, -0.1, 0), Vector(0, 0.1, 0)}) t.x.push_back(at);
      t.inverse_masses.resize(7, 0);
      t.pairs.push_back({{0, 4, 5, 6}, 0.005, false});
    }
    for (Vector& at : t.x) at = at.cast<float>().cast<double>();
    t.p = t.x;
    t.p[0] = (t.x[0] + Vector(0.01, -0.03, corner ? -0.02 : 0.02)).cast<float>().cast<double>();
    const Scene scene = scene_of(t);
    const CookedFabric fabric = fabric_of(t, scene.solver);
    Passes passes(device(), scene, fabric, t, false);
    passes.run("contact_prepare");
    passes.slide();
    passes.limit();
    passes.run("contact_finalize");
    const Vector end = points(passes.particles(buffers::positions))[0];
    EXPECT_NEAR((end - Vector(0.01, gap, corner ? gap : gap + 0.02)).norm(), 0, 1e-5) << corner << ": " << end.transpose();
  }
}

// An anchored triangle comes down on two of cloth: the solve has moved the first out of its way, and into the second, which nobody pushes.
// If that one asked the first back, the anchors would wait.
TEST_F(ContactEdgeCase, what_lies_behind_cloth_in_an_anchors_way_goes_ahead_too) {
  Tufts t;
  const double moves[] = {0, 0.01, 0.01};   // m, of the layers, from the lowest
  for (std::uint32_t layer = 0; layer < 3; ++layer)
    for (const auto& [x, z] : {std::pair(-0.02, -0.01), std::pair(0.02, -0.01), std::pair(0.0, 0.02)}) {
      t.x.push_back(reference::Vector(x, 0.001 * layer, z).cast<float>().cast<double>());
      t.p.push_back((t.x.back() - reference::Vector(0, moves[layer], 0)).cast<float>().cast<double>());
      t.inverse_masses.push_back(layer == 2 ? 0 : 10);
      const auto i = static_cast<std::uint32_t>(t.x.size() - 1), below = 3 * (layer - 1);
      if (layer > 0) t.pairs.push_back({{i, below, below + 1, below + 2}, 0.0009765625, false});
    }
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  passes.run("contact_prepare");
  passes.slide();
  const auto ranks = passes.get<gpu::uvec4>(buffers::slides, 2 * t.x.size());
  for (std::size_t i = 0; i < t.x.size(); ++i)
    EXPECT_EQ(ranks[2 * i + 1].w, i < 3 ? reference::kRankTold : i < 6 ? reference::kRankInTheWay : 0) << i;
  passes.limit();
  for (const double fraction : passes.step_fractions()) EXPECT_EQ(fraction, 1);
  passes.run("contact_finalize");
  const auto end = points(passes.particles(buffers::positions));
  for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(end[i], t.p[i]) << "the anchors reach their targets";
  for (std::size_t i = 3; i < end.size(); ++i) EXPECT_GT(end[i].y() - end[i - 3].y(), 0.00009) << i;
}

// Close layers that fall together and far, the lowest stopped: the GPU's passes against the twin's. Each round stops a layer; where rounds
// are not enough, all keep to their half of the gap.
void compare_layers(const compute::Device& device, std::uint32_t layers) {
  Tufts t;
  for (std::uint32_t layer = 0; layer < layers; ++layer)
    for (const auto& [x, z] : {std::pair(-0.02, -0.01), std::pair(0.02, -0.01), std::pair(0.0, 0.02)}) {
      const double y = 0.001 * layer;
      t.x.push_back(reference::Vector(x, y, z).cast<float>().cast<double>());
      t.p.push_back((t.x.back() - reference::Vector(0, layer == 0 ? 0 : 0.05, 0)).cast<float>().cast<double>());
      t.inverse_masses.push_back(10);
      const auto i = static_cast<std::uint32_t>(t.x.size() - 1), below = 3 * (layer - 1);
      if (layer > 0) t.pairs.push_back({{i, below, below + 1, below + 2}, 0.0009765625, false});
    }
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, false);
  passes.run("contact_prepare");
  passes.limit();
  const auto limit = reference::limit_motion(t.pairs, passes.contacts(), t.x, t.p, t.inverse_masses);
  EXPECT_EQ(limit.falls_back, layers > WEFT_LIMIT_ROUNDS);
  EXPECT_EQ(passes.detection().falls_back != 0, limit.falls_back);
  const auto fractions = passes.step_fractions();
  for (std::size_t i = 0; i < fractions.size(); ++i) EXPECT_NEAR(fractions[i], limit.fractions[i], 1e-5) << i;
  passes.run("contact_finalize");
  const auto end = points(passes.particles(buffers::positions));
  for (std::size_t i = 3; i < end.size(); ++i) EXPECT_GT(end[i].y() - end[i - 3].y(), 0.00009) << i;
}

TEST_F(ContactEdgeCase, layers_do_not_cross_over_one_that_is_stopped) {
  for (const std::uint32_t layers : {3u, 20u, 40u, 80u}) {
    SCOPED_TRACE(std::to_string(layers) + " layers");
    compare_layers(device(), layers);
  }
}

}  // namespace
}  // namespace weft
