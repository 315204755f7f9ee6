// The reference against what is known without it: an elastic strip under its own weight, a catenary, a cantilever, a pendulum,
// a fall with drag. Where a rest state is wanted steps are long: implicit Euler damps what swings faster than they last.
#include <Eigen/Geometry>

#include "tests/support/reference_scenes.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {
namespace {

// A strip hung along its top, of an even weight per length rho g and a modulus Y per width: above s from the lower end the strain
// is rho g s / Y, in all rho g L^2 / (2 Y). Of n edges with half of their mass at either end the sum is the same.
TEST(ClosedForms, a_strip_stretches_under_its_own_weight) {
  Scene scene = without_contacts();
  scene.solver.rate = 10;
  scene.solver.substeps = 1;
  scene.solver.method = Method::jacobi;   // its far links are part of what is simulated
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{0.1f, 1}, 3, 30, Topology::diagonal, true};
  cloth.fabric.stretch = 100;
  cloth.fabric.shear = 0.01;   // as good as none, so that the diagonals take no part
  cloth.fabric.damping = 0;
  cloth.bending = cloth.tethers = false;
  cloth.anchors.emplace_back().top = 1e-4;
  const CookedFabric fabric = cooked(scene);
  const Positions rest = run(scene, fabric, 100, 0.1).poses.back();
  const double weight = cloth.fabric.area_density * -scene.gravity.y, lower_edge = -0.5 - rest.row(1).minCoeff();
  // Links of eight edges take half of the edges' load and give way evenly where the edges would not: they shift strain by up
  // to the square of 4 edges' share of the length.
  EXPECT_NEAR(lower_edge / (weight / (2 * cloth.fabric.stretch)), 1, std::pow(4.0 / 30, 2));
  // Without them, by hand, it is the sum itself.
  Chain line = chain(30, 1.0 / 30, 0.004, 1e-3, false);
  line.scene.solver.rate = 10;
  line.scene.gravity = {9.81f, 0, 0};
  const double tip = run(line.scene, line.fabric, 200, 0.1).poses.back()(0, 30);
  double longer = 0;
  for (int below = 1; below <= 30; ++below) longer += 1e-3f * below * 0.004 * 9.81f;
  EXPECT_NEAR(tip - 1, longer, 1e-6 * longer);   // single precision masses and lengths
}

// A chain of length L hung over a span d < L: y = a cosh(x / a) with L = 2 a sinh(d / 2 a). Its links are chords of that curve;
// with n of them the deepest point is off by the order of L / n^2.
TEST(ClosedForms, a_chain_hangs_in_a_catenary) {
  constexpr std::uint32_t kLinks = 40;
  constexpr double kSpan = 1, kLength = 1.3;
  Chain hung = chain(kLinks, kSpan / kLinks, 0.01, 0, true);
  hung.scene.solver.rate = 20;
  for (StretchLink& link : hung.fabric.links) {
    link.rest = static_cast<float>(kLength / kLinks);
    link.only_pulls = true;
  }
  const Positions rest = run(hung.scene, hung.fabric, 400, 0.05).poses.back();
  double low = 0.05, high = 5;   // of a: the curve gets shorter as a grows
  for (int k = 0; k < 60; ++k) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(kSpan / (2 * a)) > kLength ? low : high) = a;
  }
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    const double y = low * (std::cosh((rest(0, i) - kSpan / 2) / low) - std::cosh(kSpan / (2 * low)));
    EXPECT_NEAR(rest(1, i), y, kLength / (kLinks * kLinks)) << "link " << i;
  }
}

