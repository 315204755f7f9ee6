// How fast caches are written: 100 frames of 200 x 200 vertices, in megabytes a second, and of a plain writing of as many bytes into as
// many files, which comes in turns with it; of each the best of three turns counts. The memory in which files wait for the disk costs
// more the first time, so a plain file of fewer bytes would be no yardstick. All are flushed to the disk before the clock stops (and
// with `flushed:0` only handed to the system). In the folder where it is started.
//   weft_bench --benchmark_filter=cache
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/cache.h"
#include "tests/bench/need.h"

namespace weft::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kCached = 100, kSide = 199;
constexpr int kTurns = 3;

void flush(const fs::path& file) {
  const int held = open(file.c_str(), O_RDONLY);
  if (held < 0) return;
  fsync(held);
  close(held);
}

// Seconds.
template <class Write>
double seconds_of(Write&& write, const std::vector<fs::path>& files, bool flushed) {
  const auto start = std::chrono::steady_clock::now();
  write();
  if (flushed)
    for (const fs::path& file : files) flush(file);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void write_plain(const std::vector<fs::path>& files, const std::vector<std::uintmax_t>& sizes) {
  static const std::vector<char> piece(std::size_t{1} << 19, 'w');
  for (std::size_t k = 0; k < files.size(); ++k) {
    std::FILE* stream = std::fopen(files[k].c_str(), "wb");
    if (stream == nullptr) std::abort();
    for (std::uintmax_t left = sizes[k]; left > 0; left -= std::min<std::uintmax_t>(left, piece.size()))
      benchmark::DoNotOptimize(std::fwrite(piece.data(), 1, std::min<std::uintmax_t>(left, piece.size()), stream));
    std::fclose(stream);
  }
}

void cache(benchmark::State& state) {
  constexpr const char* kEndings[] = {"pc2", "mdd", "glb", "usda", "ply", "obj"};
  const std::string ending = kEndings[state.range(0)];
  const bool flushed = state.range(1) != 0;
  const fs::path file = "weft_bench_cache." + ending;
  const RenderMesh mesh = make_grid(Grid{.cells_x = kSide, .cells_y = kSide}).render;
  std::vector<Vec3> positions = mesh.positions, normals = mesh.normals;
  for (std::size_t v = 0; v < positions.size(); ++v) {   // as in a cloth that has moved, few numbers are short
    const float x = std::sin(static_cast<float>(v)), y = std::cos(static_cast<float>(v));
    positions[v] = {positions[v].x + 0.01f * x, 0.3f * y, positions[v].z};
    normals[v] = {0.6f * x, 0.8f, 0.6f * y};
  }
  const auto write_cache = [&] {
    const auto writer = need(CacheWriter::create(file, mesh, {.frames = kCached}));
    for (std::uint32_t k = 0; k < kCached; ++k) need(writer->add({.positions = positions, .normals = normals, .strain = {}}));
    need(writer->finish());
  };
  std::vector<fs::path> files = {file}, plain;
  if (is_sequence(need(cache_format(file)))) files.clear();
  for (std::uint32_t k = 1; files.size() < kCached && is_sequence(need(cache_format(file))); ++k)
    files.push_back(sequence_file(file, k, kCached));
  for (const fs::path& one : files) plain.push_back("weft_bench_plain_" + one.filename().string());
  double best = INFINITY, best_plain = INFINITY;
  std::vector<std::uintmax_t> sizes;
  const auto remove_all = [](const std::vector<fs::path>& them) {
    for (const fs::path& one : them) fs::remove(one);
  };
  for (auto _ : state) {
    for (int turn = 0; turn < kTurns; ++turn) {
      best = std::min(best, seconds_of(write_cache, files, flushed));
      sizes.clear();
      for (const fs::path& one : files) sizes.push_back(fs::file_size(one));
      remove_all(files);
      best_plain = std::min(best_plain, seconds_of([&] { write_plain(plain, sizes); }, plain, flushed));
      remove_all(plain);
    }
    state.SetIterationTime(best);
  }
  double bytes = 0;
  for (const std::uintmax_t size : sizes) bytes += static_cast<double>(size);
  state.SetLabel(ending);
  state.counters["MB"] = bytes / 1e6;
  state.counters["MB/s"] = bytes / 1e6 / best;
  state.counters["plain_MB/s"] = bytes / 1e6 / best_plain;
  state.counters["of_plain"] = best_plain / best;
}

BENCHMARK(cache)->ArgNames({"format", "flushed"})->ArgsProduct({{0, 1, 2, 3, 4, 5}, {1, 0}})->Unit(benchmark::kMillisecond)
    ->UseManualTime()->Iterations(1);

}  // namespace
}  // namespace weft::bench
