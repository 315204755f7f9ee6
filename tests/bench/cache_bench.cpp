// How fast caches are written: 300 frames of 200 x 200 vertices, in megabytes a second, beside a plain file of as many bytes. Both are
// flushed to the disk before the clock stops (and with `flushed:0` only handed to the system). In the folder where it is started.
//   weft_bench --benchmark_filter=cache
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/cache.h"
#include "tests/bench/need.h"

namespace weft::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kCached = 300, kSide = 199;
constexpr std::size_t kPlainBytes = std::size_t{kCached} * (kSide + 1) * (kSide + 1) * sizeof(Vec3);

void flush(const fs::path& file) {
  const int held = open(file.c_str(), O_RDONLY);
  if (held < 0) return;
  fsync(held);
  close(held);
}

void count(benchmark::State& state, std::uintmax_t bytes) {
  state.counters["MB/s"] = benchmark::Counter(static_cast<double>(bytes) / 1e6, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["MB"] = static_cast<double>(bytes) / 1e6;
}

void plain(benchmark::State& state) {
  const fs::path file = "weft_bench_plain";
  const std::vector<char> piece(kPlainBytes / kCached, 'w');
  for (auto _ : state) {
    std::FILE* stream = std::fopen(file.c_str(), "wb");
    for (std::uint32_t k = 0; k < kCached; ++k) benchmark::DoNotOptimize(std::fwrite(piece.data(), 1, piece.size(), stream));
    std::fclose(stream);
    if (state.range(0) != 0) flush(file);
    fs::remove(file);
  }
  count(state, kPlainBytes);
}

void cache(benchmark::State& state) {
  constexpr const char* kEndings[] = {"pc2", "mdd", "glb", "usda", "ply", "obj"};
  const std::string ending = kEndings[state.range(0)];
  const fs::path file = "weft_bench_cache." + ending;
  const RenderMesh mesh = make_grid(Grid{.cells_x = kSide, .cells_y = kSide}).render;
  std::vector<Vec3> positions = mesh.positions, normals = mesh.normals;
  for (std::size_t v = 0; v < positions.size(); ++v) {   // as in a cloth that has moved, few numbers are short
    const float x = std::sin(static_cast<float>(v)), y = std::cos(static_cast<float>(v));
    positions[v] = {positions[v].x + 0.01f * x, 0.3f * y, positions[v].z};
    normals[v] = {0.6f * x, 0.8f, 0.6f * y};
  }
  std::uintmax_t bytes = 0;
  for (auto _ : state) {
    const auto writer = need(CacheWriter::create(file, mesh, {.frames = kCached}));
    for (std::uint32_t k = 0; k < kCached; ++k) need(writer->add({.positions = positions, .normals = normals, .strain = {}}));
    need(writer->finish());
    std::vector<fs::path> files = {file};
    if (is_sequence(need(cache_format(file)))) files.clear();
    for (std::uint32_t k = 1; files.size() < kCached && is_sequence(need(cache_format(file))); ++k)
      files.push_back(sequence_file(file, k, kCached));
    bytes = 0;
    for (const fs::path& written : files) {
      if (state.range(1) != 0) flush(written);
      bytes += fs::file_size(written);
      fs::remove(written);
    }
  }
  state.SetLabel(ending);
  count(state, bytes);
}

BENCHMARK(plain)->Name("cache_plain")->ArgName("flushed")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);
BENCHMARK(cache)->ArgNames({"format", "flushed"})->ArgsProduct({{0, 1, 2, 3, 4, 5}, {1, 0}})->Unit(benchmark::kMillisecond)->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace weft::bench
