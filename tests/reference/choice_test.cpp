// What "method": "auto" chooses, from curves whose answers are known.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/reference/choice.h"

namespace weft {
namespace {

CurvePoint point(std::uint64_t particles, std::uint32_t substeps, double ms, double strain, bool tethers = true) {
  CurvePoint point;
  point.row = "jacobi";
  point.cells = static_cast<std::uint32_t>(std::sqrt(double(particles))) - 1;
  point.particles = particles;
  point.tethers = tethers;
  point.substeps = substeps;
  point.iterations = 1;
  point.ms_median = ms;
  point.strain_rms = strain;
  return point;
}

// A millisecond a substep at 100 x 100, four at 200 x 200.
Curve curve() {
  Curve curve{"device", "hung", "2026-11-21T12:00Z", "", 60, {}};
  for (const std::uint32_t substeps : {1u, 2u, 4u, 8u}) {
    curve.points.push_back(point(10'000, substeps, substeps, 0.1 / substeps));
    curve.points.push_back(point(40'000, substeps, 4 * substeps, 0.4 / substeps));
  }
  return curve;
}

Choice chosen(double budget, std::uint64_t particles, bool tethers = true) {
  const auto choice = choose(curve(), budget, particles, tethers);
  EXPECT_TRUE(choice) << choice.error();
  return *choice;
}

TEST(Choice, a_measured_resolution_is_taken_as_it_was_measured) {
  EXPECT_EQ(chosen(5, 10'000).setting.substeps, 4u);
  EXPECT_EQ(chosen(5, 40'000).setting.substeps, 1u);
  EXPECT_DOUBLE_EQ(chosen(5, 10'000).setting.ms_median, 4);
  EXPECT_DOUBLE_EQ(chosen(100, 40'000).setting.strain_rms, 0.05);
}

TEST(Choice, between_two_resolutions_figures_are_powers_of_the_particles) {
  const Choice choice = chosen(4.1, 20'000);
  EXPECT_EQ(choice.setting.substeps, 2u);
  EXPECT_NEAR(choice.setting.ms_median, 4, 1e-9);
  EXPECT_NEAR(choice.setting.strain_rms, 0.1, 1e-9);
}

TEST(Choice, beyond_the_largest_resolution_milliseconds_grow_with_the_particles) {
  const Choice choice = chosen(17, 80'000);
  EXPECT_EQ(choice.setting.substeps, 2u);
  EXPECT_NEAR(choice.setting.ms_median, 16, 1e-9);
  EXPECT_EQ(chosen(5, 100).setting.substeps, 4u) << "and below the smallest they stay: a frame costs something";
}

TEST(Choice, a_budget_that_nothing_fits_gets_the_cheapest_and_says_so) {
  const Choice choice = chosen(0.1, 40'000);
  EXPECT_FALSE(choice.fits);
  EXPECT_EQ(choice.setting.substeps, 1u);
  EXPECT_FALSE(choose({}, 1, 100, true));
}

TEST(Choice, a_scene_gets_what_its_budget_buys_and_keeps_its_rate) {
  auto scene = parse_scene(R"({"solver": {"method": "auto", "budget_ms": 5, "rate": 30}, )"
                           R"("cloths": [{"grid": {}, "anchors": [{"top": 0}]}]})",
                           {});
  ASSERT_TRUE(scene) << scene.error();
  Curve count = curve();
  for (CurvePoint& p : count.points) p.assignments = "solver.averaging=mass_split solver.relaxation=1";
  std::string note;
  const auto chosen = with_choice(*scene, 10'000, count, note);
  ASSERT_TRUE(chosen) << chosen.error();
  EXPECT_EQ(chosen->solver.method, Method::jacobi);
  EXPECT_EQ(chosen->solver.substeps, 4u);
  EXPECT_EQ(chosen->solver.relaxation, 1);
  EXPECT_EQ(chosen->solver.rate, 30);
  EXPECT_EQ(note,
            "solver: jacobi, 4 substeps x 1 iterations: 4 ms and 2.5 % rms strain expected for 10000 particles "
            "by the curve of hung on device of 2026-11-21T12:00Z; contacts take their own time on top.");
  count.points[0].assignments = count.points[2].assignments = count.points[4].assignments = "solver.bogus=1";
  EXPECT_FALSE(with_choice(*scene, 10'000, count, note));
}

TEST(Choice, plain_averaging_is_never_chosen) {
  Curve averaged = curve();
  averaged.points.push_back(point(10'000, 16, 0.5, 1e-6));
  averaged.points.back().assignments = "solver.averaging=count solver.relaxation=1";
  EXPECT_EQ(choose(averaged, 5, 10'000, true)->setting.substeps, 4u);
}

TEST(Choice, what_does_not_go_with_the_scene_is_never_chosen) {
  const auto scene = [](const char* contacts) {
    return *parse_scene(std::string(R"({"solver": {"method": "auto", "budget_ms": 5}, "contacts": )") + contacts +
                            R"(, "cloths": [{"grid": {}}]})",
                        {});
  };
  Curve free = curve();
  for (CurvePoint& p : free.points) p.tethers = false;
  free.points.push_back(point(10'000, 16, 0.5, 1e-6, false));
  free.points.back().row = "chebyshev";
  free.points.back().iterations = 4;
  free.points.back().assignments = "solver.method=chebyshev";
  std::string note;
  EXPECT_EQ(with_choice(scene("false"), 10'000, free, note)->solver.method, Method::chebyshev);
  const auto with_contacts = with_choice(scene("true"), 10'000, free, note);
  ASSERT_TRUE(with_contacts) << with_contacts.error();
  EXPECT_EQ(with_contacts->solver.method, Method::jacobi);
}

TEST(Choice, cloth_counts_as_tethered_where_tethers_hold_all_of_it_to_what_does_not_move) {
  Curve both = curve();
  for (CurvePoint& p : curve().points) both.points.push_back(point(p.particles, p.substeps + 100, p.ms_median, p.strain_rms, false));
  const auto substeps = [&](const char* cloths) {
    auto scene = parse_scene(std::string(R"({"solver": {"method": "auto", "budget_ms": 5}, "cloths": )") + cloths + "}", {});
    EXPECT_TRUE(scene) << scene.error();
    std::string note;
    return with_choice(*scene, 10'000, both, note)->solver.substeps;
  };
  EXPECT_EQ(substeps(R"([{"grid": {}, "anchors": [{"top": 0}]}])"), 4u);
  EXPECT_EQ(substeps(R"([{"grid": {}, "anchors": [{"top": 0}], "tethers": false}])"), 104u);
  EXPECT_EQ(substeps(R"([{"grid": {}, "anchors": [{"top": 0}]}, {"grid": {}}])"), 104u) << "the other is free";
  EXPECT_EQ(substeps(R"([{"grid": {}, "anchors": [{"top": 0, "keys": [{"time": 1, "translate": [1, 0, 0]}]}]}])"), 104u);
}

TEST(Choice, a_scene_that_does_not_ask_comes_back_as_it_is) {
  const auto scene = parse_scene(R"({"solver": {"substeps": 7}, "cloths": [{"grid": {}}]})", {});
  std::string note;
  EXPECT_EQ(with_choice(*scene, 100, Curve{}, note)->solver.substeps, 7u);
  EXPECT_EQ(note, "");
}

TEST(Choice, auto_needs_a_budget_and_the_settings_it_chooses_to_be_left_away) {
  const auto fault = [](const char* solver) {
    const auto scene = parse_scene(std::string(R"({"cloths": [{"grid": {}}], "solver": )") + solver + "}", {});
    return scene ? std::string() : scene.error();
  };
  EXPECT_EQ(fault(R"({"method": "auto", "budget_ms": 2})"), "");
  EXPECT_EQ(fault(R"({"method": "auto"})"), "solver.method: \"auto\" needs solver.budget_ms, the milliseconds that a frame may take");
  EXPECT_NE(fault(R"({"method": "auto", "budget_ms": 2, "substeps": 4})").find("leave them away"), std::string::npos);
  EXPECT_NE(fault(R"({"budget_ms": 2})").find("\"auto\" chooses by it"), std::string::npos);
}

TEST(Choice, the_built_in_curve_has_something_for_every_budget_with_and_without_tethers) {
  const Curve built_in = builtin_curve();
  ASSERT_FALSE(built_in.points.empty());
  for (const bool tethers : {true, false})
    for (const std::uint64_t particles : {100u, 40'000u, 1'000'000u}) {
      double last = INFINITY;
      for (const double budget : {0.5, 5.0, 50.0, 500.0}) {
        const auto choice = choose(built_in, budget, particles, tethers);
        ASSERT_TRUE(choice) << choice.error();
        EXPECT_LE(choice->setting.strain_rms, last) << budget << " ms for " << particles;
        last = choice->fits ? choice->setting.strain_rms : INFINITY;
      }
    }
}

TEST(Choice, a_condensed_curve_keeps_what_is_on_a_front_somewhere) {
  Curve wide = curve();
  wide.points.push_back(point(10'000, 16, 20, 0.5));   // slower and worse
  wide.points.push_back(point(40'000, 32, 20, 0.5));
  wide.points.back().passes = "stretch=1";
  wide.points.push_back(point(10'000, 32, 0.5, 0.5));   // worth it here, so it stays there
  const Curve small = condensed(wide);
  EXPECT_EQ(small.points.size(), 10u);
  for (const CurvePoint& p : small.points) EXPECT_TRUE(p.passes.empty());
}

}  // namespace
}  // namespace weft
