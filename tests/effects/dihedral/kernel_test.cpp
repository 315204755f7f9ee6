// Hinges: the passes against their twin on crumpled and on degenerate poses; that momentum is kept; and that a hinge comes back to any rest
// angle from any other, stiff or soft, whatever the pose.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/simulation.h"
#include "shaders/dihedral/dihedral.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using DihedralKernel = GpuTest;

constexpr double kPi = std::numbers::pi;

// A sheet of 1 m by 1 m in pleats of two cells, at right angles, beside one that is flat and has stencils.
struct Pleated {
  Scene scene = without_contacts();
  CookedFabric fabric;
};

Pleated pleated(std::uint32_t iterations, Averaging averaging, double rigidity, bool held = true) {
  Pleated made;
  made.scene.solver = {.rate = 600, .substeps = 1, .iterations = iterations, .averaging = averaging, .relaxation = 1.1};
  made.scene.gravity = {0, 0, 0};
  for (const BendRest rest : {BendRest::mesh, BendRest::flat}) {
    Cloth& cloth = made.scene.cloths.emplace_back();
    cloth.grid = Grid{.size = {1, 1}, .cells_x = 12, .cells_y = 9, .topology = Topology::centre};
    cloth.fabric.bend = rigidity;
    cloth.tethers = false;
    cloth.bend_rest = rest;
    cloth.start.imperfection = 0;
    if (held && rest == BendRest::mesh) cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  }
  auto meshes = must(make_meshes(made.scene));
  for (Vec3& p : meshes[0].points) {
    const double phase = std::fmod(p.x + 0.5, 2.0 / 6);
    p.y = static_cast<float>(std::min(phase, 2.0 / 6 - phase));
  }
  made.fabric = must(cook(made.scene, meshes));
  return made;
}

std::vector<gpu::vec4> crumpled(const CookedFabric& fabric, Random& random) {
  std::vector<gpu::vec4> pose;
  for (const gpu::vec4& x : fabric.positions) {
    const gpu::vec4 d = anywhere(random, 0.015, 0);
    pose.push_back({x.x + d.x, x.y + d.y, x.z + d.z, x.w});
  }
  return pose;
}

std::vector<reference::Hinge> twins_of(const CookedFabric& fabric) {
  std::vector<reference::Hinge> hinges;
  for (const gpu::Hinge& h : fabric.hinges)
    hinges.push_back({{h.particle[0], h.particle[1], h.particle[2], h.particle[3]}, std::atan2(h.rest_sine, h.rest_cosine), h.compliance});
  return hinges;
}

// Runs all iterations of a substep's hinges on both sides.
double gap(const compute::Device& device, const Pleated& made, const std::vector<gpu::vec4>& pose, bool gather_storage) {
  SinglePass passes(device, made.scene, made.fabric, gather_storage);
  passes.put_iterate(pose);
  passes.begin(frame_of(1));
  reference::Points twin = points(pose);
  const auto hinges = twins_of(made.fabric);
  const auto masses = inverse_masses(made.fabric);
  std::vector<double> lambda(hinges.size());
  const auto averaging =
      made.scene.solver.averaging == Averaging::mass_split ? reference::Averaged::mass_split : reference::Averaged::count;
  for (std::uint32_t k = 0; k < made.scene.solver.iterations; ++k) {
    twin = reference::relax_hinges(hinges, twin, masses, lambda, made.fabric.h, made.scene.solver.relaxation, averaging);
    passes.run("dihedral", static_cast<int>(k));
    passes.run("dihedral_gather", static_cast<int>(k));
  }
  return largest_gap(passes.iterate(), twin);
}

// The pose after one visit to all hinges.
std::vector<gpu::vec4> visited(const compute::Device& device, const Pleated& made, const std::vector<gpu::vec4>& pose) {
  SinglePass passes(device, made.scene, made.fabric);
  passes.put_iterate(pose);
  passes.begin(frame_of(1));
  passes.run("dihedral");
  passes.run("dihedral_gather");
  return passes.iterate();
}

