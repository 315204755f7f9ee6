// The lee of cloths and mesh colliders: the discs that they are to the wind, and what cloth behind them feels of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/effects/air/air.h"
#include "shaders/air/air.ref.h"
#include "tests/support/cooked.h"
#include "tests/support/mesh_files.h"
#include "tests/support/single_pass.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using KernelWake = GpuTest;
using WakeCase = GpuTest;
using reference::Vector;

// A wall of 1 m by 1 m and 2 cm thick, its middle at the origin, across x.
constexpr const char* kWall = R"(v -0.01 -0.5 -0.5
v 0.01 -0.5 -0.5
v -0.01 0.5 -0.5
v 0.01 0.5 -0.5
v -0.01 -0.5 0.5
v 0.01 -0.5 0.5
v -0.01 0.5 0.5
v 0.01 0.5 0.5
f 1 5 7 3
f 2 4 8 6
f 1 2 6 5
f 3 7 8 4
f 1 3 4 2
f 5 6 8 7
)";

Collider wall(float x) {
  Collider collider;
  collider.shape = ColliderShape::mesh;
  collider.mesh = "wall.obj";
  collider.centre = {x, 0, 0};
  return collider;
}

// A sheet of 0.4 m across the wind, without gravity, in a wind of 5 m/s along x.
Scene in_wind(const test::Folder& folder) {
  folder.write("wall.obj", kWall);
  Scene scene = sheet(8);
  scene.folder = folder / "";
  scene.gravity = {};
  Cloth& cloth = scene.cloths[0];
  cloth.grid->size = {0.4f, 0.4f};
  cloth.grid->upright = true;
  cloth.transform.axis = {0, 1, 0};
  cloth.transform.degrees = 90;
  scene.air.emplace().wind = {5, 0, 0};
  return scene;
}

double blown(const compute::Device& device, const Scene& scene) {   // m, its middle along the wind in a tenth of a second
  const auto simulation = must(Simulation::create(device, scene));
  const auto count = simulation->fabric().cloths[0].particles;
  const auto middle = [&] {
    double sum = 0;
    const auto positions = must(simulation->read_positions());
    for (std::uint32_t i = 0; i < count; ++i) sum += double(positions[i].x) / count;
    return sum;
  };
  const double before = middle();
  run(*simulation, 0.1);
  return middle() - before;
}

bool has_pass(const Simulation& simulation, std::string_view name) {
  return std::ranges::any_of(simulation.passes(), [&](const PassUse& pass) { return pass.name.find(name) != std::string::npos; });
}

TEST_F(WakeCase, cloth_behind_a_wall_of_triangles_feels_as_little_as_behind_a_sphere_that_shows_as_much) {
  const test::Folder folder;
  Scene open = in_wind(folder), walled = open, round = open;
  const double free = blown(device(), open);
  for (const float ahead : {0.5f, 1.5f, 6.0f}) {
    walled = open;
    walled.contacts.enabled = true;
    walled.colliders = {wall(-ahead)};
    EXPECT_NEAR(blown(device(), walled), free, 1e-6) << "without lee";
    walled.air->lee = true;
    round = open;
    round.air->lee = true;
    round.colliders = {sphere({-ahead, 0, 0}, 1 / std::sqrt(std::numbers::pi))};
    const double behind_wall = blown(device(), walled), behind_sphere = blown(device(), round);
    EXPECT_LT(behind_wall, ahead < 1 ? 0.35 * free : 0.9 * free) << ahead;
    if (ahead > 1) { EXPECT_NEAR(behind_wall, behind_sphere, 0.01 * free) << ahead; }   // nearer, the sphere would touch it
  }
  walled.colliders = {wall(2)};
  EXPECT_NEAR(blown(device(), walled), free, 1e-6) << "a wall behind it";
}

