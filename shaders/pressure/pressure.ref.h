// Twin of pressure_volume and pressure: volumes from triangles instead of rings, and the gas law's root by bisection instead of in
// closed form.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

using Faces = std::span<const std::array<std::uint32_t, 3>>;

/// m^3, of a closed surface; places relative to x[0].
inline double volume(Faces triangles, const Points& x) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += (x[a] - x[0]).dot((x[b] - x[0]).cross(x[c] - x[0])) / 6;
  return sum;
}

/// By each particle (m^2).
inline Points volume_gradients(Faces triangles, const Points& x) {
  Points sum(x.size(), Vector::Zero());
  for (const auto& [a, b, c] : triangles) {
    sum[a] += (x[b] - x[a]).cross(x[c] - x[a]) / 6;
    sum[b] += (x[c] - x[b]).cross(x[a] - x[b]) / 6;
    sum[c] += (x[a] - x[c]).cross(x[b] - x[c]) / 6;
  }
  return sum;
}

struct GasLaw {
  double amount = 1, pressure = 0, volume = 1, ambient = 0;   // Pa, absolute; m^3; Pa
  /// Above the ambient (Pa), with the volume v > 0.
  double at(double v) const { return amount * pressure * volume / v - ambient; }
};

/// The impulse (Pa s) of a step h from the volume `v` on, which it changes by h `mobility` (m^4/kg) times the impulse.
inline double gas_impulse(const GasLaw& gas, double v, double mobility, double h) {
  // at(y) falls with y, and (y - v) / (h^2 mobility) grows.
  const auto misses = [&](double y) { return gas.at(y) - (y - v) / (h * h * mobility); };
  double low = 0, high = std::max(v, gas.volume);
  while (misses(high) > 0) high *= 2;
  for (int k = 0; k < 200; ++k) {
    const double middle = (low + high) / 2;
    (misses(middle) > 0 ? low : high) = middle;
  }
  return (high - v) / (h * mobility);
}

/// What the constraints are taken to undo of what the gas does: as much of it as they did in the last substep (m^3).
inline double undone(double v, double left, double gained) {
  return std::clamp(v - left, -std::max(gained, 0.0), -std::min(gained, 0.0));
}

}  // namespace weft::reference