TEST_F(DihedralKernel, hinges_do_what_their_twin_does_on_crumpled_pleats) {
  for (const Averaging averaging : {Averaging::mass_split, Averaging::count})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const double rigidity : {1e-5, 1.0}) {
        Random random(iterations);
        const Pleated made = pleated(iterations, averaging, rigidity);
        const std::vector<gpu::vec4> pose = crumpled(made.fabric, random);
        // Poses within 1 m and cells of 0.1 m, whose heights are down to 0.03 m: an angle is known to 30 roundings of a metre, and each
        // iteration carries on the error of the one before, several fold at an angle that is far off.
        EXPECT_LT(gap(device(), made, pose, iterations == 3), 100 * kRounding * iterations * iterations)
            << "averaging " << static_cast<int>(averaging) << ", " << iterations << " iterations, " << rigidity << " N m";
      }
}

TEST_F(DihedralKernel, a_pose_at_rest_is_left_to_rounding) {
  const Pleated made = pleated(1, Averaging::mass_split, 1.0);
  EXPECT_LT(largest_gap(visited(device(), made, made.fabric.positions), points(made.fabric.positions)), 4 * kRounding);
}

// Everything in one point, on a line, far away, not a number: particles of other hinges do not notice, and all others stay finite.
TEST_F(DihedralKernel, lost_and_degenerate_poses_take_nobody_along) {
  const Pleated made = pleated(1, Averaging::mass_split, 1.0);
  const auto n = made.fabric.positions.size();
  for (int kind = 0; kind < 6; ++kind) {
    std::vector<gpu::vec4> pose = made.fabric.positions;
    std::vector<bool> lost(n);
    for (std::size_t i = 0; i < n; ++i) {
      gpu::vec4& p = pose[i];
      if (kind == 0) p = {0.3f, 0.2f, 0.1f, p.w};
      if (kind == 1) p = {p.x, 0, 0, p.w};
      if (kind == 2) p = {1e-9f * p.x, 1e-9f * p.y, 1e-9f * p.z, p.w};
      lost[i] = kind > 2 && i % 17 == 0;
      if (lost[i]) p.y = kind == 3 ? NAN : kind == 4 ? INFINITY : 1e30f;
    }
    const auto after = visited(device(), made, pose);
    for (std::size_t i = 0; i < n; ++i)
      if (!lost[i]) { ASSERT_LT((vector(after[i]) - vector(pose[i])).norm(), 1) << "kind " << kind << ", particle " << i; }
  }
}

// One mesh of free hinges, 0.1 m wide and their leaves 0.1 m long, for every pair of angles: at rest at the first, started at the second.
struct Hinges {
  Mesh mesh;
  std::vector<Vec3> start;   // of the mesh's points
  std::size_t count = 0;
};

Hinges all_hinges(int step) {
  RenderMesh render;
  std::vector<Vec3> start;
  const auto add = [](std::vector<Vec3>& to, double angle, Vec3 at) {
    const auto leaf = [&](double turn, float z) {
      to.push_back({at.x + static_cast<float>(0.1 * std::cos(turn)), at.y + static_cast<float>(0.1 * std::sin(turn)), at.z + z});
    };
    to.push_back({at.x, at.y, at.z});
    to.push_back({at.x, at.y, at.z + 0.1f});
    leaf(angle / 2, 0.03f);
    leaf(kPi - angle / 2, 0.06f);
  };
  for (int rest = -180 + step; rest < 180; rest += step)
    for (int from = -180; from < 180; from += step) {
      const Vec3 at{0.003f * static_cast<float>(rest), 0, 0.003f * static_cast<float>(from)};
      const auto first = static_cast<std::uint32_t>(start.size());
      add(render.positions, rest * kPi / 180, at);
      add(start, from * kPi / 180, at);
      render.triangles.push_back({first, first + 1, first + 2});
      render.triangles.push_back({first + 1, first, first + 3});
    }
  Hinges hinges;
  hinges.mesh = must(weld_mesh(std::move(render)));
  hinges.count = start.size() / 4;
  hinges.start.resize(hinges.mesh.points.size());
  for (std::size_t v = 0; v < start.size(); ++v) hinges.start[hinges.mesh.point_of[v]] = start[v];
  return hinges;
}