TEST_F(WakeCase, cloth_behind_cloth_feels_less_and_nobody_is_in_its_own_lee) {
  const test::Folder folder;
  Scene scene = in_wind(folder);
  const double free = blown(device(), scene);
  scene.air->lee = true;
  EXPECT_EQ(blown(device(), scene), free) << "alone";
  EXPECT_FALSE(has_pass(*must(Simulation::create(device(), scene)), "air_wake"));
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].grid->size = {0.8f, 0.8f};
  scene.cloths[1].fabric.area_density = 10;   // it stays
  scene.cloths[1].transform.translate = {-0.8f, 0, 0};
  EXPECT_TRUE(has_pass(*must(Simulation::create(device(), scene)), "air_wake"));
  EXPECT_LT(blown(device(), scene), 0.4 * free);
  scene.cloths[1].transform.translate = {0.8f, 0, 0};
  EXPECT_NEAR(blown(device(), scene), free, 1e-6) << "the other one is behind it";
  scene.air->lee = false;
  EXPECT_FALSE(has_pass(*must(Simulation::create(device(), scene)), "air_wake"));
}

TEST_F(WakeCase, the_same_bits_in_every_way_twice_and_from_a_snapshot) {
  const test::Folder folder;
  Scene scene = in_wind(folder);
  scene.air->lee = true;
  scene.air->turbulence = 0.5;
  scene.contacts.enabled = true;
  scene.colliders = {wall(-0.7f), sphere({-0.4f, 0.2f, 0}, 0.1)};
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {1, {0, 0.5f, 0}, {0, 1, 0}, 90}};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0.3f, 0, 0};
  std::vector<std::uint64_t> hashes;
  for (const Way way : {Way::advance, Way::submit, Way::record, Way::advance}) {
    auto simulation = must(Simulation::create(device(), scene));
    for (int k = 0; k < 15; ++k) run_frame(device(), *simulation, way);
    simulation = resumed(device(), *simulation, scene);
    for (int k = 0; k < 15; ++k) run_frame(device(), *simulation, way);
    hashes.push_back(hash_of(*simulation));
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

// Three crumpled sheets and a wall that is askew. The second has collapsed into a point, and some of the third is not finite.
struct Crumpled {
  Scene scene;
  CookedFabric fabric;
  Vector wind{3, 0.5, -1};
};
Crumpled crumpled(const test::Folder& folder, std::uint64_t seed) {
  Random random(seed);
  Crumpled c;
  c.scene = in_wind(folder);
  c.scene.air->lee = true;
  c.scene.air->wind = {3, 0.5f, -1};
  c.scene.cloths.push_back(c.scene.cloths[0]);
  c.scene.cloths.push_back(c.scene.cloths[0]);
  c.scene.cloths[1].grid->cells_x = c.scene.cloths[1].grid->cells_y = 3;
  c.scene.cloths[2].grid->cells_x = 5;
  for (std::size_t k = 0; k < 3; ++k) c.scene.cloths[k].transform.translate = {0.7f * static_cast<float>(k), 0.1f, 0};
  c.scene.contacts.enabled = true;
  c.scene.colliders = {wall(-0.6f)};
  c.scene.colliders[0].axis = {0, 0.8f, 0.6f};
  c.scene.colliders[0].degrees = 33;
  c.fabric = cooked(c.scene);
  for (gpu::vec4& x : c.fabric.positions) {
    const gpu::vec4 d = anywhere(random, x.w > 0 ? 0.08 : 0, 0);
    x = {x.x + d.x, x.y + d.y, x.z + d.z, x.w};
  }
  const ClothRange &point = c.fabric.cloths[1], &spoilt = c.fabric.cloths[2];
  for (std::uint32_t k = 0; k < point.particles; ++k) {
    gpu::vec4& x = c.fabric.positions[point.first_particle + k];
    x = {0.5f, 0.25f, 0.125f, x.w};
  }
  c.fabric.positions[spoilt.first_particle + 4].y = std::numeric_limits<float>::quiet_NaN();
  c.fabric.positions[spoilt.first_particle + 11].x = 1e30f;
  return c;
}

TEST_F(KernelWake, finds_the_discs_that_its_twin_does_and_slows_the_air_down_behind_them) {
  const test::Folder folder;
  for (const bool storage : {false, true}) {
    const Crumpled c = crumpled(folder, 23);
    const Vector way = c.wind.normalized();
    SinglePass passes(device(), c.scene, c.fabric, storage);
    FrameInput input = frame_of(4);
    input.air = air_of(*c.scene.air, {c.scene.air->wind, {}, {}}, 0, 4 * c.fabric.h, {});
    passes.begin(input);
    passes.run("air_wake");
    const auto discs = passes.get<gpu::vec4>(buffers::wakes, 4);
    const reference::Points x = points(c.fabric.positions);
    const auto body_of = [&](std::uint32_t particle) {
      for (std::uint32_t k = 0; k < 3; ++k)
        if (particle < c.fabric.cloths[k].first_particle + c.fabric.cloths[k].particles) return k;
      return 3u;
    };
    std::vector<std::vector<std::array<std::uint32_t, 3>>> triangles(4);
    for (const auto& [i, j, k] : c.fabric.triangles)
      if (x[i].norm() + x[j].norm() + x[k].norm() < 1e5) triangles[body_of(i)].push_back({i, j, k});
    EXPECT_LT(triangles[2].size(), triangles[0].size()) << "what is not finite is left out";
    std::vector<reference::Disc> wanted;
    for (std::size_t k = 0; k < 4; ++k) {
      wanted.push_back(reference::shown_disc(triangles[k], x, way));
      EXPECT_NEAR(discs[k].w, wanted[k].radius, 1e-5) << k;   // a hundred triangles, some metres from the origin
      EXPECT_LT((vector(discs[k]) - wanted[k].middle).norm(), 1e-5) << k;
    }
    EXPECT_EQ(wanted[1].radius, 0);
    EXPECT_GT(wanted[0].radius, 0.1);
    // A box 0.02 by 1 by 1 that is turned: the faces that the wind comes at.
    const Eigen::AngleAxisd turn(33 * std::numbers::pi / 180, Vector(0, 0.8, 0.6));
    const Vector seen = turn.inverse() * way;
    EXPECT_NEAR(wanted[3].radius, std::sqrt((std::abs(seen.x()) + 0.02 * (std::abs(seen.y()) + std::abs(seen.z()))) / std::numbers::pi), 1e-5);

    passes.run("air_stir");
    const auto stirred = passes.get<gpu::vec4>(buffers::air_stirred, 2 * x.size());
    double most = 0;
    for (std::uint32_t i = 0; i < x.size(); ++i) {
      if (!(x[i].norm() < 1e5)) continue;
      double left = 1;
      for (std::uint32_t k = 0; k < 4; ++k)
        if (k != body_of(i)) left *= 1 - reference::deficit_of_disc(x[i] - wanted[k].middle, way, wanted[k].radius);
      for (const std::uint32_t end : {0u, 1u}) EXPECT_LT((vector(stirred[2 * i + end]) - (left - 1) * c.wind).norm(), 2e-4) << i;
      most = std::max(most, 1 - left);
    }
    EXPECT_GT(most, 0.7);
  }
}

// Two layers of one body count once, and what is closed shows the half that the wind comes at.
TEST(Discs, show_the_larger_of_two_sides) {
  const reference::Points square = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  const std::vector<std::array<std::uint32_t, 3>> single = {{0, 1, 2}, {0, 2, 3}}, folded = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
  for (const auto& triangles : {single, folded}) {
    const reference::Disc disc = reference::shown_disc(triangles, square, {1, 0, 0});
    EXPECT_NEAR(disc.radius, std::sqrt(1 / std::numbers::pi), 1e-12);
    EXPECT_NEAR((disc.middle - Vector(0, 0.5, 0.5)).norm(), 0, 1e-12);
    EXPECT_EQ(reference::shown_disc(triangles, square, {0, 0, 1}).radius, 0);
  }
  EXPECT_EQ(reference::deficit_of_disc({0, 0, 0}, {1, 0, 0}, 0.5), 0);
  EXPECT_EQ(reference::deficit_of_disc({-0.1, 0, 0}, {1, 0, 0}, 0.5), 0);
  EXPECT_NEAR(reference::deficit_of_disc({0.025, 0, 0}, {1, 0, 0}, 0.5), 0.5, 1e-12) << "half of the way in";
  EXPECT_EQ(reference::deficit_of_disc({0.2, 0, 0}, {1, 0, 0}, 0.5), reference::deficit_at({0.2, 0, 0}, {1, 0, 0}, 0.5));
}

}  // namespace
}  // namespace weft
