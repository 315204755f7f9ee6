// Cloth that starts out going through cloth comes apart, counted on the way: judged by a checker that shares nothing with the passes
// (engine/reference/intersections.h).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "compute/commands.h"
#include "engine/reference/intersections.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using UntangleCase = GpuTest;
constexpr double kPi = std::numbers::pi;

// All triangles, with those of mesh colliders; their edges against cloth alone.
std::uint64_t crossings_in(const Simulation& simulation) {
  std::vector<Vec3> places;
  for (const gpu::vec4& p : must(simulation.read_positions())) places.push_back({p.x, p.y, p.z});
  return count_crossings(places, simulation.fabric().triangles, simulation.fabric().cloth_triangles);
}

struct Tangled {
  Scene scene;
  std::vector<Mesh> meshes;
};

// Without gravity: nothing helps it.
Tangled tangled(std::vector<Mesh> cloths) {
  Tangled made;
  made.scene.gravity = {};
  made.scene.contacts.enabled = true;
  made.scene.cloths.resize(cloths.size());
  for (Cloth& cloth : made.scene.cloths) cloth.grid = Grid{{1, 1}, 1, 1, Topology::diagonal, false};   // in place of which come the meshes
  made.meshes = std::move(cloths);
  return made;
}

Mesh bent(const Grid& grid, const std::function<Vec3(Vec3)>& place) {
  const Mesh flat = make_grid(grid);
  RenderMesh render;
  for (const Vec3& p : flat.render.positions) render.positions.push_back(place(p));
  render.triangles = flat.render.triangles;
  return must(weld_mesh(std::move(render)));
}

// A square whose corner is rolled over by three quarters of a turn and goes straight down from there, through the square.
Mesh poked_corner(Topology topology) {
  constexpr double start = 0.3, radius = 0.06, turn = 1.5 * kPi * radius;
  return bent({{1, 1}, 30, 30, topology, false}, [](Vec3 p) {
    const double s = (double(p.x) + p.z) / std::numbers::sqrt2 - start, t = (double(p.x) - p.z) / std::numbers::sqrt2, a = s / radius;
    const double along = start + (s <= 0 ? s : s < turn ? radius * std::sin(a) : -radius);
    const double up = s <= 0 ? 0 : s < turn ? radius * (1 - std::cos(a)) : radius - (s - turn);
    return Vec3{float((along + t) / std::numbers::sqrt2), float(up), float((along - t) / std::numbers::sqrt2)};
  });
}

// An upright sheet through a flat one, at an angle.
std::vector<Mesh> crossed_sheets(Vec3 shift) {
  return {make_grid({{1, 1}, 24, 24, Topology::diagonal, false}), bent({{0.7f, 0.7f}, 19, 17, Topology::centre, true}, [&](Vec3 p) {
            return Vec3{float(0.87 * p.x) + shift.x, p.y + shift.y, float(-0.5 * p.x) + shift.z};
          })};
}

// A sheet with a finger in its middle, and a flat one, which the finger goes through.
std::vector<Mesh> finger() {
  return {bent({{1, 1}, 40, 40, Topology::diagonal, false}, [](Vec3 p) {
            return Vec3{p.x, float(0.18 * std::exp(-std::pow(std::hypot(p.x, p.z) / 0.12, 4)) - 0.1), p.z};
          }),
          make_grid({{0.8f, 0.8f}, 29, 29, Topology::centre, false})};
}

