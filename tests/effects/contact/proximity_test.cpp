// The twins of proximity and of the detection against what they must be by themselves: no sampled pair of points is closer
// than the closest, and no sampled motion lets a pair that was left out come as close as it must keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shaders/contact/detect.ref.h"
#include "tests/support/twins.h"

namespace weft::reference {
namespace {

// Random weights that are not negative and sum to 1; corners and edges as often as the inside.
Eigen::VectorXd mixture(Random& random, int count) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);
  do
    for (int k = 0; k < count; ++k) weights[k] = random() % 3 == 0 ? 0 : -std::log(between(random, 1e-12, 1));
  while (weights.sum() == 0);
  return weights / weights.sum();
}

Weights sampled(Random& random, int a) {
  Weights weights;
  weights << mixture(random, a), -mixture(random, 4 - a);
  return weights;
}

// Four points in general position, in a plane, on a line, or with two at one place.
Quad random_quad(Random& random) {
  const double scale = std::pow(10, between(random, -3, 1));
  Quad x;
  for (Vector& v : x) v = scale * anywhere(random, 1);
  const auto kind = random() % 5;
  if (kind == 1)
    for (Vector& v : x) v.z() = 0;
  if (kind == 2)
    for (Vector& v : x) v = v.x() * Vector(1, 0.5, -0.25);
  if (kind == 3) x[3] = x[2];
  return x;
}

TEST(ProximityTwin, no_two_sampled_points_are_closer_and_its_weights_are_of_the_two_sides) {
  Random random(41);
  for (int trial = 0; trial < 2000; ++trial) {
    const int a = 1 + trial % 2;
    const Quad x = random_quad(random);
    const Proximity found = closest(x, a);
    double sum_a = 0, sum_b = 0;
    for (int j = 0; j < 4; ++j) {
      EXPECT_GE(j < a ? found.weights[j] : -found.weights[j], 0);
      (j < a ? sum_a : sum_b) += found.weights[j];
    }
    EXPECT_NEAR(sum_a, 1, 1e-9);
    EXPECT_NEAR(sum_b, -1, 1e-9);
    EXPECT_EQ(found.distance, offset(found.weights, x).norm());
    for (int sample = 0; sample < 200; ++sample) EXPECT_LE(found.distance, offset(sampled(random, a), x).norm() + 1e-12);
  }
}

TEST(ProximityTwin, moving_the_closest_points_along_either_side_brings_them_no_closer) {
  Random random(42);
  for (int trial = 0; trial < 2000; ++trial) {
    const int a = 1 + trial % 2;
    const Quad x = random_quad(random);
    const Proximity found = closest(x, a);
    for (int sample = 0; sample < 20; ++sample) {
      const Weights step = sampled(random, a) - found.weights;
      EXPECT_GE(offset(found.weights + 1e-4 * step, x).norm(), found.distance - 1e-10);
    }
  }
}

TEST(ProximityTwin, crossing_sides_touch) {
  Random random(43);
  for (int trial = 0; trial < 500; ++trial) {
    const int a = 1 + trial % 2;
    Quad x = random_quad(random);
    // Side A is moved so that a point of it lies on side B.
    const Vector d = offset(sampled(random, a), x);
    for (int j = 0; j < a; ++j) x[static_cast<std::size_t>(j)] -= d;
    EXPECT_LT(closest(x, a).distance, 1e-9);
  }
}

// Two sides, near each other and moving fast, of which one may be held.
Tracks random_tracks(Random& random) {
  Tracks t;
  const double margin = std::pow(10, between(random, -3, -1));
  const Vector drift = anywhere(random, std::pow(10, between(random, -2, 1)));
  const double apart = std::pow(10, between(random, -3, 0)), speed = std::pow(10, between(random, -3, 0));
  for (std::uint32_t i = 0; i < 4; ++i) {
    t.references.push_back(anywhere(random, 0.3));
    t.rest.push_back(anywhere(random, 0.3));
    t.paths.push_back(drift + anywhere(random, speed));
    t.bounds.push_back(between(random, 1, 2) * margin);
    t.thickness.push_back(0.01);
    t.inverse_masses.push_back(1);
    t.cloth.push_back(0);
  }
  const Vector away = anywhere(random, 1).normalized() * apart;
  for (Vector& r : t.references) r += (&r - t.references.data()) < 2 ? away : Vector(-away);
  return t;
}