// A beam of n links, clamped at one end, sinks by rho g L^4 / (8 B) at the other while that is small (Euler-Bernoulli). At an inner
// particle it curves by |p_{i-1} - 2 p_i + p_{i+1}| / l^2 over a length l, so its energy is 1/2 (B / l^3) |...|^2. (Cooked
// sheets are held against a plate in tests/effects/bend/plate_test.cpp.)
TEST(ClosedForms, a_cantilever_sinks_as_much_as_its_rigidity_says) {
  constexpr std::uint32_t kLinks = 41;
  constexpr double kLink = 0.01, kMass = 1e-4, kRigidity = 1e-3;   // m, kg, N m^2
  Chain beam = chain(kLinks, kLink, kMass, 1e-6, false);
  beam.scene.solver.rate = 10;
  beam.scene.gravity = {0, -0.1f, 0};
  beam.fabric.positions[1].w = 0;
  beam.fabric.anchors.push_back({0, 0, 1, 1, {static_cast<float>(kLink), 0, 0}});
  for (std::uint32_t i = 1; i < kLinks; ++i)
    beam.fabric.bends.push_back({{i, i - 1, i + 1, i}, {-2, 1, 1, 0}, static_cast<float>(std::pow(kLink, 3) / kRigidity), 0});
  const double sinks = -run(beam.scene, beam.fabric, 200, 0.1).poses.back()(1, kLinks);
  // The same of hinges: the one at i carries all beyond it, turns by M l / B and lowers the tip by that times its distance.
  double discrete = 0;
  for (std::uint32_t i = 1; i < kLinks; ++i) {
    double moment = 0;
    for (std::uint32_t j = i + 1; j <= kLinks; ++j) moment += kMass * 0.1 * (j - i) * kLink;
    discrete += moment * kLink / kRigidity * (kLinks - i) * kLink;
  }
  const double length = (kLinks - 1) * kLink, expected = kMass / kLink * 0.1 * std::pow(length, 4) / (8 * kRigidity);
  ASSERT_LT(expected, 0.01 * length) << "not small";
  EXPECT_NEAR(sinks / discrete, 1, 1e-4);   // slopes of 1 % squared
  // Of n links the last particle's load is half a link's too much, 4 / (3 n), and the clamped curvature counts in a whole link, 2 / n;
  // terms of the next order are below 4 / n^2.
  const double n = kLinks - 1;
  EXPECT_NEAR(discrete / expected, 1 + (4.0 / 3 + 2) / n, 4 / (n * n));
}

TEST(ClosedForms, a_pendulum_swings_with_its_period) {
  Chain pendulum = chain(1, 1, 0.1, 0, false);
  constexpr double kAngle = 0.05;
  pendulum.fabric.positions[1] = {static_cast<float>(std::sin(kAngle)), static_cast<float>(-std::cos(kAngle)), 0, 10};
  const Trajectory swing = run(pendulum.scene, pendulum.fabric, 60 * 7, 1.0 / 2400);
  std::vector<double> crossings;
  for (std::size_t k = 1; k < swing.poses.size(); ++k) {
    const double before = swing.poses[k - 1](0, 1), after = swing.poses[k](0, 1);
    if (before > 0 && after <= 0) crossings.push_back((static_cast<double>(k) + before / (before - after)) / 60);
  }
  ASSERT_GE(crossings.size(), 3u);
  const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  // Small-angle series; its next term and the step's shift, of the order of (omega h)^2, are below 1e-5. Crossings are read off
  // chords of a sine over 1/60 s: (omega / 60)^2 / 24 of that interval.
  EXPECT_NEAR(period / (2 * M_PI * std::sqrt(1 / 9.81) * (1 + kAngle * kAngle / 16)), 1, 2e-5);
}

// dv/dt = g - c v. Steps of h: v <- k (v + h g) with k = exp(-c h), exactly; against the continuous fall of the order of h.
TEST(ClosedForms, a_fall_with_drag_follows_its_closed_form) {
  Scene scene = hung_sheet(2, false);
  scene.cloths[0].anchors.clear();
  scene.cloths[0].start.imperfection = 0;
  const double c = scene.cloths[0].fabric.damping = 2, g = scene.gravity.y;
  const CookedFabric fabric = cooked(scene);
  std::vector<double> errors;
  for (const double h : {1.0 / 240, 1.0 / 480}) {
    const Positions end = run(scene, fabric, 60, h).poses.back();
    const double steps = std::round(1 / h), k = std::exp(-c * h);
    // v_n = h g k (1 - k^n) / (1 - k), summed up.
    const double discrete = h * h * g * k / (1 - k) * (steps - k * (1 - std::pow(k, steps)) / (1 - k));
    for (Eigen::Index i = 0; i < end.cols(); ++i) EXPECT_NEAR(end(1, i), discrete, 1e-12);
    errors.push_back(discrete - g / c * (1 - (1 - std::exp(-c)) / c));
  }
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.02);   // of the order of h, but for a term of h^2
}

}  // namespace
}  // namespace weft::reference
