// Values that are not finite, through every entry: refused, or restored and counted, and the rest of the cloth does not feel them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "compute/commands.h"
#include "engine/solve/sanitize.h"
#include "engine/effects/buffers.h"
#include "engine/solve/solver.h"
#include "tests/support/every_method.h"

namespace weft {
namespace {

using NonFinite = GpuTest;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
bool same_bits(const gpu::vec4& a, const gpu::vec4& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expect_same_everywhere(const Simulation& a, const Simulation& b) {
  const auto x = must(a.read_positions()), y = must(b.read_positions()), u = must(a.read_velocities()), v = must(b.read_velocities());
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_TRUE(same_bits(x[i], y[i]) && same_bits(u[i], v[i])) << "particle " << i;
}

TEST_F(NonFinite, positions_and_velocities_that_a_host_writes_are_sanitized_and_counted_and_no_other_particle_feels_them) {
  for (const Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    const auto good = must(Simulation::create(device(), subject.scene)), bad = must(Simulation::create(device(), subject.scene));
    for (Simulation* simulation : {good.get(), bad.get()}) run(*simulation, 3 * kFrame);
    auto pose = must(good->read_positions()), velocities = must(good->read_velocities());
    const std::size_t held = good->fabric().anchors[0].particle, some[] = {7, 20, 40};
    auto broken = pose;
    broken[7].x = kNan;
    broken[20] = {0, -kInfinity, 0, 0};
    broken[40].z = 1e20f;   // its square is infinite
    broken[held].y = kNan;
    must(bad->write_positions(broken));
    must(good->write_positions(pose));
    for (const std::size_t i : some) velocities[i] = {0, 0, 0, 0};   // restored at rest
    velocities[held] = {0, 0, 0, 0};
    velocities[30] = {0, 0, 0, 0};
    must(good->write_velocities(velocities));
    velocities[30].x = kNan;
    must(bad->write_velocities(velocities));
    EXPECT_EQ(bad->counts().non_finite, 5u);
    expect_same_everywhere(*good, *bad);
    for (Simulation* simulation : {good.get(), bad.get()}) run(*simulation, 4 * kFrame);
    expect_same_everywhere(*good, *bad);
    EXPECT_EQ(bad->counts().non_finite, 5u) << "and it is over";
    EXPECT_EQ(good->counts().non_finite, 0u);
  }
}

TEST_F(NonFinite, a_lost_particle_goes_along_where_its_cloth_is_carried_off) {
  const auto simulation = must(Simulation::create(device(), sheet(8)));
  auto pose = must(simulation->read_positions());
  const auto before = pose;
  for (gpu::vec4& p : pose) p.x += 1000;
  for (std::size_t i = 30; i < 45; ++i) pose[i].y = kNan;   // a patch, so that some have lost neighbours alone
  must(simulation->write_positions(pose));
  const auto after = must(simulation->read_positions());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_NEAR(after[i].x, before[i].x + 1000, 1e-4) << i;   // an ulp of 1000 m is 6e-5 m
  EXPECT_EQ(simulation->counts().non_finite, 15u);
  std::vector<gpu::vec4> nothing(pose.size(), {kNan, kNan, kNan, 0});
  must(simulation->write_positions(nothing));
  EXPECT_EQ(std::memcmp(must(simulation->read_positions()).data(), after.data(), after.size() * sizeof after[0]), 0)
      << "no host knows a better one";
}

// Runs one substep, and reads places, velocities and counters.
struct Substep {
  std::vector<gpu::vec4> positions, velocities;
  gpu::Counters counters{};
};

Substep substep(const compute::Device& device, const Scene& scene, const CookedFabric& fabric, const std::vector<gpu::vec4>& velocities) {
  const auto cache = must(compute::PipelineCache::create(device));
  Solver solver = must(Solver::create(device, cache, scene, fabric, {}));
  must(compute::upload(device, solver.buffer(buffers::velocities), std::as_bytes(std::span(velocities))));
  FrameInput input;
  input.substeps = 1;
  input.gravity = scene.gravity;
  must(compute::run_once(device, "a substep", [&](VkCommandBuffer commands) {
    compute::Recorder recorder(device, commands);
    const auto steps = solver.frame(input);
    solver.record_input(recorder, input);
    for (const Solver::Step& step : steps) solver.record_step(recorder, step);
    recorder.finish();
  }));
  Substep end{std::vector<gpu::vec4>(velocities.size()), std::vector<gpu::vec4>(velocities.size()), {}};
  must(compute::read_back(device, solver.buffer(buffers::positions), std::as_writable_bytes(std::span(end.positions))));
  must(compute::read_back(device, solver.buffer(buffers::velocities), std::as_writable_bytes(std::span(end.velocities))));
  must(compute::read_back(device, solver.buffer(buffers::counters), std::as_writable_bytes(std::span(&end.counters, 1))));
  return end;
}

// The shaders alone, since the API lets none through: a prediction that is not finite.
TEST_F(NonFinite, a_particle_that_turns_non_finite_in_a_substep_is_put_back_at_rest_and_those_out_of_reach_do_not_feel_it) {
  for (Subject& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    Scene& scene = subject.scene;
    scene.colliders.clear();   // without them only constraints connect a particle with others
    scene.contacts.capacity = 0;   // enough: which particles an overflow holds depends on the order of threads
    for (Anchor& anchor : scene.cloths[0].anchors) anchor.keys.clear();
    const std::uint32_t cells = 40;
    scene.cloths[0].grid = Grid{{2, 2}, cells, cells, Topology::diagonal, false};
    scene.solver.iterations = std::min(scene.solver.iterations, 2u);
    const auto meshes = must(make_meshes(scene));
    const CookedFabric fabric = must(cook(scene, meshes));
    const auto good = substep(device(), scene, fabric, fabric.velocities);
    auto velocities = fabric.velocities;
    const auto corner = std::max_element(fabric.positions.begin(), fabric.positions.begin() + fabric.cloths[0].particles,
                                         [](const gpu::vec4& a, const gpu::vec4& b) { return a.x + a.z < b.x + b.z; });
    const auto lost = static_cast<std::size_t>(corner - fabric.positions.begin());   // the anchors are elsewhere
    velocities[lost].y = kNan;
    const auto bad = substep(device(), scene, fabric, velocities);
    EXPECT_EQ(bad.counters.non_finite, 1u);
    EXPECT_EQ(good.counters.non_finite, 0u);
    EXPECT_TRUE(same_bits(bad.positions[lost], fabric.positions[lost]));
    EXPECT_TRUE(same_bits(bad.velocities[lost], {0, 0, 0, fabric.velocities[lost].w}));
    const gpu::vec4& x = fabric.positions[lost];
    // Far links reach eight edges an iteration; from colour to colour, or in a linear solve, every particle reaches all others.
    const double reach = (8 * scene.solver.iterations + 2) * 2.0 / cells;
    const bool local = scene.solver.method != Method::implicit && scene.solver.method != Method::gauss_seidel;
    int beyond = 0;
    for (std::size_t i = 0; i < bad.positions.size(); ++i) {
      const gpu::vec4 &p = bad.positions[i], &q = good.positions[i];
      ASSERT_TRUE(is_finite(p) && is_finite(bad.velocities[i])) << i;
      const double off = std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
      EXPECT_LE(off, 2 * 9.81 * fabric.h * fabric.h) << "a neighbour flies freely for a substep at most: particle " << i;
      if (std::max(std::abs(p.x - x.x), std::abs(p.z - x.z)) <= reach) continue;
      ++beyond;
      ASSERT_TRUE(!local || (same_bits(p, q) && same_bits(bad.velocities[i], good.velocities[i]))) << "particle " << i;
    }
    EXPECT_GT(beyond, 100);
  }
}

TEST_F(NonFinite, a_gravity_that_carries_everything_beyond_floats_is_survived) {
  const auto simulation = must(Simulation::create(device(), sheet(4)));
  must(simulation->set_gravity({0, -9e9f, 0}));
  run(*simulation, 2);
  EXPECT_GT(simulation->counts().non_finite, 0u);
  must(simulation->set_gravity({0, 0, 0}));
  must(simulation->write_positions(simulation->fabric().positions));
  must(simulation->write_velocities(simulation->fabric().velocities));
  const std::uint32_t before = simulation->counts().non_finite;
  run(*simulation, 0.5);
  EXPECT_EQ(simulation->counts().non_finite, before);
  EXPECT_LT(strain_of(*simulation).max, 1e-4);
}

TEST_F(NonFinite, targets_poses_gravity_and_scenes_are_refused_with_a_sentence_and_change_nothing) {
  const auto simulation = must(Simulation::create(device(), moving(6)));
  const auto refused = [](auto&& result, const std::string& word) {
    ASSERT_FALSE(result) << word;
    EXPECT_NE(result.error().find(word), std::string::npos) << result.error();
  };
  for (const float bad : {kNan, kInfinity, -kInfinity, 1e10f}) {
    const Vec3 place{0, bad, 0};
    refused(simulation->move_anchors(0, std::span(&place, 1)), "anchor 0 is not finite");
    refused(simulation->move_collider(1, {place, {0, 1, 0}, {}}), "collider 1 is not finite");
    refused(simulation->move_collider(2, {{0, 0, 0}, place, {}}), "collider 2 is not finite");
    refused(simulation->set_gravity(place), "gravity is not finite");
  }
  const auto untouched = must(Simulation::create(device(), moving(6)));
  for (Simulation* s : {simulation.get(), untouched.get()}) run(*s, 4 * kFrame);
  expect_same_everywhere(*simulation, *untouched);

  Scene scene = moving(6);
  scene.gravity.y = kNan;
  refused(Simulation::create(device(), scene), "gravity[1]: not a number, not finite");
  scene = moving(6);
  scene.colliders[0].keys[1].translate.x = kInfinity;
  refused(Simulation::create(device(), scene), "colliders[0].keys[1].translate[0]: infinite, not finite");
  scene = moving(6);
  scene.cloths[0].fabric.bend = kInfinity;
  refused(Simulation::create(device(), scene), "cloths[0].fabric.bend");
  scene = moving(6);
  scene.gravity.y = -2e10f;
  refused(Simulation::create(device(), scene), "gravity[1]: -2e+10 is less than -1000 (m/s^2)");
  scene = moving(6);
  scene.colliders[2].normal = {0, 1e10f, 0};
  refused(Simulation::create(device(), scene), "colliders[2].normal[1]: 1e+10 is more than 100000 (m)");
  // A mesh may have any size. Beyond this no shader can take its squares.
  const auto scaled = [](const Scene& of, double scale) {
    std::vector<Mesh> meshes = must(make_meshes(of));
    transform_mesh(meshes[0], {.translate = {}, .axis = {0, 1, 0}, .degrees = 0, .scale = scale});
    return meshes;
  };
  scene = moving(6);
  refused(Simulation::create(device(), scene, scaled(scene, 1e12)), "m away or more");
  scene = sheet(1);
  refused(Simulation::create(device(), scene, scaled(scene, 5e9)), "a link is 4e+09 m long or longer");
}

}  // namespace
}  // namespace weft
