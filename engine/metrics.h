// Figures of a state of the cloth, from positions alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/fabric.h"

namespace weft {

/// Strain |length / rest - 1| over the links that both push and pull.
struct Strain {
  double mean = 0, rms = 0, max = 0;
};
Strain measure_strain(const CookedFabric& fabric, std::span<const gpu::vec4> positions);
/// The largest strain of a link at each render vertex.
std::vector<float> vertex_strain(const CookedFabric& fabric, std::span<const gpu::vec4> positions);
/// 64 bits over the bits of all xyz (FNV-1a): equal hashes, equal results.
std::uint64_t position_hash(std::span<const gpu::vec4> positions);

}  // namespace weft
