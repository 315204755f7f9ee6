// The writer: what holds for every format, and where its bytes go.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "compute/file.h"
#include "compute/part_file.h"
#include "engine/cache/layout.h"
#include "engine/export.h"
#include "engine/finite.h"
#include "engine/mesh/glb.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<const char*, CacheFormat> kEndings[] = {{".glb", CacheFormat::glb},   {".pc2", CacheFormat::pc2},
                                                           {".mdd", CacheFormat::mdd},   {".usda", CacheFormat::usda},
                                                           {".ply", CacheFormat::ply},   {".obj", CacheFormat::obj}};
constexpr double kFastest = 1e6;   // frames a second: floats tell the times of 16 million frames apart

Result<void> check_mesh(const fs::path& file, const RenderMesh& mesh, CacheFormat format) {
  const std::size_t vertices = mesh.positions.size();
  if (vertices == 0) return fail(file.string(), " is not written: the mesh has no vertex");
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_finite(mesh.positions[v]))
      return fail(file.string(), " is not written: vertex ", v, " of the mesh at rest is not finite, or ", kTooLarge, " m away or more");
  if (is_point_cache(format)) return {};
  if (Result<void> good = parts::check_length(file, "normals", mesh.normals.size(), vertices); !good) return good;
  if (Result<void> good = parts::check_length(file, "texture coordinates", mesh.uvs.size(), vertices); !good) return good;
  return parts::check_indices(file, mesh.triangles, vertices);
}

Result<void> check_options(const fs::path& file, const CacheOptions& options) {
  if (options.frames == 0) return fail(file.string(), " is not written: a cache has at least one frame, and this one would have 0");
  if (!(options.rate > 0) || options.rate > kFastest)
    return fail(file.string(), " is not written: ", options.rate, " frames a second are not above 0 and at most ", kFastest);
  return {};
}

// Where the system says how much there is.
Result<void> check_room(const fs::path& file, std::uint64_t bytes) {
  std::error_code none;
  const Result<fs::path> target = file_target(file);
  if (!target) return target.why();
  const fs::space_info space = fs::space(target->has_parent_path() ? target->parent_path() : ".", none);
  if (none || space.capacity == 0 || bytes <= space.free) return {};
  return fail(ErrorKind::other, file.string(), " cannot be written: it takes ", bytes, " bytes, and its disk has ", space.free, " left");
}

caching::LayoutResult layout_of(CacheFormat format, const fs::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  switch (format) {
    case CacheFormat::pc2: return caching::pc2_layout(file, mesh, options);
    case CacheFormat::mdd: return caching::mdd_layout(file, mesh, options);
    case CacheFormat::glb: return caching::glb_layout(file, mesh, options);
    case CacheFormat::usda: return caching::usda_layout(file, mesh, options);
    default: return std::unique_ptr<caching::Layout>();
  }
}

}  // namespace

Result<CacheFormat> cache_format(const fs::path& file) try {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const auto& [name, format] : kEndings)
    if (ending == name) return format;
  return fail(file.string(), " has the extension \"", ending,
              "\"; caches are .glb, .pc2, .mdd, .usda, or .ply and .obj with a file a frame");
} catch (...) {
  return caught("a cache's name");
}

bool is_point_cache(CacheFormat format) { return format == CacheFormat::pc2 || format == CacheFormat::mdd; }
bool is_sequence(CacheFormat format) { return format == CacheFormat::ply || format == CacheFormat::obj; }

fs::path sequence_file(const fs::path& file, std::uint32_t frame, std::uint32_t frames) {
  std::string number = std::to_string(frame);
  const std::size_t width = std::max<std::size_t>(4, std::to_string(frames).size());
  number.insert(0, width - std::min(width, number.size()), '0');
  return file.parent_path() / (file.stem().string() + "_" + number + file.extension().string());
}

struct CacheWriter::State {
  fs::path file;
  CacheFormat format = CacheFormat::pc2;
  CacheOptions options;
  std::size_t vertices = 0;
  bool has_normals = false;
  std::uint32_t done = 0;
  std::vector<Triangle> triangles;             // of a ply
  parts::ObjFaces faces;                       // of an obj
  std::unique_ptr<caching::Layout> layout;     // null of a sequence
  std::optional<PartFile> part;

  static Result<std::unique_ptr<State>> create(const fs::path& file, const RenderMesh& mesh, const CacheOptions& options) {
    const Result<CacheFormat> format = cache_format(file);
    if (!format) return format.why();
    if (Result<void> good = check_options(file, options); !good) return good.take_error();
    if (Result<void> good = check_mesh(file, mesh, *format); !good) return good.take_error();
    caching::LayoutResult layout = layout_of(*format, file, mesh, options);
    if (!layout) return layout.take_error();
    auto state = std::make_unique<State>();
    state->file = file;
    state->format = *format;
    state->options = options;
    state->vertices = mesh.positions.size();
    state->has_normals = !is_point_cache(*format) && *format != CacheFormat::ply && !mesh.normals.empty();
    if (*format == CacheFormat::ply) state->triangles = mesh.triangles;
    if (*format == CacheFormat::obj) state->faces = parts::obj_faces(mesh.uvs, mesh.triangles, state->has_normals);
    state->layout = std::move(*layout);
    return state;
  }

