// What is compressed in a glTF, unpacked before anything of it is read. The decoders are other people's: meshoptimizer's are made for
// anyone's bytes, and what they are given cannot hold more than the sizes below; Draco's takes its sizes from its own stream, so it works
// in a process of its own (engine/mesh/apart.h).
#include <algorithm>
#include <array>
#include <cstring>

#include "engine/mesh/gltf.h"
#include "engine/mesh/parts.h"

#ifdef WEFT_MESHOPT
#include <meshoptimizer.h>
#endif

namespace weft::parts {
namespace {

constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr std::uint64_t kMostUnpacked = kMostBytes / 4;   // of each of the two, of a document

std::size_t add_view(GltfDocument& document, std::string bytes) {
  json& views = document.tree.root["bufferViews"];
  JsonTree view = object_of("buffer", document.buffers.size(), "byteLength", bytes.size());
  views.push_back(std::move(view.root));
  document.buffers.push_back(std::move(bytes));
  return views.size() - 1;
}

/// A compressed buffer view, as the document describes it.
struct Packed {
  std::string_view bytes;
  std::uint64_t count, stride;
  bool is_vertices, is_triangles;
  std::string_view filter;
};

/// A fault unless all is as the extension says, and the stream is long enough to hold what is said to be in it: its codecs take two bits
/// for sixteen bytes of vertices, a byte for a triangle, and a byte for any other index.
Packed packed(GltfDocument& document, const json& view, const json& described, std::size_t number) {
  const auto say = [&](const auto&... parts) { document.say("buffer view ", number, " (", kMeshopt, "): ", parts...); };
  const auto text = [&](const char* key, const char* missing) -> std::string_view {
    if (!has(described, key)) return missing;
    const std::string* held = described[key].get_ptr<const std::string*>();
    return held ? std::string_view(*held) : std::string_view("?");
  };
  const std::string_view mode = text("mode", ""), filter = text("filter", "NONE");
  Packed packed{document.view(described, kMeshopt), document.natural(described, "count", 0), document.natural(described, "byteStride", 0),
                mode == "ATTRIBUTES", mode == "TRIANGLES", filter};
  const std::uint64_t stride = packed.stride, wanted = document.natural(view, "byteLength", 0);
  if (mode != "ATTRIBUTES" && mode != "TRIANGLES" && mode != "INDICES") say("has the mode \"", mode.substr(0, 40), "\"");
  if (packed.is_vertices ? stride % 4 != 0 || stride == 0 || stride > 256 : stride != 2 && stride != 4)
    say("has a stride of ", stride, " bytes");
  const bool fits = filter == "NONE" || (packed.is_vertices && ((filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                                                                (filter == "QUATERNION" && stride == 8) || filter == "EXPONENTIAL"));
  if (!fits) say("has the filter \"", filter.substr(0, 40), "\" on ", stride, " bytes");
  if (packed.count > kMostIndices || packed.count * stride != wanted)
    say("has ", packed.count, " elements of ", stride, " bytes, and ", wanted, " bytes");
  if (packed.is_triangles && packed.count % 3 != 0) say("has ", packed.count, " corners, which is no multiple of 3");
  const std::uint64_t most = packed.bytes.size() * (packed.is_vertices ? 64 : packed.is_triangles ? 3 : 1);
  if ((packed.is_vertices ? wanted : packed.count) > most)
    say("cannot hold ", packed.count, " elements in ", packed.bytes.size(), " bytes");
  return packed;
}

#ifdef WEFT_MESHOPT
/// False where the stream is not what it claims to be.
bool unpack(const Packed& from, std::string& to) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(from.bytes.data());
  const std::size_t size = from.bytes.size(), count = from.count, stride = from.stride;
  if (from.is_triangles) return meshopt_decodeIndexBuffer(to.data(), count, stride, bytes, size) == 0;
  if (!from.is_vertices) return meshopt_decodeIndexSequence(to.data(), count, stride, bytes, size) == 0;
  if (meshopt_decodeVertexBuffer(to.data(), count, stride, bytes, size) != 0) return false;
  if (from.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to.data(), count, stride);
  if (from.filter == "QUATERNION") meshopt_decodeFilterQuat(to.data(), count, stride);
  if (from.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to.data(), count, stride);
  return true;
}
constexpr bool kHasMeshopt = true;
#else
bool unpack(const Packed&, std::string&) { return false; }
constexpr bool kHasMeshopt = false;
#endif

/// Views whose plain bytes are there as well are left as they are.
void unpack_meshopt(GltfDocument& document) {
  std::uint64_t total = 0;
  const std::size_t count = document.list(document.tree.root, "bufferViews").size();
  for (std::size_t k = 0; k < count && document.fault.empty(); ++k) {
    json& view = document.tree.root["bufferViews"][k];
    const json& described = member(member(view, "extensions"), kMeshopt);
    if (described.empty()) continue;
    const std::uint64_t plain = document.natural(view, "buffer", 0);
    if (plain < document.buffers.size() && !document.buffers[plain].empty()) continue;
    const auto bytes = document.natural(view, "byteLength", 0);
    if (!kHasMeshopt)
      return document.say("buffer view ", k, " is compressed (", kMeshopt, "): this Weft was built without meshoptimizer ",
                          "(libmeshoptimizer-dev)");
    const Packed from = packed(document, view, described, k);
    if (total += bytes; total > kMostUnpacked) document.say("its compressed buffer views hold more than ", kMostUnpacked, " bytes");
    if (!document.fault.empty()) return;
    std::string to(static_cast<std::size_t>(bytes), '\0');
    if (!unpack(from, to)) return document.say("buffer view ", k, " (", kMeshopt, ") cannot be unpacked: its stream is damaged");
    view["buffer"] = document.buffers.size();
    view["byteOffset"] = 0u;
    document.buffers.push_back(std::move(to));
  }
}

/// A primitive that only its compressed form describes.
struct Compressed {
  json* primitive;
  DracoMesh mesh;
  std::vector<std::string> names;   // of the mesh's attributes
};

void add_compressed(GltfDocument& document, json& primitive, const json& described, std::vector<Compressed>& all) {
  const json& attributes = member(primitive, "attributes");
  const json* view = document.entry(document.list(document.tree.root, "bufferViews"), described, "bufferView");
  Compressed& one = all.emplace_back(Compressed{&primitive, {}, {}});
  if (view) one.mesh.bytes = document.view(*view, kDraco);
  const json& indices = member(primitive, "indices");
  if (indices.is_number()) {
    const json* accessor = document.entry(document.list(document.tree.root, "accessors"), primitive, "indices");
    if (accessor) one.mesh.corners = document.natural(*accessor, "count", 0);
  }
  const json& ids = member(described, "attributes");
  for (const auto& [name, id] : ids.items()) {
    const json* accessor = document.entry(document.list(document.tree.root, "accessors"), attributes, name.c_str());
    if (!accessor) return;
    const std::string* type = has(*accessor, "type") ? (*accessor)["type"].get_ptr<const std::string*>() : nullptr;
    const bool is_vector = type && type->size() == 4 && type->starts_with("VEC") && type->back() >= '2' && type->back() <= '4';
    if (!is_vector && !(type && *type == "SCALAR"))
      return document.say("the accessor of \"", name, "\" is compressed and not a SCALAR or a vector");
    one.names.push_back(name);
    one.mesh.attributes.push_back({document.natural(ids, name.c_str(), 0), document.natural(*accessor, "componentType", 0),
                                   is_vector ? static_cast<std::size_t>(type->back() - '0') : 1});
    const std::uint64_t count = document.natural(*accessor, "count", 0);
    if (one.mesh.attributes.size() > 1 && count != one.mesh.vertices)
      return document.say("a compressed primitive has ", one.mesh.vertices, " and ", count, " vertices");
    one.mesh.vertices = count;
  }
  if (one.mesh.vertices > kMostVertices || one.mesh.corners > kMostIndices)
    document.say("a compressed primitive has ", one.mesh.vertices, " vertices and ", one.mesh.corners, " corners; at most ",
                 kMostVertices, " and ", kMostIndices, " are allowed");
}

/// Accessors of its own for what was unpacked of a primitive.
void put_unpacked(GltfDocument& document, const Compressed& from, std::string_view bytes) {
  json& accessors = document.tree.root["accessors"];
  json& primitive = *from.primitive;
  const auto add = [&](std::size_t size, std::uint64_t component, std::uint64_t count, const std::string& type) {
    const std::size_t view = add_view(document, std::string(bytes.substr(0, size)));
    bytes.remove_prefix(size);
    JsonTree accessor = object_of("bufferView", view, "componentType", component, "count", count, "type", type);
    accessors.push_back(std::move(accessor.root));
    return accessors.size() - 1;
  };
  primitive["indices"] = add(from.mesh.corners * sizeof(std::uint32_t), 5125, from.mesh.corners, "SCALAR");
  primitive["mode"] = 4u;
  for (std::size_t k = 0; k < from.names.size(); ++k) {
    json& number = primitive["attributes"][from.names[k]];
    const std::size_t old = number.get<std::size_t>();
    const DracoMesh::Attribute& attribute = from.mesh.attributes[k];
    const std::string type = accessors[old]["type"];
    const bool is_normalized = has(accessors[old], "normalized") && accessors[old]["normalized"] == true;
    number = add(from.mesh.vertices * attribute.size(), attribute.component, from.mesh.vertices, type);
    accessors.back()["normalized"] = is_normalized;
  }
}

void unpack_draco(GltfDocument& document) {
  std::vector<Compressed> all;
  std::uint64_t total = 0;
  if (!has(document.tree.root, "meshes") || !document.tree.root["meshes"].is_array()) return;
  for (json& mesh : document.tree.root["meshes"]) {
    if (!has(mesh, "primitives") || !mesh["primitives"].is_array()) continue;
    for (json& primitive : mesh["primitives"]) {
      const json& described = member(member(primitive, "extensions"), kDraco);
      if (described.empty()) continue;
      const json* position = document.entry(document.list(document.tree.root, "accessors"), member(primitive, "attributes"), "POSITION");
      if (!document.fault.empty()) return;
      if (has(*position, "bufferView")) continue;   // a plain copy
      add_compressed(document, primitive, described, all);
      if (!document.fault.empty()) return;
      if ((total += all.back().mesh.size()) > kMostUnpacked)
        return document.say("its compressed primitives hold more than ", kMostUnpacked, " bytes");
    }
  }
  if (all.empty()) return;
  std::vector<DracoMesh> meshes;
  for (const Compressed& one : all) meshes.push_back(one.mesh);
  const Result<std::string> unpacked = unpack_draco(meshes, total);
  if (!unpacked) return document.say("a primitive is compressed (", kDraco, "): ", unpacked.error());
  std::string_view rest = *unpacked;
  for (const Compressed& one : all) {
    if (rest.size() < one.mesh.size()) return document.say("a primitive is compressed (", kDraco, "): its stream holds less than it says");
    put_unpacked(document, one, rest.substr(0, one.mesh.size()));
    rest.remove_prefix(one.mesh.size());
  }
}

}  // namespace

void unpack_gltf(GltfDocument& document) {
  unpack_meshopt(document);
  if (document.fault.empty()) unpack_draco(document);
}

}  // namespace weft::parts