double farthest_off(const CookedFabric& fabric, const std::vector<gpu::vec4>& positions) {
  double most = 0;
  for (const reference::Hinge& hinge : twins_of(fabric)) {
    const auto p = points(positions);
    const double off =
        reference::hinge_value(hinge.rest, {p[hinge.particle[0]], p[hinge.particle[1]], p[hinge.particle[2]], p[hinge.particle[3]]});
    if (!(std::abs(off) <= most)) most = std::abs(off);
  }
  return most;
}

TEST_F(DihedralKernel, a_free_hinge_comes_back_to_any_rest_angle_from_any_other) {
  const Hinges hinges = all_hinges(30);
  ASSERT_EQ(hinges.mesh.points.size(), 4 * hinges.count) << "two hinges were welded";
  for (const Method method : {Method::jacobi, Method::strands, Method::gauss_seidel})
    for (const double rigidity : {0.01, 1e3}) {
      Scene scene = without_contacts();
      scene.gravity = {0, 0, 0};
      scene.solver.method = method;
      Cloth& cloth = scene.cloths.emplace_back();
      cloth.mesh = "hinges";
      cloth.bend_rest = BendRest::mesh;
      cloth.fabric.bend = rigidity;
      cloth.fabric.damping = 8;   // of an angle, exp(-4 t)
      cloth.fabric.stretch = cloth.fabric.shear = std::numeric_limits<double>::infinity();
      const auto simulation = must(Simulation::create(device(), scene, {hinges.mesh}));
      const CookedFabric& fabric = simulation->fabric();
      ASSERT_EQ(fabric.hinges.size(), hinges.count);
      auto pose = must(simulation->read_positions());
      for (std::size_t v = 0; v < fabric.surface_rows.size(); ++v) {
        gpu::vec4& p = pose[fabric.surface_rows[v].x];
        const Vec3 at = hinges.start[hinges.mesh.point_of[v]];
        p = {at.x, at.y, at.z, p.w};
      }
      must(simulation->write_positions(pose));
      EXPECT_GT(farthest_off(fabric, pose), 3.1);
      run(*simulation, 3);
      EXPECT_LT(farthest_off(fabric, must(simulation->read_positions())), 1e-3) << rigidity << " N m, method " << static_cast<int>(method);
      EXPECT_EQ(simulation->counts().non_finite, 0u);
    }
}

// What a visit moves has no momentum and no moment about any point, where masses are split.
TEST_F(DihedralKernel, hinges_move_no_centre_of_mass_and_turn_nothing) {
  Random random(8);
  const Pleated made = pleated(1, Averaging::mass_split, 1.0, false);
  const auto pose = crumpled(made.fabric, random);
  const auto after = visited(device(), made, pose);
  reference::Vector sum = reference::Vector::Zero(), moment = sum;
  double size = 0;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const reference::Vector moved = vector(after[i]) - vector(pose[i]);
    sum += moved / pose[i].w;
    moment += vector(pose[i]).cross(moved) / pose[i].w;
    size += moved.norm() / pose[i].w;
  }
  EXPECT_GT(size * pose[0].w, 0.1);
  // Each of the moves, of some millimetres, is rounded as a place within 1 m.
  EXPECT_LT(sum.norm(), kRounding / 2e-3 * size);
  EXPECT_LT(moment.norm(), kRounding / 2e-3 * size);
}

}  // namespace
}  // namespace weft
