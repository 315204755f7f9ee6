// Twin of chebyshev: the Chebyshev semi-iteration (Golub and Varga 1961; Wang 2015, eq. 9), on positions and on multipliers.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// The weights of `iterations` iterations with the spectral radius rho: 1, 2 / (2 - rho^2), 4 / (4 - rho^2 omega) ...
inline std::vector<double> chebyshev_weights(double rho, std::uint32_t iterations) {
  std::vector<double> weights;
  for (std::uint32_t k = 0; k < iterations; ++k)
    weights.push_back(k == 0 ? 1 : k == 1 ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * weights.back()));
  return weights;
}

/// The next iterate, from the one before the last, `older`, and the Jacobi iterate `jacobi`.
template <class Value>
Value extrapolated(const Value& older, const Value& jacobi, double weight) { return weight * (jacobi - older) + older; }

}  // namespace weft::reference
