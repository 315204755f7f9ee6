// Strain and the hash, from exported positions alone; strain in double precision.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/digest.h"
#include "engine/fabric.h"
#include "engine/metrics.h"

namespace weft {
namespace {

double strain_of(const StretchLink& link, std::span<const gpu::vec4> x) {
  const gpu::vec4 &a = x[link.a], &b = x[link.b];
  const double length = std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
  return link.rest > 0 ? length / link.rest - 1 : 0;
}

}  // namespace

Strain measure_strain(const CookedFabric& fabric, std::span<const gpu::vec4> positions) {
  Strain strain;
  std::size_t count = 0;
  for (const StretchLink& link : fabric.links) {
    if (link.only_pulls) continue;
    const double s = std::abs(strain_of(link, positions));
    strain.mean += s;
    strain.rms += s * s;
    strain.max = std::max(strain.max, s);
    ++count;
  }
  if (count == 0) return {};
  strain.mean /= static_cast<double>(count);
  strain.rms = std::sqrt(strain.rms / static_cast<double>(count));
  return strain;
}

std::vector<float> vertex_strain(const CookedFabric& fabric, std::span<const gpu::vec4> positions) {
  std::vector<float> of_particle(positions.size());
  for (const StretchLink& link : fabric.links) {
    if (link.only_pulls) continue;
    const auto s = static_cast<float>(std::abs(strain_of(link, positions)));
    of_particle[link.a] = std::max(of_particle[link.a], s);
    of_particle[link.b] = std::max(of_particle[link.b], s);
  }
  std::vector<float> of_vertex;
  of_vertex.reserve(fabric.surface_rows.size());
  for (const gpu::uvec4& row : fabric.surface_rows) of_vertex.push_back(of_particle[row.x]);
  return of_vertex;
}

std::uint64_t position_hash(std::span<const gpu::vec4> positions) {
  Digest digest;
  for (const gpu::vec4& p : positions) digest.add(std::as_bytes(std::span(&p, 1)).first(sizeof(gpu::vec3)));
  return digest.value();
}

}  // namespace weft
