// The passes of the gas against their twin in double precision, on any shapes, gases and substeps, and on what is degenerate.
#include <gtest/gtest.h>

#include "engine/effects/pressure/pressure.h"
#include "shaders/pressure/pressure.ref.h"
#include "tests/support/closed.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelPressure = GpuTest;

// Two gases in cloths of several parts, with a cloth between them that has none, and some particles held.
struct Gases {
  Scene scene;
  CookedFabric fabric;
  std::vector<gpu::vec4> places;   // where the substep begins
  std::vector<float> amounts;
  std::vector<gpu::GasState> states;
};

Gases gases_of(Random& random, double size, std::uint32_t substeps) {
  Gases s;
  s.scene = gas_scene();
  s.scene.solver.method = Method::jacobi;
  s.scene.solver.substeps = substeps;
  s.scene.cloths.resize(3, s.scene.cloths[0]);
  s.scene.cloths[1].pressure.reset();
  s.scene.cloths[0].pressure = Gas{.rest_pressure = std::pow(10, between(random, 0, 7)), .ambient = random() % 4 == 0 ? 0.0 : 101325.0};
  s.scene.cloths[2].pressure->volume = std::pow(10, between(random, -2, 1)) * std::pow(size, 3);
  s.fabric = must(cook(s.scene, std::vector{ball(0.5 * size, 4), ball(size, 1), ball(size, 2, {float(3 * size), 0, 0})}));
  for (gpu::vec4& p : s.fabric.positions)
    if (random() % 16 == 0) p.w = 0;
  s.amounts = {static_cast<float>(std::pow(10, between(random, -2, 2))), 1, random() % 4 == 0 ? 0.f : 1.f};
  s.states.resize(2);
  return s;
}

// What the passes do to the velocities of `s` (m/s), whose particles are `p` at the end of the substep if nothing holds them.
std::vector<reference::Vector> given(SinglePass& passes, const Gases& s, const std::vector<gpu::vec4>& p) {
  const std::vector<gpu::vec4> before = leading_to(p, s.fabric);
  passes.put(buffers::positions, s.fabric.positions);
  passes.put(buffers::velocities, before);
  passes.put_iterate(p);
  passes.put(buffers::gas_states, s.states);
  FrameInput input = frame_of(1);
  input.gas_amounts = s.amounts;
  passes.begin(input);
  passes.run("pressure_volume");
  passes.run("pressure");
  const auto after = passes.particles(buffers::velocities), iterate = passes.iterate();
  std::vector<reference::Vector> change;
  for (std::size_t i = 0; i < after.size(); ++i) {
    change.push_back(vector(after[i]) - vector(before[i]));
    if (!(change.back().norm() > 0)) continue;   // untouched, or not finite before
    const reference::Vector predicted = vector(s.fabric.positions[i]) + s.fabric.h * vector(after[i]);
    EXPECT_LT((vector(iterate[i]) - predicted).norm(), 4 * kRounding * (predicted.norm() + vector(s.fabric.positions[i]).norm())) << i;
  }
  return change;
}

struct Wanted {
  std::vector<reference::Vector> change;   // m/s
  double loose = 0;                        // m/s: what rounding of volumes may change
  gpu::GasState state;
};

