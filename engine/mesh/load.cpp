// Reads files into render meshes: which format it is, what they share, and what is said of what was left out. Welding, repair and
// everything else that decides what the cloth is happens in engine/mesh/weld.cpp, the same for every format.
#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <utility>

#include "engine/mesh/parts.h"

namespace weft {
namespace parts {

Result<std::string> read_file(const std::filesystem::path& file, std::optional<std::size_t> first_bytes) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) return fail(file.string(), " does not exist");
  if (std::filesystem::is_directory(status)) return fail(file.string(), " is a folder, not a file");
  if (!std::filesystem::is_regular_file(status)) return fail(file.string(), " is not a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(file.string(), " cannot be opened for reading");
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (code) return fail(file.string(), " cannot be read: ", code.message());
  if (size == 0) return fail(file.string(), " is empty");
  if (!first_bytes && size > kMostBytes) return fail(file.string(), " has ", size, " bytes; at most ", kMostBytes, " are read");
  std::string content(static_cast<std::size_t>(std::min<std::uintmax_t>(size, first_bytes.value_or(kMostBytes))), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (stream.gcount() != static_cast<std::streamsize>(content.size())) return fail(file.string(), " cannot be read");
  return content;
}

}   // namespace parts

namespace {

/// Primitives without indices, and some OBJs, have a vertex for every corner of every face. Vertices that agree to the last bit are
/// one vertex: less to draw, and tangents get neighbours to be smooth with. Returns the new number of each.
std::vector<std::uint32_t> join_copies(RenderMesh& render) {
  struct Key {
    std::array<std::uint32_t, 12> bits;
    std::uint32_t vertex;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(render.positions.size());
  for (std::uint32_t v = 0; v < keys.size(); ++v) {
    const Vec3 p = render.positions[v], n = render.normals[v];
    const Vec4 t = render.tangents[v];
    const Vec2 uv = render.uvs[v];
    keys[v] = {
        std::bit_cast<std::array<std::uint32_t, 12>>(std::array<float, 12>{p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y, t.z, t.w, uv.x, uv.y}),
        v};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> first(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    first[keys[i].vertex] = i > 0 && keys[i].bits == keys[i - 1].bits ? first[keys[i - 1].vertex] : keys[i].vertex;

  std::uint32_t kept = 0;
  std::vector<std::uint32_t> renamed(first.size());
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) {
      renamed[v] = renamed[first[v]];
      continue;
    }
    render.positions[kept] = render.positions[v];
    render.normals[kept] = render.normals[v];
    render.tangents[kept] = render.tangents[v];
    render.uvs[kept] = render.uvs[v];
    renamed[v] = kept++;
  }
  render.positions.resize(kept);
  render.normals.resize(kept);
  render.tangents.resize(kept);
  render.uvs.resize(kept);
  for (Triangle& triangle : render.triangles)
    for (std::uint32_t& v : triangle) v = renamed[v];
  return renamed;
}

Result<parts::Harvest> harvest_of(const std::filesystem::path& file, BufferFiles buffer_files) {
  std::string kind = file.extension().string();
  for (char& c : kind) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  const bool gltf = kind == ".gltf" || kind == ".glb", foreign = kind == ".ply" || kind == ".stl" || kind == ".dae" || kind == ".fbx";
  if (!gltf && !foreign && kind != ".obj")
    return fail(file.string(), " has the extension \"", kind, "\"; .gltf, .glb, .obj, .ply, .stl, .dae and .fbx can be read");
  Result<std::string> content = parts::read_file(file);
  if (!content) return content.take_error();
  Result<parts::Harvest> harvest = gltf      ? parts::read_gltf(*content, file.parent_path(), buffer_files)
                                  : foreign ? parts::read_foreign(*content, kind.substr(1))
                                            : parts::read_obj(*content);
  if (!harvest) return fail(file.string(), ": ", harvest.why());
  return harvest;
}

// A morph target's vertices become points.
void take_over(Skin::Morph& morph, std::span<const std::uint32_t> point_of, std::span<const std::uint32_t> vertex_of) {
  std::vector<std::pair<std::uint32_t, std::size_t>> kept;   // point, place in the file's list
  for (std::size_t k = 0; k < morph.points.size(); ++k)
    if (const std::uint32_t v = morph.points[k], point = point_of[v]; point != kNone && vertex_of[point] == v) kept.emplace_back(point, k);
  std::ranges::sort(kept);
  const Skin::Morph all = std::exchange(morph, {.name = morph.name, .weight = morph.weight, .points = {}, .deltas = {}, .normal_deltas = {}});
  for (const auto& [point, k] : kept) {
    morph.points.push_back(point);
    morph.deltas.push_back(all.deltas[k]);
    if (!all.normal_deltas.empty()) morph.normal_deltas.push_back(all.normal_deltas[k]);
  }
}

// What belongs to vertices of the file becomes that of points: the first vertex of each decides.
void take_over(parts::Harvest& harvest, Mesh& mesh) {
  std::vector<std::uint32_t> vertex_of(mesh.points.size(), kNone);
  for (std::uint32_t v = 0; v < mesh.point_of_source.size(); ++v)
    if (const std::uint32_t point = mesh.point_of_source[v]; point != kNone && vertex_of[point] == kNone) vertex_of[point] = v;
  for (const auto& [name, values] : harvest.attributes)
    for (const std::uint32_t v : vertex_of) mesh.attributes[name].push_back(values[v]);
  if (!harvest.skin) return;
  Skin& skin = mesh.skin.emplace(std::move(*harvest.skin));
  const auto joints_of = std::exchange(skin.joints_of, {});
  const auto weights = std::exchange(skin.weights, {});
  for (const std::uint32_t v : vertex_of) skin.joints_of.push_back(joints_of[v]), skin.weights.push_back(weights[v]);
  for (Skin::Morph& morph : skin.morphs) take_over(morph, mesh.point_of_source, vertex_of);
}

Result<Mesh> load(const std::filesystem::path& file, BufferFiles buffer_files) {
  Result<parts::Harvest> harvest = harvest_of(file, buffer_files);
  if (!harvest) return harvest.take_error();
  RenderMesh& render = harvest->render;
  if (Result<void> checked = parts::check_places(render.positions); !checked) return fail(file.string(), ": ", checked.why());
  const std::span<const Vec3> own = std::span(render.positions).first(harvest->source_vertices);
  const std::vector<Vec3> source(own.begin(), own.end());
  std::vector<std::uint32_t> joined;   // what became of each vertex; empty: nothing
  if (render.positions.size() >= 3 * render.triangles.size()) joined = join_copies(render);
  Result<Mesh> mesh = weld_mesh(std::move(render));
  if (!mesh) return fail(file.string(), ": ", mesh.why());
  for (std::uint32_t& v : joined) v = mesh->point_of_source[v];
  if (!joined.empty()) mesh->point_of_source = std::move(joined);
  mesh->point_of_source.resize(harvest->source_vertices);
  parts::keep_loose(*mesh, source);
  take_over(*harvest, *mesh);
  mesh->skin_fault = harvest->skin_fault;

  const auto note = [&](std::size_t count, const char* one, const char* many, const char* what) {
    if (count) mesh->mended.insert(mesh->mended.begin(), fail(count, " ", count == 1 ? one : many, what).message);
  };
  note(harvest->other_coordinates, "material has", "materials have",
       " textures with other coordinates than the first's, which all have now");
  note(harvest->crossed_faces, "face crosses", "faces cross", " over itself; triangles of it lie on each other or face different ways");
  note(harvest->bad_uvs, "texture coordinate was", "texture coordinates were", " not finite; projected instead");
  note(harvest->bad_normals, "normal was", "normals were", " not finite or had no direction; made anew");
  note(mesh->skin ? 0 : harvest->morph_targets, "morph target was", "morph targets were", " left out: the mesh has its base shape");
  if (!harvest->skin_fault.empty()) mesh->mended.insert(mesh->mended.begin(), "its skin was left out: " + harvest->skin_fault);
  if (!harvest->attribute_fault.empty())
    mesh->mended.insert(mesh->mended.begin(), "its vertex attributes were left out: " + harvest->attribute_fault);
  if (!harvest->material_fault.empty())
    mesh->mended.insert(mesh->mended.begin(), "its materials were left out: " + harvest->material_fault);
  if (!harvest->note.empty()) mesh->mended.insert(mesh->mended.begin(), harvest->note);
  note(harvest->lines, "line was", "lines were", " left out");
  note(harvest->points, "point was", "points were", " left out");
  return mesh;
}

}   // namespace

Result<Mesh> load_mesh(const std::filesystem::path& file, BufferFiles buffer_files) try {
  return load(file, buffer_files);
} catch (...) {
  return caught("the mesh");
}

}   // namespace weft
