// What the tests of the twins share: random vectors and finite differences.
#pragma once

#include <functional>
#include <random>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

using Random = std::mt19937_64;

inline double between(Random& random, double low, double high) { return std::uniform_real_distribution(low, high)(random); }
inline Vector anywhere(Random& random, double size) {
  return {between(random, -size, size), between(random, -size, size), between(random, -size, size)};
}

// Central differences: error of order step^2 |f'''| and eps |f| / step; 1e-5 balances them for values near 1.
inline constexpr double kStep = 1e-5;
inline constexpr double kDifferenceTolerance = 1e-8;

inline Vector difference(const std::function<double(const Vector&)>& value, const Vector& at) {
  Vector gradient;
  for (int k = 0; k < 3; ++k) gradient[k] = (value(at + kStep * Vector::Unit(k)) - value(at - kStep * Vector::Unit(k))) / (2 * kStep);
  return gradient;
}

}  // namespace weft::reference
