// Fronts, budgets and curves as text.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/reference/curve.h"

namespace weft {
namespace {

CurvePoint point(double ms, double error, std::uint32_t substeps = 1) {
  CurvePoint point;
  point.row = "jacobi";
  point.cells = 32;
  point.particles = 1089;
  point.substeps = substeps;
  point.iterations = 1;
  point.ms_median = ms;
  point.strain_rms = error;
  return point;
}

using Indices = std::vector<std::size_t>;

TEST(Curve, a_front_keeps_what_no_other_point_beats_in_both) {
  const std::vector<CurvePoint> points = {point(4, 0.1), point(1, 0.5), point(2, 0.6), point(2, 0.2),
                                          point(8, 0.1), point(0.5, 0.9), point(2, 0.2)};
  EXPECT_EQ(front(points, &CurvePoint::strain_rms), (Indices{5, 1, 3, 0}));
  EXPECT_TRUE(front({}, &CurvePoint::strain_rms).empty());
}

TEST(Curve, what_blew_up_or_was_not_measured_is_on_no_front) {
  std::vector<CurvePoint> points = {point(1, 0.5), point(2, CurvePoint::kUnknown), point(3, INFINITY), point(4, 0.1)};
  points[3].non_finite = 1;
  EXPECT_EQ(front(points, &CurvePoint::strain_rms), (Indices{0}));
  EXPECT_TRUE(front(points, &CurvePoint::time_error).empty());
}

TEST(Curve, the_best_for_a_budget_is_the_last_of_the_front_that_fits) {
  const std::vector<CurvePoint> points = {point(4, 0.1), point(1, 0.5), point(2, 0.2), point(3, 0.9)};
  EXPECT_EQ(best(points, &CurvePoint::strain_rms, 3.5), 2u);
  EXPECT_EQ(best(points, &CurvePoint::strain_rms, 4), 0u);
  EXPECT_EQ(best(points, &CurvePoint::strain_rms, 0.5), std::nullopt);
}

bool same(const CurvePoint& a, const CurvePoint& b) { return curve_csv({"", "", "", "", 0, {a}}) == curve_csv({"", "", "", "", 0, {b}}); }

TEST(Curve, a_front_is_over_milliseconds_or_dispatches) {
  std::vector<CurvePoint> points = {point(1, 0.5), point(2, 0.2), point(3, 0.1)};
  points[0].dispatches = 40;
  points[1].dispatches = 20;
  EXPECT_EQ(front(points, &CurvePoint::strain_rms, &CurvePoint::dispatches), (Indices{1})) << "the last was not counted";
}

TEST(Curve, one_of_an_earlier_version_ends_before_the_dispatches) {
  const std::string text = curve_csv({"", "", "", "", 0, {point(1, 0.5)}});
  std::string earlier = text;
  earlier.erase(earlier.find(",dispatches"), std::string(",dispatches").size());
  earlier.erase(earlier.rfind(','), 1);
  const auto read = parse_curve(earlier);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(curve_csv(*read), text);
  EXPECT_FALSE(parse_curve(text.substr(0, text.find("strain_rms")) + '\n')) << "others may not be missing";
}

TEST(Curve, text_brings_back_every_bit) {
  Curve curve{"llvmpipe (LLVM 15.0.6, 256 bits)", "hung", "2026-11-21T16:00Z", "0123456789abcdef", 60,
              {point(0.1 + 0.2, 1.0 / 3), point(1e-17, 2)}};
  curve.points[0].assignments = "solver.relaxation=1 solver.averaging=count";
  curve.points[0].passes = "predict=0.1 stretch=2";
  curve.points[0].tethers = true;
  curve.points[1].solver_error = 1.25e-300;
  const Result<Curve> read = parse_curve(curve_csv(curve));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->device, "llvmpipe (LLVM 15.0.6  256 bits)") << "a comma would end a column";
  EXPECT_EQ(read->frames, 60u);
  EXPECT_EQ(read->key, curve.key);
  EXPECT_EQ(read->date, curve.date);
  ASSERT_EQ(read->points.size(), 2u);
  for (int k : {0, 1}) EXPECT_TRUE(same(read->points[static_cast<std::size_t>(k)], curve.points[static_cast<std::size_t>(k)])) << k;
  EXPECT_EQ(read->points[0].ms_median, 0.1 + 0.2);
  EXPECT_EQ(read->points[1].solver_error, 1.25e-300);
  EXPECT_TRUE(std::isnan(read->points[1].time_error));
}

TEST(Curve, text_that_is_no_curve_is_refused_by_its_line) {
  const std::string good = curve_csv({"d", "s", "", "", 60, {point(1, 2)}});
  const auto refused = [](std::string text) {
    const Result<Curve> curve = parse_curve(text);
    return curve ? std::string() : curve.error();
  };
  EXPECT_EQ(refused(good), "");
  EXPECT_NE(refused("").find("line 1"), std::string::npos);
  EXPECT_NE(refused(good.substr(0, good.size() - 8)).find("line 8: has"), std::string::npos) << "cut off";
  std::string wrong = good;
  wrong.replace(wrong.find("1089"), 4, "many");
  EXPECT_NE(refused(wrong).find("line 8: particles: \"many\""), std::string::npos) << refused(wrong);
}

}  // namespace
}  // namespace weft
