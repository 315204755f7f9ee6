// What the tests of the gas measure.
#pragma once

#include "engine/effects/pressure/pressure.h"
#include "shaders/pressure/pressure.ref.h"
#include "tests/support/closed.h"
#include "tests/support/ways.h"

namespace weft {

inline reference::Points places_of(const Simulation& simulation) {
  reference::Points x;
  for (const gpu::vec4& p : must(simulation.read_positions())) x.push_back({p.x, p.y, p.z});
  return x;
}

/// Of a scene's only cloth (m^3).
inline double volume_of(const Simulation& simulation) {
  return reference::volume(simulation.fabric().triangles, places_of(simulation));
}

/// Where a lid is (m, from its start, downwards) at times (s).
inline std::vector<Key> lowered(std::initializer_list<std::pair<double, float>> places) {
  std::vector<Key> keys;
  for (const auto& [time, down] : places) {
    Key& key = keys.emplace_back();
    key.time = time;
    key.translate = {0, -down, 0};
  }
  return keys;
}

/// The largest distance from the mean place (m); infinite where one is not finite.
inline double reach_of(const Simulation& simulation) {
  const reference::Points x = places_of(simulation);
  reference::Vector mean = reference::Vector::Zero();
  for (const auto& p : x) mean += p / double(x.size());
  double reach = 0;
  for (const auto& p : x) reach = (p - mean).norm() < 1e30 ? std::max(reach, (p - mean).norm()) : INFINITY;
  return reach;
}

/// The gas's pressure above the ambient (Pa) in the volume v (m^3).
inline double gauge(const Gas& gas, double rest_volume, double v, double amount = 1) {
  return reference::GasLaw{amount, gas.ambient + gas.rest_pressure, gas.volume.value_or(rest_volume), gas.ambient}.at(v);
}

}  // namespace weft