// A tube, and out of a hole in its side a narrower one, which turns down and ends inside of the first.
Mesh shirt() {
  constexpr std::uint32_t around = 48, up = 44;
  constexpr double radius = 0.2, height = 0.7, cell = height / up, sleeve = 0.4, turn = 0.11, bend = 2.3;
  RenderMesh render;
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    render.triangles.push_back({a, b, c});
    render.triangles.push_back({b, d, c});
  };
  for (std::uint32_t j = 0; j <= up; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * kPi * (i - 5.0) / around;
      render.positions.push_back({float(radius * std::cos(angle)), float(cell * j), float(radius * std::sin(angle))});
    }
  for (std::uint32_t j = 0; j < up; ++j)
    for (std::uint32_t i = 0; i < around; ++i)
      if (i >= 10 || j < 30 || j >= 40) {
        const std::uint32_t next = (i + 1) % around;
        quad(j * around + i, (j + 1) * around + i, j * around + next, (j + 1) * around + next);
      }
  std::vector<std::uint32_t> ring;
  for (std::uint32_t k = 0; k < 10; ++k) ring.push_back(30 * around + k);
  for (std::uint32_t k = 0; k < 10; ++k) ring.push_back((30 + k) * around + 10);
  for (std::uint32_t k = 10; k > 0; --k) ring.push_back(40 * around + k);
  for (std::uint32_t k = 10; k > 0; --k) ring.push_back((30 + k) * around);
  const std::vector<std::uint32_t> hem = ring;
  for (int k = 1; k <= 28; ++k) {
    const double s = sleeve * k / 28, angle = std::min(s, bend * turn) / turn, beyond = std::max(0.0, s - bend * turn);
    const double x = radius + turn * std::sin(angle) + beyond * std::cos(angle);
    const double y = 35 * cell - turn * (1 - std::cos(angle)) - beyond * std::sin(angle);
    std::vector<std::uint32_t> next;
    for (const std::uint32_t i : hem) {
      const Vec3 at = render.positions[i];
      const double q = 0.7 * (at.y - 35 * cell);
      next.push_back(static_cast<std::uint32_t>(render.positions.size()));
      render.positions.push_back({float(x + q * std::sin(angle)), float(y + q * std::cos(angle)), 0.7f * at.z});
    }
    for (std::size_t i = 0; i < ring.size(); ++i) quad(ring[i], ring[(i + 1) % ring.size()], next[i], next[(i + 1) % ring.size()]);
    ring = next;
  }
  return must(weld_mesh(std::move(render)));
}

// In turns in all three ways.
void advance_somehow(Simulation& simulation, int frame) {
  if (frame % 3 == 0) must(simulation.advance(kFrame));
  else if (frame % 3 == 1) must(simulation.submit(kFrame));
  else must(compute::run_once(simulation.device(), "host", [&](VkCommandBuffer commands) { must(simulation.record(commands, kFrame)); }));
}

void expect_apart(const compute::Device& device, Tangled tangled, std::uint64_t at_least, int within, double strained = 0.02) {
  const auto simulation = must(Simulation::create(device, tangled.scene, std::move(tangled.meshes)));
  const std::uint64_t first = crossings_in(*simulation);
  ASSERT_GE(first, at_least) << "nothing to untangle";
  int frame = 0;
  while (frame < within && (frame == 0 || crossings_in(*simulation) > 0)) advance_somehow(*simulation, frame++);
  const int frames = frame;
  for (int more = 0; more < 20; ++more) {
    advance_somehow(*simulation, frame++);
    ASSERT_EQ(crossings_in(*simulation), 0u) << "after frame " << frame;
  }
  must(simulation->advance(kFrame));
  const Counts counts = simulation->counts();
  std::printf("crossings at first %u, at most %u; none after %d frames, %u detections\n", static_cast<unsigned>(first),
              counts.crossings_most, frames, counts.detections);
  EXPECT_EQ(counts.crossings, 0u);
  EXPECT_GE(counts.crossings_most, at_least / 2) << "counted on the way";
  EXPECT_EQ(counts.contacts_overflowed + counts.non_finite, 0u);
  EXPECT_LT(strain_of(*simulation).mean, strained);
}

TEST_F(UntangleCase, a_corner_poked_through_its_own_sheet) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) expect_apart(device(), tangled({poked_corner(topology)}), 10, 60);
}

TEST_F(UntangleCase, two_sheets_that_cross_each_other_from_rim_to_rim) {
  expect_apart(device(), tangled(crossed_sheets({0, 0.1f, 0})), 60, 200);
}

TEST_F(UntangleCase, two_sheets_that_cut_into_each_other_halfway) {
  expect_apart(device(), tangled(crossed_sheets({0.35f, 0.1f, 0.3f})), 40, 200);
}

TEST_F(UntangleCase, a_finger_through_a_sheet) { expect_apart(device(), tangled(finger()), 60, 150); }

