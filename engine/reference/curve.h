// The accuracy curve: cost and error of the solver's settings, measured side by side on one device.
//
// A point is one setting at one resolution, with its milliseconds and its errors from the same run. The (Pareto) front of a set of
// points is the subset that no other point beats in both. `weft accuracy` measures curves; choice.h picks
// from them. Plain values and text, no Vulkan.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/result.h"

namespace weft {

struct CurvePoint {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  std::string row;              // the solver's name in the sweep
  std::string assignments;      // that make a scene use it, as `--set` takes them, separated by blanks: "solver.relaxation=1"
  std::uint32_t cells = 0;      // of the longest side of a grid; 0: a mesh as it is
  std::uint64_t particles = 0;
  bool tethers = false;
  std::uint32_t substeps = 0, iterations = 0;
  double ms_median = kUnknown, ms_p95 = kUnknown;   // whole frames on the wall clock, without timestamps
  double ms_gpu = kUnknown;     // all passes by timestamps, median
  double strain_mean = kUnknown, strain_rms = kUnknown, strain_max = kUnknown;   // fractions
  // Rms distances over a run, relative to the sheet's size (errors.h):
  double solver_error = kUnknown;   // of this run to the reference with the same step h
  double time_error = kUnknown;     // of that reference to the one with h / 16
  double total_error = kUnknown;    // of this run to the one with h / 16
  std::uint32_t non_finite = 0;     // particles that had to be put back
  std::string passes;           // milliseconds of each: "predict=0.02 stretch=1.1"
  double dispatches = kUnknown; // a frame: what a GPU charges for where cloths are small
};

/// Which of a point's figures counts as its error, and which as its cost: ms_median or dispatches.
using CurveError = double CurvePoint::*;
using CurveCost = double CurvePoint::*;

struct Curve {
  std::string device, scene;
  std::string date;             // UTC, as 2026-11-21T16:00Z
  std::string key;              // tells sweeps of different scenes or settings apart
  std::uint32_t frames = 0;     // that each point was run for
  std::vector<CurvePoint> points;
};

/// Whether a point can stand on a front: its run stayed finite and this error was measured.
bool counts(const CurvePoint& point, CurveError error);

/// Indices of the points that no other beats in cost and error, cheapest first: along them the error falls strictly.
std::vector<std::size_t> front(std::span<const CurvePoint> points, CurveError error, CurveCost cost = &CurvePoint::ms_median);

/// The point of the least error that takes at most `budget_ms`; nothing where even the cheapest takes more.
std::optional<std::size_t> best(std::span<const CurvePoint> points, CurveError error, double budget_ms);

/// The points of one resolution, with tethers or without.
std::vector<CurvePoint> points_of(const Curve& curve, std::uint32_t cells, bool tethers);

/// A few lines of "# key: value", a header, then a line a point; what was not measured is left empty. parse_curve reads back
/// exactly what was written, and curves of earlier versions, which lack the last columns. Errors: a header that
/// is not there, a number that is none; they name the line and the column.
std::string curve_csv(const Curve& curve);
Result<Curve> parse_curve(std::string_view text);

}  // namespace weft
