// The contact passes against their twins, the order of candidates, and that what the passes let through does not cross.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/contact_passes.h"

namespace weft {
namespace {

using ContactKernel = GpuTest;

double separation(const reference::Pair& pair, const reference::Vector& n, const reference::Points& x) {
  double low = INFINITY, high = -INFINITY;
  for (int j = 0; j < 4; ++j) {
    const double h = n.dot(x[pair.particle[static_cast<std::size_t>(j)]]);
    if (pair.on_a(j)) low = std::min(low, h);
    else high = std::max(high, h);
  }
  return low - high;
}

// `margin`: how long bounds may be (m).
void compare_prepared(const compute::Device& device, bool gather_storage, double margin = 0) {
  Random random(11);
  const Tufts t = reference::tufts(random, 40, 12, 0.01);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, gather_storage);
  std::vector<double> bounds;
  std::vector<std::uint32_t> bits;
  for (std::size_t i = 0; margin > 0 && i < t.x.size(); ++i) {
    bounds.push_back(static_cast<float>(between(random, 0, 1.5 * margin)));
    bits.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(bounds.back())) | WEFT_PAIRED);
  }
  if (margin > 0) {
    passes.put(buffers::displacement_bounds, bits);
    gpu::Detection state = passes.detection();
    state.margin = static_cast<float>(margin);
    passes.put(buffers::detection, std::vector{state});
  }
  passes.run("contact_prepare");
  const auto wanted = reference::prepare(t, passes.recover, {bounds, margin}), got = passes.contacts();
  const auto by_prediction = reference::prepare(t, passes.recover);
  int more = 0;
  std::vector<std::uint32_t> counts(t.x.size());
  int active = 0;
  // Offsets and heights are differences of coordinates below 0.1 m, some ten roundings deep.
  const double tolerance = 16 * kRounding * 0.1;
  for (std::size_t k = 0; k < t.pairs.size(); ++k) {
    const reference::Pair& pair = t.pairs[k];
    const double gap = reference::closest(places(pair, t.x), pair.edges ? 2 : 1).distance;
    ASSERT_TRUE(got[k].directed);
    EXPECT_NEAR(got[k].normal.norm(), 1, 8 * kRounding);
    // No direction separates the sides by more than their distance, and only the right one by as much.
    EXPECT_NEAR(separation(pair, got[k].normal, t.x), gap, tolerance);
    ASSERT_EQ(got[k].touches, wanted[k].touches) << k;
    if (!got[k].touches) continue;
    ++active;
    more += !by_prediction[k].touches;
    EXPECT_NEAR(got[k].separation, wanted[k].separation, tolerance);
    EXPECT_NEAR(got[k].weights.sum(), 0, 8 * kRounding);
    EXPECT_NEAR(reference::offset(got[k].weights, places(pair, t.x)).norm(), gap, tolerance);
    for (int j = 0; j < 4; ++j) {
      EXPECT_GE(got[k].weights[j] * (pair.on_a(j) ? 1 : -1), 0);
      const std::uint32_t i = pair.particle[static_cast<std::size_t>(j)];
      counts[i] += t.inverse_masses[i] > 0;   // only a particle with mass has a share
    }
  }
  EXPECT_GT(active, 50);
  EXPECT_EQ(more > 10, margin > 0) << more;
  EXPECT_EQ(passes.get<std::uint32_t>(buffers::contact_counts, t.x.size()), counts);
  // Those with contacts are listed, each once.
  std::vector<std::uint32_t> touched = passes.get<std::uint32_t>(buffers::touched_particles, passes.detection().touchings), wanted_touched;
  for (std::uint32_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) wanted_touched.push_back(i);
  std::ranges::sort(touched);
  EXPECT_EQ(touched, wanted_touched);
  const std::size_t workgroup = passes.solver().contact_settings().workgroup;
  EXPECT_EQ(passes.detection().touched.x, (touched.size() + workgroup - 1) / workgroup);
}

TEST_F(ContactKernel, prepares_as_its_twin) { compare_prepared(device(), false); }
TEST_F(ContactKernel, prepares_as_its_twin_what_may_come_off_its_prediction) { compare_prepared(device(), false, 0.004); }
TEST_F(ContactKernel, prepares_as_its_twin_through_storage) { compare_prepared(device(), true); }

