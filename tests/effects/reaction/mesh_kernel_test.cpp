// What contacts give to a mesh collider against the twin, and that all that a substep's contacts take from cloth beside it is given to it.
#include <gtest/gtest.h>

#include <cstring>

#include "engine/effects/reaction/reaction.h"
#include "shaders/reaction/reaction.ref.h"
#include "tests/support/contact_passes.h"

namespace weft {
namespace {

using MeshReactionKernel = GpuTest;
using reference::Momentum;
using reference::Pair;
using reference::Vector;

const Vector kCentre(0.2, -0.1, 0.3);

// Of each tuft the first half is cloth and the second of a mesh collider. `mixed`: pairs of cloth with cloth, too.
struct Beside {
  Tufts t;
  Scene scene;
  CookedFabric fabric;
  std::vector<double> friction;
};

bool is_mesh(std::uint32_t i) { return i % reference::kTuft >= reference::kTuft / 2; }

Beside beside_mesh(std::uint64_t seed, double violence, bool mixed) {
  Random random(seed);
  Beside b;
  b.t = reference::tufts(random, 40, 0, violence);
  const auto some = [&](std::uint32_t first, std::uint32_t half) {   // four particles of a tuft's half, in any order
    std::array<std::uint32_t, 4> order;
    for (std::uint32_t k = 0; k < 4; ++k) order[k] = first + 4 * half + k;
    std::shuffle(order.begin(), order.end(), random);
    return order;
  };
  for (std::uint32_t first = 0; first < b.t.x.size(); first += reference::kTuft)
    for (int k = 0; k < 12; ++k) {
      const std::uint32_t half = k % 2;
      const auto a = some(first, half), c = some(first, mixed && k % 3 == 0 && half == 0 ? 0 : 1 - half);
      const double separation = static_cast<float>(between(random, 0.001, 0.01));
      if (random() % 2 == 0) b.t.pairs.push_back({{a[0], c[a[0] == c[0] ? 1 : 0], c[2], c[3]}, separation, false});
      else b.t.pairs.push_back({{a[0], a[1], c[2], c[3]}, separation, true});
      std::array<std::uint32_t, 4> sorted = b.t.pairs.back().particle;
      std::ranges::sort(sorted);
      if (std::ranges::adjacent_find(sorted) != sorted.end()) b.t.pairs.pop_back();   // a particle twice
    }
  for (std::uint32_t i = 0; i < b.t.x.size(); ++i)
    if (is_mesh(i)) b.t.inverse_masses[i] = 0, b.t.p[i] = b.t.x[i];
  b.scene = scene_of(b.t);
  b.scene.reactions = true;
  b.scene.colliders.resize(1);
  b.scene.colliders[0].shape = ColliderShape::mesh;
  b.fabric = fabric_of(b.t, b.scene.solver);
  b.fabric.collider_meshes.push_back({0, 0, 0, 0, 0, 0, 0});
  for (std::uint32_t i = 0; i < b.t.x.size(); ++i) {
    b.fabric.velocities[i].w = std::bit_cast<float>(std::uint32_t{is_mesh(i)});
    b.friction.push_back(double(kFriction[is_mesh(i)]));
  }
  return b;
}

FrameInput input_of(const std::vector<gpu::Collider>& centre, bool few) {
  FrameInput input = frame_of(1);
  input.few_contacts = few;
  input.colliders = centre;
  return input;
}

std::vector<gpu::Collider> centres() {
  std::vector<gpu::Collider> all(1);
  all[0].centre_from = {5, 6, 7};
  all[0].centre_to = {static_cast<float>(kCentre.x()), static_cast<float>(kCentre.y()), static_cast<float>(kCentre.z())};
  return all;
}

Momentum given_by(const SinglePass& passes, const Beside& b) {
  const Reaction told = reaction_between({}, passes.get<gpu::Reaction>(buffers::reactions, 1)[0], reaction_quantum(b.fabric));
  return {Vector(told.impulse.x, told.impulse.y, told.impulse.z), Vector(told.angular_impulse.x, told.angular_impulse.y, told.angular_impulse.z)};
}

void compare_given(const compute::Device& device, bool gather_storage, bool spoilt) {
  Beside b = beside_mesh(41, 0.02, true);
  if (spoilt)   // the cloth of the first tuft is nowhere
    for (std::uint32_t i = 0; i < 4; ++i) b.t.p[i] = Vector(NAN, INFINITY, -1e25);
  const auto colliders = centres();
  Passes passes(device, b.scene, b.fabric, b.t, gather_storage);
  passes.begin(input_of(colliders, false));
  passes.run("contact_prepare");
  passes.run("contact_penetration");
  passes.run("contact_solve");
  const auto contacts = passes.contacts();
  auto wanted_pairs = b.t.pairs;
  auto wanted_contacts = contacts;
  for (std::size_t k = 0; spoilt && k < contacts.size(); ++k)
    if (b.t.pairs[k].particle[0] < reference::kTuft) wanted_contacts[k].touches = false;
  Momentum wanted;
  double exchanged = 0;
  reference::for_each_correction(wanted_pairs, wanted_contacts, b.t.x, b.t.p, b.t.inverse_masses, b.friction,
                                 [&](std::size_t k, std::uint32_t i, const Vector& moved) {
                                   const Pair& pair = wanted_pairs[k];
                                   if (is_mesh(i) || is_mesh(pair.particle[0]) == is_mesh(pair.particle[3])) return;
                                   const Momentum own = reference::reaction(kCentre, b.t.p[i], b.t.p[i] + moved, b.t.inverse_masses[i], b.fabric.h);
                                   wanted += own;
                                   exchanged += own.linear.norm();
                                 });
  EXPECT_GT(exchanged, 0.2) << "the tufts test nothing";
  const Momentum got = given_by(passes, b);
  EXPECT_LT((got.linear - wanted.linear).norm(), 1e-5 * exchanged);   // depths are off by rounding of coordinates, levers reach over a metre
  EXPECT_LT((got.angular - wanted.angular).norm(), 3e-5 * exchanged);
}

TEST_F(MeshReactionKernel, a_contact_gives_what_its_twin_does) { compare_given(device(), false, false); }
TEST_F(MeshReactionKernel, a_contact_gives_what_its_twin_does_through_storage) { compare_given(device(), true, false); }
TEST_F(MeshReactionKernel, particles_that_are_not_finite_spoil_no_sum) { compare_given(device(), false, true); }

// With iterations, slides, limits and the substep's end: where all pairs are with the mesh, what is missing of cloth's momentum is the mesh's.
TEST_F(MeshReactionKernel, all_that_cloth_beside_it_loses_is_given_to_it_whoever_does_it_and_in_any_order) {
  for (const double violence : {0.002, 0.02, 0.2}) {
    SCOPED_TRACE(violence);
    Beside b = beside_mesh(43, violence, false);
    const auto colliders = centres();
    std::vector<gpu::Reaction> first;
    Random random(3);
    for (int turn = 0; turn < 4; ++turn) {
      const bool few = turn % 2 == 1;
      Passes passes(device(), b.scene, b.fabric, b.t, turn > 1);
      passes.begin(input_of(colliders, few));
      if (turn > 1) {
        auto pairs = b.t.pairs;
        std::shuffle(pairs.begin(), pairs.end(), random);
        passes.put_pairs(pairs);
      }
      passes.run("contact_prepare");
      if (few) {
        passes.run("contact_alone");
      } else {
        for (std::uint32_t k = 0; k < b.scene.contacts.iterations; ++k)
          for (const char* pass : {"contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
        passes.slide();
        passes.limit();
      }
      passes.run("contact_finalize");
      const auto ends = passes.particles(buffers::positions);
      Momentum wanted;
      double exchanged = 0;
      for (std::uint32_t i = 0; i < ends.size(); ++i) {
        if (is_mesh(i)) continue;
        const Momentum own = reference::reaction(kCentre, b.t.p[i], vector(ends[i]), b.t.inverse_masses[i], b.fabric.h);
        wanted += own;
        exchanged += own.linear.norm();
      }
      EXPECT_GT(exchanged, 0.2) << "the tufts test nothing";
      const Momentum got = given_by(passes, b);
      EXPECT_LT((got.linear - wanted.linear).norm(), 1e-5 * exchanged);
      const auto told = passes.get<gpu::Reaction>(buffers::reactions, 1);
      if (turn == 0) first = told;
      EXPECT_EQ(std::memcmp(told.data(), first.data(), sizeof(gpu::Reaction)), 0) << turn;
      for (const gpu::ivec4& sum : passes.get<gpu::ivec4>(buffers::contact_sums, ends.size())) ASSERT_EQ(sum.w, 0) << "not forgotten";
    }
  }
}

}  // namespace
}  // namespace weft
