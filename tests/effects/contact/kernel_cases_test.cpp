// The contact passes where things go wrong or meet others: leashes, colliders, sides without a distance or without extent, predictions
// that are not finite, more layers than rounds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/contact_passes.h"

namespace weft {
namespace {

using ContactEdgeCase = GpuTest;

// The detection's words about one particle: where it should be, and how far from there it may be.
void put_leash(Passes& passes, std::size_t particles, const gpu::vec4& reference, const gpu::vec4& path, float leash, std::uint32_t age) {
  passes.put(buffers::references, std::vector<gpu::vec4>(particles, reference));
  passes.put(buffers::paths, std::vector<gpu::vec4>(particles, path));
  passes.put(buffers::leashes, std::vector<float>(particles, leash));
  auto detection = passes.detection();
  detection.age = age;
  passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
}

TEST_F(ContactEdgeCase, a_particle_ends_on_its_leash) {
  Random random(16);
  const Tufts t = reference::tufts(random, 10, 1, 0.5);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  put_leash(passes, t.x.size(), {0.1f, 0.2f, 0.3f, 0}, {1, 0, -2, 0}, 0.5f, 3);
  passes.run("contact_apply");
  const auto got = passes.iterate();
  const reference::Vector step = 1.0 / WEFT_HORIZON * reference::Vector(1, 0, -2), from = reference::Vector(0.1, 0.2, 0.3) + 3 * step;
  std::uint32_t held = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    // The nearest place of the path that the substep passes.
    const reference::Vector expected = from + std::clamp((t.p[i] - from).dot(step) / step.squaredNorm(), 0.0, 1.0) * step;
    const bool leaves = t.inverse_masses[i] > 0 && (t.p[i] - expected).norm() > 0.5;
    held += leaves;
    const reference::Vector wanted = leaves ? reference::Vector(expected + 0.5 * (t.p[i] - expected).normalized()) : t.p[i];
    EXPECT_LT((vector(got[i]) - wanted).norm(), 8 * kRounding) << i;
  }
  EXPECT_GT(held, 10u);
  EXPECT_EQ(passes.counters().truncated, held);
}

TEST_F(ContactEdgeCase, a_particle_without_a_leash_stays) {
  Random random(17);
  const Tufts t = reference::tufts(random, 10, 1, 0.5);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  put_leash(passes, t.x.size(), {0, 0, 0, 0}, {0, 0, 0, 0}, 0, 0);
  passes.run("contact_apply");
  const auto got = passes.iterate();
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(vector(got[i]), t.inverse_masses[i] == 0 ? t.p[i] : t.x[i]) << i;
}

// Pairs may be lost where no other was found, and then contact_apply has no threads.
TEST_F(ContactEdgeCase, a_particle_without_a_leash_stays_where_there_are_no_candidates) {
  Random random(17);
  const Tufts t = reference::tufts(random, 10, 1, 0.5);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  put_leash(passes, t.x.size(), {0, 0, 0, 0}, {1, 0, -2, 0}, 0, 0);
  auto detection = passes.detection();
  detection.touched.x = detection.candidates = 0;
  detection.reach = 1000;   // m: nobody strays
  passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
  passes.run("contact_finalize");
  const auto got = passes.particles(buffers::positions);
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(vector(got[i]), t.inverse_masses[i] == 0 ? t.p[i] : t.x[i]) << i;
  EXPECT_EQ(passes.detection().due, 1u) << "they wait for a search";
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

// One particle on a path that leads ten substeps of `expected` each. It goes `way` in this substep, which is one of so many.
struct Watched {
  std::uint32_t due_by_settle, due_by_predict;
};
Watched watched(const compute::Device& device, const reference::Vector& expected, const reference::Vector& way, std::uint32_t substeps) {
  Tufts t = four(10);
  for (std::size_t i = 0; i < 4; ++i) t.p[i] = (t.x[i] + (i == 0 ? way : expected)).cast<float>().cast<double>();
  const Scene scene = scene_of(t);
  CookedFabric fabric = fabric_of(t, scene.solver);
  for (gpu::Material& material : fabric.materials) material.keep = 1;   // no damping
  Passes passes(device, scene, fabric, t, false);
  passes.put(buffers::paths, std::vector<gpu::vec4>(t.x.size(), with(WEFT_HORIZON * expected, 0)));
  auto detection = passes.detection();
  detection.reach = 0.001f;
  detection.touched.x = detection.candidates = 0;
  passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
  passes.begin(frame_of(substeps));
  passes.run("contact_finalize");
  const std::uint32_t due_by_settle = passes.detection().due;
  passes.begin(frame_of(1));
  passes.run("predict");
  return {due_by_settle, passes.detection().due};
}

TEST_F(ContactEdgeCase, who_goes_his_path_is_not_searched_for_again_and_who_is_about_to_leave_it_is) {
  const reference::Vector fast(0.01, 0, 0.02), off(0.0003, 0, 0), far(0.0006, 0, 0);   // of a reach of 1 mm
  for (const std::uint32_t substeps : {1u, 2u}) {   // at a frame's end there is no prediction to look at
    const auto [on_it, still_on_it] = watched(device(), fast, fast, substeps);
    EXPECT_EQ(on_it, 0u) << substeps;
    EXPECT_EQ(still_on_it, 0u) << substeps;
    // It is 0.3 mm off and about to be 0.6.
    const auto [leaving, left] = watched(device(), fast, fast + off, substeps);
    EXPECT_EQ(leaving, substeps == 1 ? 0u : 1u);
    EXPECT_EQ(left, 1u) << substeps;
    const auto [gone, anyway] = watched(device(), fast, fast + 2 * far, substeps);
    EXPECT_EQ(gone, 1u) << substeps;
    EXPECT_EQ(anyway, 1u) << substeps;
  }
}

TEST_F(ContactEdgeCase, an_anchor_that_leaves_its_path_calls_for_a_search) {
  for (const float lead : {0.0004f, 0.0006f}) {   // m, off its path at the substep's end, of a reach of 1 mm
    const Tufts t = four(0);
    const Scene scene = scene_of(t);
    CookedFabric fabric = fabric_of(t, scene.solver);
    fabric.anchors.push_back({0, 0, 0, 0, {0, 0, 0}});
    Passes passes(device(), scene, fabric, t, false);
    auto detection = passes.detection();
    detection.reach = 0.001f;
    passes.put(buffers::detection, std::vector<gpu::Detection>{detection});
    const gpu::Anchor anchor{0, {0, 0, 0}, {0, lead, 0}};
    FrameInput input = frame_of(1);
    input.anchors = {&anchor, 1};
    input.anchors_move = true;
    passes.begin(input);
    passes.run("anchor");
    EXPECT_EQ(passes.detection().due, lead > 0.0005f ? 1u : 0u) << lead;
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
  for (const char* pass : {"contact_prepare", "contact_weigh", "contact_solve", "contact_apply"}) passes.run(pass);
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
  for (const char* pass : {"contact_prepare", "contact_weigh", "contact_solve", "contact_apply"}) passes.run(pass);
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
  for (const char* pass : {"contact_prepare", "contact_weigh", "contact_solve", "contact_apply"}) passes.run(pass);
  passes.limit();
  passes.run("contact_finalize");
  const auto got = points(passes.particles(buffers::positions));
  for (const reference::Vector& at : got) ASSERT_TRUE(at.allFinite());
  EXPECT_EQ(reference::meetings(t.pairs, t.x, got), 0u);
}

// What is led may lag by some distances that a pair keeps, and none goes further than that here: so all can stop.
TEST_F(ContactEdgeCase, nothing_crosses_where_what_is_led_can_wait) {
  for (const std::uint64_t seed : {20u, 21u, 22u}) {
    Random random(seed);
    Tufts t = reference::tufts(random, 40, 12, 0.02);
    std::vector<double> keeps(t.x.size(), INFINITY);
    for (const reference::Pair& pair : t.pairs)
      for (const std::uint32_t particle : pair.particle) keeps[particle] = std::min(keeps[particle], pair.keep);
    int led = 0;
    for (std::size_t i = 0; i < t.x.size(); ++i) {
      if (t.inverse_masses[i] > 0) continue;
      const reference::Vector way = t.p[i] - t.x[i] + reference::Vector(0.01, -0.01, 0.01);
      t.p[i] = (t.x[i] + std::min(1.0, 0.99 * reference::kPatience * keeps[i] / way.norm()) * way).cast<float>().cast<double>();
      ++led;
    }
    ASSERT_GT(led, 5);
    const Scene scene = scene_of(t);
    const CookedFabric fabric = fabric_of(t, scene.solver);
    Passes passes(device(), scene, fabric, t, false);
    for (const char* pass : {"contact_prepare", "contact_weigh", "contact_solve", "contact_apply"}) passes.run(pass);
    passes.limit();
    const auto fractions = passes.fractions();
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

// Layers that fall together and far, close to each other, the lowest stopped: the GPU's rounds against the twin's.
TEST_F(ContactEdgeCase, twenty_layers_do_not_cross_over_one_that_is_stopped) {
  Tufts t;
  for (std::uint32_t layer = 0; layer < 20; ++layer)
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
  Passes passes(device(), scene, fabric, t, false);
  passes.run("contact_prepare");
  passes.limit();
  const auto limit = reference::limit_motion(t.pairs, passes.contacts(), t.x, t.p, t.inverse_masses);
  EXPECT_TRUE(limit.unsafe);
  EXPECT_NE(passes.detection().unsafe, 0u);
  const auto fractions = passes.fractions();
  for (std::size_t i = 0; i < fractions.size(); ++i) EXPECT_NEAR(fractions[i], limit.fractions[i], 1e-5) << i;
  passes.run("contact_finalize");
  const auto end = points(passes.particles(buffers::positions));
  for (std::size_t i = 3; i < end.size(); ++i) EXPECT_GT(end[i].y() - end[i - 3].y(), 0.00009) << i;
}

}  // namespace
}  // namespace weft