void compare_solved(const compute::Device& device, bool gather_storage) {
  Random random(12);
  const Tufts t = reference::tufts(random, 40, 12, 0.02);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, gather_storage);
  passes.run("contact_prepare");
  passes.run("contact_penetration");
  const gpu::Detection listed = passes.detection();
  EXPECT_GT(listed.listings[WEFT_PENETRATING], 20u);
  EXPECT_LT(listed.listings[WEFT_PENETRATING], listed.listings[WEFT_ACTIVE]);
  passes.run("contact_solve");
  const auto sums = passes.get<gpu::ivec4>(buffers::contact_sums, t.x.size());
  passes.run("contact_apply");
  EXPECT_EQ(passes.detection().listings[WEFT_PENETRATING], 0u) << "for the next iteration";
  std::vector<double> friction;
  for (std::size_t i = 0; i < t.x.size(); ++i) friction.push_back(kFriction[i % 2]);
  const auto contacts = passes.contacts();
  const auto wanted = reference::solve_contacts(t.pairs, contacts, t.x, t.p, t.inverse_masses, friction);
  double moved = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) moved = std::max(moved, (wanted[i] - t.p[i]).norm());
  EXPECT_GT(moved, 0.001);
  // At most twelve contacts of a particle round to a unit; a depth has the rounding of coordinates below 0.1 m, and of 1 m in the end.
  EXPECT_LT(largest_gap(passes.iterate(), wanted), 12 * passes.quantum + 16 * kRounding * 0.1 + 2 * kRounding);
  const double rounded_off = kRounding / passes.quantum + 1;   // of a place, which the next iteration makes up for
  for (const gpu::ivec4& sum : passes.get<gpu::ivec4>(buffers::contact_sums, t.x.size()))
    ASSERT_LE(std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)}), rounded_off);
  EXPECT_EQ(passes.counters().truncated, 0u);
  for (std::size_t i = 0; i < t.x.size(); ++i)
    ASSERT_TRUE(t.inverse_masses[i] > 0 || (sums[i].x == 0 && sums[i].y == 0 && sums[i].z == 0));
}

TEST_F(ContactKernel, solves_as_its_twin) { compare_solved(device(), false); }
TEST_F(ContactKernel, solves_as_its_twin_through_storage) { compare_solved(device(), true); }

TEST_F(ContactKernel, solving_keeps_momentum_to_the_unit) {
  Random random(13);
  const Tufts t = reference::tufts(random, 40, 12, 0.02, kNoneHeld);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  passes.run("contact_prepare");
  passes.run("contact_penetration");
  passes.run("contact_solve");
  const auto sums = passes.get<gpu::ivec4>(buffers::contact_sums, t.x.size());
  reference::Vector momentum = reference::Vector::Zero(), size = momentum;
  double rounding = 0;
  const auto counts = passes.get<std::uint32_t>(buffers::contact_counts, t.x.size());
  for (std::size_t i = 0; i < t.x.size(); ++i) {
    const reference::Vector units = reference::Vector(sums[i].x, sums[i].y, sums[i].z) / t.inverse_masses[i];
    momentum += units;
    size += units.cwiseAbs();
    rounding += 0.5 * counts[i] / t.inverse_masses[i];
  }
  EXPECT_GT(size.minCoeff(), 1e4 * momentum.cwiseAbs().maxCoeff());
  EXPECT_LT(momentum.cwiseAbs().maxCoeff(), rounding + 4 * kRounding * size.maxCoeff());
}

TEST_F(ContactKernel, many_deep_contacts_of_one_particle_do_not_overflow) {
  Tufts t;
  t.x = {{0, 0.0078125, 0}, {-0.0625, 0, -0.0625}, {0.0625, 0, -0.0625}, {0, 0, 0.0625}};
  t.p = t.x;
  t.p[0].y() -= 64;   // m
  t.inverse_masses = {10, 10, 10, 10};
  t.pairs.assign(1000, {{0, 1, 2, 3}, 0.00390625, false});
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device(), scene, fabric, t, false);
  passes.run("contact_prepare");
  passes.run("contact_penetration");
  passes.run("contact_solve");
  const auto sums = passes.get<gpu::ivec4>(buffers::contact_sums, 4);
  EXPECT_GT(sums[0].y, 1 << 29);
  EXPECT_LT(sums[1].y + sums[2].y + sums[3].y, -(1 << 29));
  EXPECT_LE(std::abs(std::int64_t(sums[0].y) + sums[1].y + sums[2].y + sums[3].y), 2000);   // half a unit a particle and contact
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST_F(ContactKernel, the_order_of_candidates_does_not_matter) {
  Random random(14);
  const Tufts t = reference::tufts(random, 40, 12, 0.02);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  auto pairs = t.pairs;
  std::vector<gpu::vec4> iterate, slides, positions;
  std::vector<gpu::uvec4> step_fractions;
  for (int order = 0; order < 3; ++order) {
    Passes passes(device(), scene, fabric, t, false);
    passes.put_pairs(pairs);
    for (const char* pass : {"contact_prepare", "contact_penetration", "contact_solve", "contact_apply"}) passes.run(pass);
    const auto solved = passes.iterate();
    passes.slide();
    const auto slid = passes.iterate();
    passes.limit();
    const auto limited = passes.get<gpu::uvec4>(buffers::step_fractions, t.x.size());
    passes.run("contact_finalize");
    if (order > 0) {
      EXPECT_TRUE(same_bits(solved, iterate));
      EXPECT_TRUE(same_bits(slid, slides));
      EXPECT_TRUE(same_bits(limited, step_fractions));
      EXPECT_TRUE(same_bits(passes.particles(buffers::positions), positions));
    }
    iterate = solved;
    slides = slid;
    step_fractions = limited;
    positions = passes.particles(buffers::positions);
    std::shuffle(pairs.begin(), pairs.end(), random);
  }
}

