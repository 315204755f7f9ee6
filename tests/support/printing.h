// How GoogleTest prints the library's types that are parameters of tests: by name, not by their bytes.
#pragma once

#include <ostream>

#include "engine/scene.h"

namespace weft {

inline void PrintTo(Topology topology, std::ostream* out) { *out << (topology == Topology::diagonal ? "diagonal" : "centre"); }

}  // namespace weft
