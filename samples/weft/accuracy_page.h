// What a sweep leaves to look at: the plot, and a page that stands alone.
#pragma once

#include <string>
#include <vector>

#include "engine/reference/curve.h"
#include "samples/weft/accuracy_sweep.h"
#include "samples/weft/plot.h"

namespace weft::command {

/// With tethers and without: strain at the largest resolution, and the distance to the reference at the largest that has one.
Drawing accuracy_plot(const Curve& curve);

struct Shot {
  std::string caption;
  std::vector<char> png;
};

struct Page {
  const Curve& curve;
  const SweepPlan& plan;
  std::vector<std::string> notes;   // a sentence each
  std::vector<Shot> shots;          // side by side
  bool interrupted = false;
};

/// HTML with everything in it: it opens without a network.
std::string accuracy_page(const Page& page);

/// "jacobi, 10 substeps x 1 iteration".
std::string setting_words(const CurvePoint& point);
/// "--set solver.substeps=10 ...": what makes `weft run` use it.
std::string setting_flags(const CurvePoint& point);
/// "0.12 %", "3.4e+03 %".
std::string percent(double fraction);

/// The largest resolution of a curve, and the largest with a reference (0: none has).
std::uint32_t largest(const Curve& curve);
std::uint32_t largest_referenced(const Curve& curve);

}  // namespace weft::command