// One workgroup that does it all, and the passes with a thread a contact; and one that also ends the substep.
TEST_F(ContactKernel, few_contacts_are_solved_to_the_same_bits) {
  for (const double violence : {0.001, 0.02, 2.0})
    for (const bool gather_storage : {false, true})
      for (const bool collides : {false, true}) {
        Random random(30);
        const Tufts t = reference::tufts(random, 40, 12, violence);
        Scene scene = scene_of(t);
        if (collides) scene.colliders.resize(1);
        if (collides) scene.colliders[0].shape = ColliderShape::plane;
        const CookedFabric fabric = fabric_of(t, scene.solver);
        Passes many(device(), scene, fabric, t, gather_storage), few(device(), scene, fabric, t, gather_storage),
            none(device(), scene, fabric, t, gather_storage, false);
        gpu::Collider floor{};
        floor.normal_from = floor.normal_to = {0, 1, 0};
        for (Passes* passes : {&few, &many, &none}) {
          FrameInput input = frame_of(1);
          input.few_contacts = passes != &many;
          input.no_contacts = passes == &none;
          if (collides) input.colliders = {&floor, 1};
          passes->begin(input);
          passes->run("contact_prepare");
        }
        for (std::uint32_t k = 0; k < scene.contacts.iterations; ++k)
          for (const char* pass : {"contact_penetration", "contact_solve", "contact_apply"}) many.run(pass);
        many.slide();
        many.limit();
        few.run("contact_alone");
        none.run("contact_alone");
        ASSERT_TRUE(violence < 0.01 || few.detection().listings[WEFT_UNSAFE] > 10);
        EXPECT_GT(few.detection().listings[WEFT_ACTIVE], 10u);
        EXPECT_EQ(few.detection().listings[WEFT_UNSAFE], many.detection().listings[WEFT_UNSAFE]);
        EXPECT_EQ(few.detection().falls_back, many.detection().falls_back);
        EXPECT_TRUE(same_bits(few.iterate(), many.iterate()));
        for (const Buffer* row : {&buffers::step_fractions, &buffers::contact_sums})
          EXPECT_TRUE(same_bits(few.get<gpu::uvec4>(*row, t.x.size()), many.get<gpu::uvec4>(*row, t.x.size()))) << row->name;
        for (Passes* passes : {&few, &many}) passes->run("contact_finalize");
        const std::size_t particles = t.x.size();
        const auto words = [&](const Passes& passes, const Buffer& row) { return passes.get<std::uint32_t>(row, particles); };
        for (const Passes* passes : {&few, &none}) {
          EXPECT_EQ(passes->counters().truncated, many.counters().truncated);
          EXPECT_EQ(passes->detection().needs_detection, many.detection().needs_detection);
          for (const Buffer* row : {&buffers::contact_penetrations, &buffers::contact_counts})
            EXPECT_TRUE(same_bits(words(*passes, *row), std::vector<std::uint32_t>(particles))) << row->name;
          EXPECT_TRUE(same_bits(passes->get<gpu::ivec4>(buffers::contact_sums, particles), std::vector<gpu::ivec4>(particles)));
          const auto fractions = [&](const Passes& of) { return of.get<gpu::uvec4>(buffers::step_fractions, particles); };
          EXPECT_TRUE(same_bits(fractions(*passes), fractions(many)));
          for (const Buffer* row : {&buffers::positions, &buffers::velocities})
            EXPECT_TRUE(same_bits(passes->particles(*row), many.particles(*row))) << row->name;
          EXPECT_TRUE(same_bits(passes->iterate(), many.iterate()));
        }
      }
}

