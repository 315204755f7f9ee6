// A run, for who makes more of it than its files.
#pragma once

#include "samples/weft/commands.h"
#include "samples/weft/report.h"

namespace weft::command {

/// As run(options); `figures` are what report.json says.
Exit run(const RunOptions& options, Figures& figures);

}  // namespace weft::command
