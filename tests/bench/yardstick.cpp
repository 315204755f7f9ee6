#include "tests/bench/yardstick.h"

#include <barrier>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace weft::bench {
namespace {

void relax(const Csr& csr, const gpu::vec4* from, gpu::vec4* to, std::size_t begin, std::size_t end, float inverse_h2, float relaxation) {
  for (std::size_t i = begin; i < end; ++i) {
    const gpu::vec4 p = from[i];
    float sx = 0, sy = 0, sz = 0;
    for (std::uint32_t k = csr.first[i]; k < csr.first[i + 1]; ++k) {
      const gpu::vec4 q = from[csr.other[k]];
      const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
      const float length = std::sqrt(dx * dx + dy * dy + dz * dz);
      const float change = -(length - csr.rest[k]) / (p.w + q.w + csr.compliance[k] * inverse_h2);
      const float scale = length > 1e-10f ? change / length : 0;
      sx += scale * dx;
      sy += scale * dy;
      sz += scale * dz;
    }
    const float count = static_cast<float>(csr.first[i + 1] - csr.first[i]);
    const float share = relaxation * p.w / std::fmax(count, 1.0f);
    to[i] = {p.x + share * sx, p.y + share * sy, p.z + share * sz, p.w};
  }
}

}  // namespace

Csr csr_of(const CookedFabric& fabric) {
  std::vector<std::vector<gpu::Link>> lists(fabric.positions.size());
  for (const StretchLink& link : fabric.links) {
    lists[link.a].push_back({link.b, link.rest, link.compliance, link.only_pulls});
    lists[link.b].push_back({link.a, link.rest, link.compliance, link.only_pulls});
  }
  Csr csr{{0}, {}, {}, {}};
  for (const auto& list : lists) {
    for (const gpu::Link& link : list) {
      csr.other.push_back(link.other);
      csr.rest.push_back(link.rest);
      csr.compliance.push_back(link.response);
    }
    csr.first.push_back(static_cast<std::uint32_t>(csr.other.size()));
  }
  return csr;
}

double run_yardstick(const Csr& csr, std::vector<gpu::vec4>& from, std::vector<gpu::vec4>& to, float inverse_h2, float relaxation,
                     int passes) {
  const std::size_t half = from.size() / 2;
  std::barrier meet(2);
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (int pass = 0; pass < passes; ++pass) {
      relax(csr, pass % 2 == 0 ? from.data() : to.data(), pass % 2 == 0 ? to.data() : from.data(), begin, end, inverse_h2, relaxation);
      meet.arrive_and_wait();
    }
  };
  const auto start = std::chrono::steady_clock::now();
  std::thread second(work, half, from.size());
  work(0, half);
  second.join();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace weft::bench
