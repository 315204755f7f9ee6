// Caches: animated geometry for other programs, written to disk a frame at a time, so that memory does not grow with their number.
//
//     const auto shape = weft::cached_shape(simulation.fabric(), simulation.meshes(), simulation.origin(), weft::CacheFormat::pc2);
//     auto cache = weft::CacheWriter::create("flag.pc2", shape.mesh, {.frames = 300, .rate = 60});
//     for (int frame = 0; frame < 300; ++frame) {
//       simulation.advance(1.0 / 60);
//       const auto positions = weft::cached_positions(shape, *simulation.read_vertex_positions());
//       (*cache)->add({.positions = positions});
//     }
//     (*cache)->finish();   // until here there is no flag.pc2
//
// | ending | what it holds                                                             | limits                                        |
// |--------|---------------------------------------------------------------------------|-----------------------------------------------|
// | pc2    | POINTCACHE2: positions                                                    | 2^31 - 1 points and frames                    |
// | mdd    | MDD: positions, big-endian                                                | the same                                      |
// | glb    | glTF 2.0: the mesh at rest and a morph target a frame, whose weights are  | 4 GiB, 32767 frames                           |
// |        | animated, linearly; positions are differences from those at rest;         |                                               |
// |        | with the materials and textures of the meshes' files                      |                                               |
// | usda   | USD: a Mesh whose points, normals and extent are time samples             | none but the disk's                           |
// | ply    | a file a frame: NAME_0001.ply, binary, as final.ply of `weft run`         | none but the disk's                           |
// | obj    | a file a frame: NAME_0001.obj                                             | none but the disk's                           |
//
// Frames are counted from 1, as time codes of USD and in the names of files; frame k belongs to the time k / rate. Positions are the floats
// that were given, bit by bit, in text too; only in a glb adding the difference may round the last bit.
//
// Point caches have the vertices of a mesh's file in the file's order, since a program that reads them has the mesh already: a Mesh Cache
// modifier of Blender's. The others have the render vertices: the file's in their order, then copies with other normals or UVs.
//
// A file takes its name when it is whole (compute/part_file.h), and of a sequence every file by itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/mesh.h"

namespace weft {

enum class CacheFormat { pc2, mdd, glb, usda, ply, obj };

/// By the ending, in capitals too. Errors: another one; the sentence lists them.
Result<CacheFormat> cache_format(const std::filesystem::path& file);
/// Positions alone, by the numbers of the mesh's file.
bool is_point_cache(CacheFormat format);
/// A file a frame.
bool is_sequence(CacheFormat format);
/// The file of a sequence's frame (1 ... frames): the number has four digits, or as many as the last frame's.
std::filesystem::path sequence_file(const std::filesystem::path& file, std::uint32_t frame, std::uint32_t frames);

struct CacheOptions {
  std::uint32_t frames = 0;   // that will be added: 1 or more
  double rate = 60;           // frames a second: > 0
  std::string name = "cloth"; // of the object in a glb or a usda
  /// The part is FILE.part and stays if it is not finished, so that another process can go on with it: resume.
  bool resumable = false;
};

/// A frame: an entry a vertex in each list. Spans are read in the call only.
struct CacheFrame {
  std::span<const Vec3> positions = {};   // m
  std::span<const Vec3> normals = {};     // unit; needed where the mesh has them and the format is glb, usda or obj
  std::span<const float> strain = {};     // fractions, for ply; or none
};

class CacheWriter {
 public:
  /// `mesh` at rest: how many vertices there are; their triangles; in a glb or a usda with normals and UVs if it has them, as many as
  /// positions or none. Its tangents are not read. Errors, before anything is written: the ending; no frame, a rate that is not above 0;
  /// lists that do not fit together, a position that is not finite; no triangle in a glb or usda; more than the format or the disk holds; a
  /// place that cannot be written.
  static Result<std::unique_ptr<CacheWriter>> create(const std::filesystem::path& file, const RenderMesh& mesh,
                                                     const CacheOptions& options);
  /// Goes on with what another writer with `resumable` left, after the first `done` frames, of which `last` is the last: bit by bit as if
  /// it had not stopped. Frames after it are written again. Errors: as create; the part is not there, or does not hold that frame.
  static Result<std::unique_ptr<CacheWriter>> resume(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options,
                                                     std::uint32_t done, const CacheFrame& last);
  /// Without finish nothing of the file is left, but the part where it is `resumable`, and a sequence's files.
  ~CacheWriter();
  CacheWriter(const CacheWriter&) = delete;
  CacheWriter& operator=(const CacheWriter&) = delete;

  /// The next frame. Errors: all frames are there; another number of vertices; a position that is not finite, or 1e10 m away or more; a
  /// full disk. A frame that was not added can be added again.
  Result<void> add(const CacheFrame& frame);
  /// The file takes its name. Errors: frames are missing; as write_file's (compute/file.h).
  Result<void> finish();

  std::uint32_t frames() const;   // that were added

 private:
  struct State;
  explicit CacheWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Of a simulation's cloths what a cache holds: cloth after cloth in one mesh, of a cloth that carries a render mesh this instead.
struct CachedShape {
  RenderMesh mesh;                       // at rest, m, world space; for point caches positions alone
  std::vector<std::uint32_t> vertices;   // the render vertex of the simulation that each is; kNone: one of no triangle, which stays at rest
  bool has_strain = false;               // for ply: its vertices are the first of vertex_strain(), where there is no render mesh
};

/// Whether its cloths can be cached: all frames have the same triangles. Errors: a cloth that tears.
Result<void> check_cached(const Scene& scene);

/// `meshes` and `origin`: as Simulation has them; of a scene that check_cached takes.
CachedShape cached_shape(const CookedFabric& fabric, std::span<const Mesh> meshes, Vec3 origin, CacheFormat format);

/// Of all render vertices (Simulation::read_vertex_positions) those of the shape.
std::vector<Vec3> cached_positions(const CachedShape& shape, std::span<const Vec3> vertex_positions);
/// The same of normals (Simulation::read_vertex_normals).
std::vector<Vec3> cached_normals(const CachedShape& shape, std::span<const Vec3> vertex_normals);

}  // namespace weft