TEST_F(UntangleCase, a_shirt_whose_sleeve_starts_inside_its_side) { expect_apart(device(), tangled({shirt()}), 40, 200); }

TEST_F(UntangleCase, in_gravity_and_above_a_floor) {
  Tangled falling = tangled(crossed_sheets({0, 0.1f, 0}));
  falling.scene.gravity = {0, -9.81f, 0};
  falling.scene.colliders = {plane(-0.5)};
  expect_apart(device(), std::move(falling), 60, 200, 0.05);   // it lies there crumpled
}

TEST_F(UntangleCase, cloth_that_starts_through_a_mesh_collider) {
  Tangled made = tangled({make_grid({{1, 1}, 30, 30, Topology::diagonal, false})});
  made.scene.colliders.resize(1);
  made.scene.colliders[0].shape = ColliderShape::mesh;
  made.scene.colliders[0].mesh = "made here";
  made.meshes.push_back(
      bent({{0.5f, 0.5f}, 6, 6, Topology::diagonal, true}, [](Vec3 p) { return Vec3{p.x + 0.4f, p.y + 0.1f, 0.3f * p.x}; }));
  expect_apart(device(), std::move(made), 20, 200);
}

TEST_F(UntangleCase, nobody_is_untangled_who_does_not_want_it_and_what_cannot_be_costs_no_search) {
  Tangled kept = tangled(crossed_sheets({0, 0.1f, 0}));
  kept.scene.contacts.untangle = false;
  const auto simulation = must(Simulation::create(device(), kept.scene, std::move(kept.meshes)));
  const std::uint64_t before = crossings_in(*simulation);
  for (int frame = 0; frame < 30; ++frame) advance_somehow(*simulation, frame);
  EXPECT_EQ(crossings_in(*simulation), before);
  EXPECT_EQ(simulation->counts().crossings_most, 0u) << "not looked for";

  Tangled pinned = tangled(crossed_sheets({0, 0.1f, 0}));
  for (Cloth& cloth : pinned.scene.cloths) cloth.anchors.emplace_back().box = Anchor::Box{{-9, -9, -9}, {9, 9, 9}};
  const auto held = must(Simulation::create(device(), pinned.scene, std::move(pinned.meshes)));
  for (int frame = 0; frame < 30; ++frame) advance_somehow(*held, frame);
  must(held->advance(kFrame));
  EXPECT_LE(held->counts().detections, 5u);
}

TEST_F(UntangleCase, cloth_that_a_host_puts_through_cloth) {
  Tangled made = tangled(crossed_sheets({0, 0.6f, 0}));
  const auto simulation = must(Simulation::create(device(), made.scene, std::move(made.meshes)));
  for (int frame = 0; frame < 3; ++frame) advance_somehow(*simulation, frame);
  ASSERT_EQ(crossings_in(*simulation), 0u);
  std::vector<gpu::vec4> positions = must(simulation->read_positions());
  for (std::size_t i = 25 * 25; i < positions.size(); ++i) positions[i].y -= 0.5f;   // the upright sheet
  must(simulation->write_positions(positions));
  ASSERT_GT(crossings_in(*simulation), 50u);
  for (int frame = 0; frame < 60; ++frame) advance_somehow(*simulation, frame);
  EXPECT_EQ(crossings_in(*simulation), 0u);
}

TEST_F(UntangleCase, the_same_bits_twice_in_every_way_and_from_a_snapshot) {
  std::vector<std::uint64_t> hashes;
  for (int way = 0; way < 4; ++way) {
    Tangled made = tangled(crossed_sheets({0.35f, 0.1f, 0.3f}));
    auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
    for (int frame = 0; frame < 12; ++frame) {
      if (way == 3 && frame == 5) {
        const Snapshot saved = must(simulation->save());
        simulation = must(Simulation::create(device(), made.scene, made.meshes));
        must(simulation->restore(saved));
      }
      advance_somehow(*simulation, way < 3 ? way : 0);
    }
    EXPECT_GT(simulation->counts().crossings_most, 20u);
    hashes.push_back(hash_of(*simulation));
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

}  // namespace
}  // namespace weft
