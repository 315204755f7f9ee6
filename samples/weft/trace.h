// Dispatches on a time line, for chrome://tracing and ui.perfetto.dev. Format: "Trace Event Format" (Google, 2016).
#pragma once

#include <string>
#include <vector>

#include "engine/simulation.h"

namespace weft::command {

struct TracedFrame {
  double milliseconds = 0;   // on the GPU, first to last command
  std::vector<DispatchTime> dispatches;
};

/// One row of frames and one row a pass, frames laid end to end: what the CPU did in between is left out.
std::string trace_json(const std::string& device, const std::vector<PassUse>& passes, const std::vector<TracedFrame>& frames);

}  // namespace weft::command
