#include "samples/weft/caches.h"

#include <algorithm>

#include "compute/part_file.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"

namespace weft::command {

namespace {

// A relative one lies in the folder of --out, as everything that a run writes.
std::filesystem::path place_of(const std::filesystem::path& cache, const RunOptions& options) {
  return (options.out / cache).lexically_normal();
}

// What is asked for of a simulation once a frame, however many caches there are.
struct Drawn {
  std::vector<Vec3> positions, normals;
  std::vector<float> strain;
};

Result<Drawn> drawn_by(const Simulation& simulation, bool normals, bool strain) {
  Drawn drawn;
  Result<std::vector<Vec3>> positions = simulation.read_vertex_positions();
  if (!positions) return positions.take_error();
  drawn.positions = std::move(*positions);
  if (normals) {
    Result<std::vector<Vec3>> read = simulation.read_vertex_normals();
    if (!read) return read.take_error();
    drawn.normals = std::move(*read);
  }
  if (!strain) return drawn;
  const auto particles = simulation.read_positions();
  if (!particles) return particles.why();
  drawn.strain = vertex_strain(simulation.fabric(), *particles);
  return drawn;
}

// A frame of one cache: lists of its own, and what looks at them.
struct Content {
  std::vector<Vec3> positions, normals;
  CacheFrame frame;

  Content(const Drawn& drawn, const CachedShape& shape) : positions(cached_positions(shape, drawn.positions)) {
    if (!shape.mesh.normals.empty()) normals = cached_normals(shape, drawn.normals);
    frame = {positions, normals, {}};
    if (shape.has_strain) frame.strain = std::span(drawn.strain).first(positions.size());
  }
};

bool any(const auto& caches, bool (*is_so)(const CachedShape&)) {
  return std::ranges::any_of(caches, [&](const auto& cache) { return is_so(cache.shape); });
}

Result<Drawn> drawn_for(const auto& caches, const Simulation& simulation) {
  return drawn_by(
      simulation, any(caches, [](const CachedShape& shape) { return !shape.mesh.normals.empty(); }),
      any(caches, [](const CachedShape& shape) { return shape.has_strain; }));
}

Exit refuse(const Error& error) {
  complain("--cache: " + error.message);
  return error.kind == ErrorKind::input ? kBadInput : kFailed;
}

}  // namespace

Exit Caches::prepare(const Scene& scene, const RunOptions& options, std::span<const Input> inputs) {
  if (!options.caches.empty())
    if (const Result<void> can = check_cached(scene); !can) return refuse(can.why());
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& cache : options.caches) {
    const std::filesystem::path file = place_of(cache, options);
    const Result<CacheFormat> format = cache_format(file);
    if (!format) return refuse(format.why());
    if (scene.frames == 0) return refuse(fail(file.string(), " is not written: a cache has at least one frame, and the run has 0"));
    if (std::ranges::find(files, file) != files.end()) return refuse(fail(file.string(), " is asked for twice"));
    files.push_back(file);
    std::vector<std::string> names;
    if (is_sequence(*format))
      for (std::uint32_t frame = 1; frame <= scene.frames; ++frame)
        names.push_back(sequence_file(file.filename(), frame, scene.frames).string());
    else names.push_back(file.filename().string());
    if (!is_sequence(*format) && options.checkpoint > 0) names.push_back(part_of(file.filename()).string());
    if (const Exit exit = prepare_outputs(file.parent_path(), names, inputs); exit != kDone) return exit;
  }
  return kDone;
}

Exit Caches::open(const Simulation& simulation, const RunOptions& options, std::optional<std::uint32_t> resumed_at) {
  const Scene& scene = simulation.scene();
  frames_ = scene.frames;
  resumable_ = options.checkpoint > 0;
  for (const std::filesystem::path& named : options.caches) {
    Cache cache{place_of(named, options), {}, nullptr};
    const Result<CacheFormat> format = cache_format(cache.file);
    if (!format) return refuse(format.why());
    cache.shape = cached_shape(simulation.fabric(), simulation.meshes(), simulation.origin(), *format);
    caches_.push_back(std::move(cache));
  }
  std::optional<Drawn> left;
  if (resumed_at && !caches_.empty()) {
    Result<Drawn> drawn = drawn_for(caches_, simulation);
    if (!drawn) return failed(drawn.error());
    left = std::move(*drawn);
  }
  const CacheOptions wanted{scene.frames, scene.solver.rate, scene.name, resumable_};
  for (Cache& cache : caches_) {
    auto writer = left ? CacheWriter::resume(cache.file, cache.shape.mesh, wanted, *resumed_at, Content(*left, cache.shape).frame)
                       : CacheWriter::create(cache.file, cache.shape.mesh, wanted);
    if (!writer && left) return refuse(fail(writer.why(), "; --fresh begins anew"));
    if (!writer) return refuse(writer.why());
    cache.writer = std::move(*writer);
  }
  return kDone;
}

Result<void> Caches::add(const Simulation& simulation) {
  if (caches_.empty()) return {};
  const Result<Drawn> drawn = drawn_for(caches_, simulation);
  if (!drawn) return drawn.why();
  for (Cache& cache : caches_)
    if (Result<void> added = cache.writer->add(Content(*drawn, cache.shape).frame); !added) return added;
  return {};
}

Result<void> Caches::finish() {
  for (Cache& cache : caches_) {
    const std::uint32_t done = cache.writer->frames();
    if (done < frames_) {
      const Result<CacheFormat> format = cache_format(cache.file);
      const char* fate = resumable_ ? " will be written when the run goes on; its part has " : " is not written: it has ";
      if (format && is_sequence(*format)) fate = " has ";
      complain(cache.file.string() + fate + std::to_string(done) + " of " + std::to_string(frames_) + " frames");
      continue;
    }
    if (Result<void> finished = cache.writer->finish(); !finished) return finished;
  }
  return {};
}

std::string Caches::names() const {
  std::string names;
  for (const Cache& cache : caches_)
    if (cache.writer->frames() == frames_) names += ", " + cache.file.filename().string();
  return names;
}

}  // namespace weft::command