// Nearly as near as the pair can be and still be left out. The directions that count turn on the way, so the steps are halved where
// one would be too long.
void bring_together(Tracks& t, const Particles& all, int a) {
  double share = 1;
  for (int k = 0; k < 12; ++k) {
    const double spare = spare_distance(t, all, a);
    const Quad x{t.references[0], t.references[1], t.references[2], t.references[3]};
    const Vector d = offset(closest(x, a).weights, x);
    const Points before = t.references;
    for (std::size_t i = 0; i < static_cast<std::size_t>(a); ++i) t.references[i] -= share * spare * d.normalized();
    if (spare_distance(t, all, a) >= 0) continue;
    t.references = before;
    share /= 2;
  }
}

// A place on the displacement bound; more often than not as far towards the other side as it allows.
Vector within_bound(Random& random, const Tracks& t, std::uint32_t i, double substeps, const Vector& towards) {
  const Vector way = t.paths[i] * std::min(substeps, kHorizon) / kHorizon;
  return t.references[i] + way + (random() % 4 == 0 ? anywhere(random, 1).normalized() : towards) * t.bounds[i];
}

// Where a particle may be at a substep's end: on its displacement bound, or stopped on its way there from the bound a substep ago.
Vector where_it_may_be(Random& random, const Tracks& t, std::uint32_t i, double substeps, const Vector& towards) {
  const Vector from = within_bound(random, t, i, substeps - 1, towards), to = within_bound(random, t, i, substeps, towards);
  const double fraction[] = {0, 1, between(random, 0, 1)};
  return from + fraction[random() % 3] * (to - from);
}

TEST(DetectTwin, a_pair_that_is_left_out_keeps_its_distance_wherever_its_particles_may_go) {
  Random random(44);
  const Particles all{0, 1, 2, 3};
  int left_out = 0, close = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    const int a = 1 + trial % 2;
    Tracks t = random_tracks(random);
    if (spare_distance(t, all, a) < 0) continue;
    ++left_out;
    bring_together(t, all, a);
    ASSERT_GE(spare_distance(t, all, a), 0);
    const Quad start{t.references[0], t.references[1], t.references[2], t.references[3]};
    const Vector d = offset(closest(start, a).weights, start).normalized();
    const double separation = keep_of(t, all, a);
    double least = INFINITY;
    for (int sample = 0; sample < 40; ++sample) {
      const double substeps = static_cast<double>(1 + random() % 14);
      Quad x;
      for (std::uint32_t i = 0; i < 4; ++i)
        x[i] = where_it_may_be(random, t, i, substeps, i < static_cast<std::uint32_t>(a) ? Vector(-d) : d);
      least = std::min(least, closest(x, a).distance);
    }
    EXPECT_GE(least, separation - 1e-12);
    close += least < separation + 0.1 * t.bounds[0];
  }
  EXPECT_GT(left_out, 1000);
  EXPECT_GT(close, 30) << "a test that never comes near tells nothing";
}

TEST(DetectTwin, common_motion_costs_one_substeps_way_by_which_either_side_may_be_stopped) {
  Tracks t{{{0, 0, 0}, {0.2, 0, 0}, {0, 0.5, 0.5}, {0, 0.5, -0.5}},
           Points(4, Vector(0, 1, 1)), {}, std::vector<double>(4, 0.01), std::vector<double>(4, 1.0), {0, 0, 1, 1}, std::vector<double>(4, 0.01)};
  t.rest = t.references;
  const double moving = spare_distance(t, {0, 1, 2, 3}, 2);
  t.paths = Points(4, Vector::Zero());
  EXPECT_NEAR(spare_distance(t, {0, 1, 2, 3}, 2) - moving, 1.0 / kHorizon, 1e-12);   // across the gap: along it nobody meets
}

}  // namespace
}  // namespace weft::reference