// Of the g-th gas. The volume is a sum of terms that cancel; `terms` is that of their sizes.
Wanted wanted(const Gases& s, std::uint32_t g, const std::vector<gpu::vec4>& p) {
  const auto& gas = s.fabric.own.of<GasLists>().gases[g];
  const ClothRange& cloth = s.fabric.cloths[gas.cloth];
  std::vector<Triangle> triangles;
  for (Triangle t : s.fabric.triangles) {
    if (t[0] - cloth.first_particle >= cloth.particles) continue;
    for (std::uint32_t& corner : t) corner -= cloth.first_particle;
    triangles.push_back(t);
  }
  reference::Points x, next;
  for (std::uint32_t i = 0; i < cloth.particles; ++i) {
    x.push_back(vector(s.fabric.positions[cloth.first_particle + i]));
    next.push_back(vector(p[cloth.first_particle + i]));
  }
  const auto gradients = reference::volume_gradients(triangles, next);
  double mobility = 0, longest = 0, terms = 0;
  for (std::uint32_t i = 0; i < cloth.particles; ++i) {
    const double w = s.fabric.positions[cloth.first_particle + i].w;
    mobility += w * gradients[i].squaredNorm();
    longest = std::max(longest, w * gradients[i].norm());
    terms += gradients[i].norm() * (next[i] - next[0]).norm() + gradients[i].norm() * 1e-1 * (x[i] - next[i]).norm();
  }
  Wanted found;
  found.change.resize(cloth.particles, reference::Vector::Zero());
  if (longest == 0) return found;
  const double h = s.fabric.h, v = reference::volume(triangles, x);
  const double whole = reference::volume(triangles, next) + reference::undone(v, s.states[g].left, s.states[g].gained);
  const reference::GasLaw law{s.amounts[gas.cloth], gas.pressure, gas.volume, gas.ambient};
  const double most = gas.most / (h * longest);
  const double impulse = std::clamp(reference::gas_impulse(law, whole, mobility, h), -most, most);
  for (std::uint32_t i = 0; i < cloth.particles; ++i)
    found.change[i] = impulse * s.fabric.positions[cloth.first_particle + i].w * gradients[i];
  const double off = 30 * kRounding * (terms + std::abs(whole));
  const auto shifted = [&](double by) { return std::clamp(reference::gas_impulse(law, whole + by, mobility, h), -most, most); };
  found.loose = (std::abs(shifted(off) - shifted(-off)) + 1e-4 * std::abs(impulse)) * longest;
  const double moved = h * mobility * impulse;
  found.state = {static_cast<float>(reference::volume(triangles, next) + moved), static_cast<float>(moved)};
  return found;
}

TEST_F(KernelPressure, does_what_its_twin_does_on_any_shapes_gases_and_substeps) {
  Random random(1);
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    const double size = std::pow(10, between(random, -2, 1));
    Gases s = gases_of(random, size, 1u << (random() % 6));
    // As it is, crushed, or turned inside out.
    const double height = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 1e-2 : -0.5;
    for (gpu::vec4& p : s.fabric.positions) {
      const gpu::vec4 off = anywhere(random, 0.02 * size, 0);
      p = {p.x + off.x, static_cast<float>(height * p.y) + off.y, p.z + off.z, p.w};
    }
    for (gpu::GasState& state : s.states)
      state = {static_cast<float>(between(random, 0, 1) * std::pow(size, 3)),
               static_cast<float>(between(random, -0.1, 0.1) * std::pow(size, 3))};
    const auto p = moved(random, s.fabric, 0.02 * size);
    SinglePass passes(device(), s.scene, s.fabric, trial % 2 == 1);
    const auto change = given(passes, s, p);
    const auto states = passes.get<gpu::GasState>(buffers::gas_states, 2);
    for (std::uint32_t g = 0; g < 2; ++g) {
      const Wanted expected = wanted(s, g, p);
      const ClothRange& cloth = s.fabric.cloths[2 * g];
      double most = 0;
      for (const auto& v : expected.change) most = std::max(most, v.norm());
      const double coarse = 8 * kRounding * size / s.fabric.h;   // of velocities that lead from place to place
      for (std::uint32_t i = 0; i < cloth.particles; ++i)
        EXPECT_LT((change[cloth.first_particle + i] - expected.change[i]).norm(), expected.loose + coarse + 1e-5 * most) << g << ' ' << i;
      const double volume = std::abs(expected.state.left) + std::pow(size, 3);
      EXPECT_NEAR(states[g].left, expected.state.left, 1e-4 * (volume + std::abs(expected.state.gained)));
      EXPECT_NEAR(states[g].gained, expected.state.gained, 1e-3 * std::abs(expected.state.gained) + 1e-4 * volume);
    }
    for (std::uint32_t i = s.fabric.cloths[1].first_particle; i < s.fabric.cloths[2].first_particle; ++i)
      EXPECT_EQ(change[i].norm(), 0) << i << " has no gas about it";
    for (std::size_t i = 0; i < change.size(); ++i)
      if (s.fabric.positions[i].w == 0) { EXPECT_EQ(change[i].norm(), 0) << i << " is held"; }
  }
}