  Result<void> check_frame(const CacheFrame& frame) const {
    const auto fault = [&](const auto&... what) { return fail("frame ", done + 1, " of ", file.string(), ": ", what...); };
    if (frame.positions.size() != vertices) return fault(frame.positions.size(), " positions for ", vertices, " vertices");
    if (frame.normals.size() != vertices && (has_normals || !frame.normals.empty()))
      return fault(frame.normals.size(), " normals for ", vertices, " vertices");
    if (!frame.strain.empty() && frame.strain.size() != vertices) return fault(frame.strain.size(), " strains for ", vertices, " vertices");
    for (std::size_t v = 0; v < vertices; ++v) {
      if (!is_finite(frame.positions[v])) return fault("vertex ", v, " is not finite, or ", kTooLarge, " m away or more");
      if (has_normals && !is_finite(frame.normals[v])) return fault("the normal of vertex ", v, " is not finite");
    }
    return {};
  }

  // Of a sequence.
  Result<void> put_frame(const CacheFrame& frame, const parts::PutText& put) const {
    if (format == CacheFormat::ply) return put(parts::ply_of(frame.positions, frame.normals, frame.strain, triangles));
    return parts::put_obj(frame.positions, has_normals ? frame.normals : std::span<const Vec3>(), faces, put);
  }

  Result<void> write_frame(const fs::path& of_frame, const CacheFrame& frame) const {
    Result<PartFile> whole = PartFile::create(of_frame, false);
    if (!whole) return whole.take_error();
    std::uint64_t bytes = 0;
    Result<void> put = put_frame(frame, [&](std::string_view piece) {
      return whole->write(std::exchange(bytes, bytes + piece.size()), caching::bytes_of(piece));
    });
    return put ? whole->finish(bytes) : put;
  }

  caching::Put writing() {
    return [this](std::uint64_t offset, std::span<const std::byte> bytes) { return part->write(offset, bytes); };
  }

  // Whether what an earlier writer has left holds the frame that it added last.
  Result<void> recognise(const CacheFrame& last) {
    if (!layout) {
      for (std::uint32_t k = 1; k <= done; ++k) {
        const fs::path of_frame = sequence_file(file, k, options.frames);
        std::error_code none;
        if (!fs::is_regular_file(of_frame, none)) return fail(of_frame.string(), " is not there");
        if (k < done) continue;
        std::ifstream stream(of_frame, std::ios::binary);
        std::string there{std::istreambuf_iterator<char>(stream), {}}, wanted;
        const Result<void> made = put_frame(last, [&](std::string_view piece) { return wanted += piece, Result<void>(); });
        if (!made || there != wanted) return fail(of_frame.string(), " is not of this run: it does not hold its frame ", done);
      }
      return {};
    }
    Result<PartFile> left = PartFile::reopen(file);
    if (!left) return left.take_error();
    part.emplace(std::move(*left));
    const auto compare = [&](std::uint64_t offset, std::span<const std::byte> bytes) -> Result<void> {
      if (part->holds(offset, bytes)) return {};
      return fail(part_of(file).string(), " is not of this run: it does not hold its frame ", done, " of ", options.frames);
    };
    return layout->put_frame(done - 1, last, compare);
  }
};

CacheWriter::CacheWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
CacheWriter::~CacheWriter() = default;

Result<std::unique_ptr<CacheWriter>> CacheWriter::create(const fs::path& file, const RenderMesh& mesh, const CacheOptions& options) try {
  Result<std::unique_ptr<State>> state = State::create(file, mesh, options);
  if (!state) return state.take_error();
  if ((*state)->layout) {
    if (Result<void> room = check_room(file, (*state)->layout->bytes()); !room) return room.take_error();
    Result<PartFile> part = PartFile::create(file, options.resumable);
    if (!part) return part.take_error();
    (*state)->part.emplace(std::move(*part));
    if (Result<void> put = (*state)->layout->put_frameless((*state)->writing()); !put) return put.take_error();
  } else if (Result<void> writable = probe_file(sequence_file(file, 1, options.frames)); !writable) {
    return writable.take_error();
  }
  return std::unique_ptr<CacheWriter>(new CacheWriter(std::move(*state)));
} catch (...) {
  return caught("the cache");
}

Result<std::unique_ptr<CacheWriter>> CacheWriter::resume(const fs::path& file, const RenderMesh& mesh, const CacheOptions& options,
                                                         std::uint32_t done, const CacheFrame& last) try {
  if (done == 0) return create(file, mesh, options);
  Result<std::unique_ptr<State>> state = State::create(file, mesh, options);
  if (!state) return state.take_error();
  State& at = **state;
  if (done > options.frames) return fail(file.string(), " cannot be gone on with after frame ", done, " of ", options.frames);
  if (Result<void> good = at.check_frame(last); !good) return good.take_error();
  at.done = done;
  if (Result<void> known = at.recognise(last); !known) return known.take_error();
  if (at.layout)
    if (Result<void> put = at.layout->put_frameless(at.writing()); !put) return put.take_error();
  return std::unique_ptr<CacheWriter>(new CacheWriter(std::move(*state)));
} catch (...) {
  return caught("the cache");
}

Result<void> CacheWriter::add(const CacheFrame& frame) try {
  State& at = *state_;
  if (at.done == at.options.frames) return fail(at.file.string(), " has all of its ", at.done, " frames already");
  if (Result<void> good = at.check_frame(frame); !good) return good;
  Result<void> put = at.layout ? at.layout->put_frame(at.done, frame, at.writing())
                               : at.write_frame(sequence_file(at.file, at.done + 1, at.options.frames), frame);
  if (put) ++at.done;
  return put;
} catch (...) {
  return caught("a frame of the cache");
}

Result<void> CacheWriter::finish() try {
  State& at = *state_;
  if (at.done < at.options.frames) return fail(at.file.string(), " has ", at.done, " of its ", at.options.frames, " frames");
  if (!at.part) return {};
  Result<void> finished = at.part->finish(at.layout->bytes());
  at.part.reset();
  return finished;
} catch (...) {
  return caught("the cache");
}

std::uint32_t CacheWriter::frames() const { return state_->done; }

}  // namespace weft
