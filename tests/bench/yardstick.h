// The yardstick: the stretch pass as a plain C++ loop on two threads, over the same links.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/fabric.h"

namespace weft::bench {

/// Rows of neighbours as a C++ programmer would lay them out.
struct Csr {
  std::vector<std::uint32_t> first;   // particles + 1
  std::vector<std::uint32_t> other;
  std::vector<float> rest, compliance;
};

Csr csr_of(const CookedFabric& fabric);

/// `passes` Jacobi passes, both threads meeting after each; returns seconds for all of them.
double run_yardstick(const Csr& csr, std::vector<gpu::vec4>& from, std::vector<gpu::vec4>& to, float inverse_h2, float relaxation,
                     int passes);

}  // namespace weft::bench