void compare_slid(const compute::Device& device, double violence, bool gather_storage) {
  const Tufts t = violent_tufts(16, violence);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, gather_storage);
  passes.run("contact_prepare");
  reference::Points p = t.p;
  std::vector<std::uint32_t> ranks = reference::rank_particles(t.pairs, passes.contacts(), t.x, t.p, t.inverse_masses);
  int slid = 0;
  for (std::uint32_t round = 0; round < WEFT_SLIDES; ++round) {
    for (const char* pass : {"contact_slide", "contact_slide_apply"}) passes.run(pass);
    const auto wanted = reference::slide(t.pairs, passes.contacts(), t.x, p, t.inverse_masses, ranks);
    const auto got = points(passes.iterate());
    for (std::size_t i = 0; i < t.x.size(); ++i) {
      slid += (got[i] - p[i]).norm() > 1e-5;
      EXPECT_LT((got[i] - wanted[i]).norm(), 100 * kRounding * (1 + violence)) << i << " of " << violence;
      EXPECT_TRUE(t.inverse_masses[i] > 0 || got[i] == t.p[i]) << i;
    }
    const auto told = passes.get<gpu::uvec4>(buffers::slides, 2 * t.x.size());
    for (std::size_t i = 0; i < t.x.size(); ++i) EXPECT_EQ(told[2 * i + 1].w, ranks[i]) << i << " of " << violence;
    p = got;
  }
  EXPECT_TRUE(violence < 0.002 || std::ranges::count(ranks, reference::kRankTold) > 0);
  EXPECT_GT(slid, violence > 0.002 ? 30 : 0);
}

TEST_F(ContactKernel, slides_as_its_twin) {
  for (const double violence : {0.001, 0.005, 0.02, 0.2, 2.0}) compare_slid(device(), violence, false);
}
TEST_F(ContactKernel, slides_as_its_twin_through_storage) { compare_slid(device(), 0.02, true); }

// `late`: kinematic particles are behind their targets, some of them by more than the kinematic lag limit, so that cloth may be crossed.
void compare_limited(const compute::Device& device, double violence, bool gather_storage, bool late = false) {
  const Tufts t = violent_tufts(15, violence);
  const Scene scene = scene_of(t);
  const CookedFabric fabric = fabric_of(t, scene.solver);
  Passes passes(device, scene, fabric, t, gather_storage);
  Random random(16);
  std::vector<std::uint32_t> bits;
  std::vector<double> lags;
  for (const double w : t.inverse_masses) {
    const auto lag = static_cast<float>(late && w == 0 ? between(random, 0, 0.1) : 0);
    bits.push_back(std::bit_cast<std::uint32_t>(lag));
    lags.push_back(lag);
  }
  passes.put(buffers::kinematic_lags, bits);
  passes.run("contact_prepare");
  passes.limit();
  const auto limit = reference::limit_motion(t.pairs, passes.contacts(), t.x, t.p, t.inverse_masses, lags);
  const auto fractions = passes.step_fractions();
  EXPECT_EQ(passes.detection().falls_back != 0, limit.falls_back);
  int truncated = 0;
  for (std::size_t i = 0; i < t.x.size(); ++i) {
    truncated += fractions[i] < 1;
    const double way = (t.p[i] - t.x[i]).norm();
    // Heights have the rounding of a way or a tuft; a way that grazes a plane makes up to a thousandth of that a fraction.
    EXPECT_NEAR(fractions[i], limit.fractions[i], 1000 * 8 * kRounding * (1 + 0.1 / std::max(way, 1e-6))) << i << " of " << violence;
  }
  EXPECT_GT(truncated, violence > 0.002 ? 30 : 0);
  if (late) return;
  passes.run("contact_finalize");
  EXPECT_EQ(reference::meetings(t.pairs, t.x, points(passes.particles(buffers::positions))), 0u) << violence;
  EXPECT_EQ(passes.counters().truncated, static_cast<std::uint32_t>(truncated));
  EXPECT_EQ(passes.counters().non_finite, 0u);
}

TEST_F(ContactKernel, limits_as_its_twin_and_nothing_crosses) {
  for (const double violence : {0.001, 0.005, 0.02, 0.2, 2.0}) compare_limited(device(), violence, false);
}
TEST_F(ContactKernel, limits_as_its_twin_where_kinematic_particles_must_go_on) {
  for (const double violence : {0.02, 0.2}) compare_limited(device(), violence, false, true);
}
TEST_F(ContactKernel, limits_as_its_twin_through_storage) { compare_limited(device(), 0.02, true); }

}  // namespace
}  // namespace weft