// Neither momentum nor a moment about where particles will be, whatever the shape.
TEST_F(KernelPressure, gives_a_free_cloth_no_momentum_and_turns_it_nowhere) {
  Random random(2);
  for (const float away : {0.f, 50.f}) {
    Gases s = gases_of(random, 1, 10);
    s.fabric = must(cook(s.scene, std::vector{ball(0.5, 4, {away, 0, 0}), ball(1, 1), ball(1, 2, {away, 0, 3})}));
    for (gpu::vec4& p : s.fabric.positions) {
      const gpu::vec4 off = anywhere(random, 0.05, 0);
      p = {p.x + off.x, 0.7f * p.y + off.y, p.z + off.z, p.w};
    }
    const auto p = s.fabric.positions;   // at rest: then velocities are as fine as their changes
    SinglePass passes(device(), s.scene, s.fabric);
    const auto change = given(passes, s, p);
    for (const std::uint32_t c : {0u, 2u}) {
      reference::Vector momentum = reference::Vector::Zero(), moment = momentum;
      double sizes = 0;
      const reference::Vector centre = vector(p[s.fabric.cloths[c].first_particle]);
      for (std::uint32_t k = 0; k < s.fabric.cloths[c].particles; ++k) {
        const std::uint32_t i = s.fabric.cloths[c].first_particle + k;
        const reference::Vector impulse = change[i] / double(p[i].w);
        momentum += impulse;
        moment += (vector(p[i]) - centre).cross(impulse);
        sizes += impulse.norm();
      }
      EXPECT_GT(sizes, 0);
      EXPECT_LT(momentum.norm(), 2e-6 * sizes) << away;
      EXPECT_LT(moment.norm(), 4e-6 * sizes) << away;
    }
  }
}

TEST_F(KernelPressure, does_nothing_where_there_is_nothing_to_push_or_a_place_is_not_finite) {
  Random random(3);
  Gases s = gases_of(random, 0.5, 10);
  for (const ClothRange& cloth : s.fabric.cloths)
    for (std::uint32_t k = 0; k < cloth.particles; ++k) {
      gpu::vec4& p = s.fabric.positions[cloth.first_particle + k];
      p = {0.25f, 1, -3, p.w};   // all in a point
    }
  {
    SinglePass passes(device(), s.scene, s.fabric);
    for (const auto& change : given(passes, s, s.fabric.positions)) EXPECT_EQ(change.norm(), 0);
  }
  for (const float bad : {NAN, INFINITY, 1e30f}) {
    Gases t = gases_of(random, 0.5, 10);
    t.fabric.positions[7] = {bad, 0, 0, 1};
    SinglePass passes(device(), t.scene, t.fabric);
    const auto change = given(passes, t, t.fabric.positions);
    const auto states = passes.get<gpu::GasState>(buffers::gas_states, 2);
    for (std::uint32_t i = 0; i < t.fabric.cloths[0].particles; ++i)
      if (i != 7) { EXPECT_EQ(change[i].norm(), 0) << bad << ' ' << i; }
    double other = 0;
    for (std::size_t i = t.fabric.cloths[2].first_particle; i < change.size(); ++i) other = std::max(other, change[i].norm());
    EXPECT_TRUE(std::isfinite(other) && other > 0) << "the other gas goes on";
    EXPECT_EQ(states[0].gained, 0);
  }
}

}  // namespace
}  // namespace weft
