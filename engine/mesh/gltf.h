// A glTF's document and its buffers, and how values are taken out of it; internal to the sources that read glTF.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compute/result.h"
#include "engine/json_tree.h"
#include "engine/mesh.h"
#include "engine/scene.h"

namespace weft::parts {

using json = nlohmann::json;

inline bool has(const json& object, const char* key) { return object.is_object() && object.contains(key); }

/// A document and the first fault that was found in it. After a fault its numbers are 0 and its lists empty, so callers need to look
/// only once, at the end.
struct GltfDocument {
  JsonTree tree;
  std::vector<std::string> buffers;   // each as long as the document says; after these what was unpacked
  std::map<const json*, std::string> dense;   // what sparse accessors come to
  std::uint64_t dense_bytes = 0;      // of them
  std::string fault;

  template <class... Parts>
  void say(const Parts&... parts) {
    if (fault.empty()) fault = fail(parts...).message;
  }

  const json& list(const json& object, const char* key);
  std::uint64_t natural(const json& object, const char* key, std::uint64_t missing);

  /// An entry of a list by an index found under `key`; nothing (and a fault) when it points past the end.
  const json* entry(const json& from, const json& object, const char* key);

  /// The bytes of a buffer view; none, and a fault, where it reaches past the end of its buffer.
  std::string_view view(const json& view, std::string_view name);
};

/// A member, or an empty object.
inline const json& member(const json& object, const char* key) {
  static const json none = json::object();
  return has(object, key) ? object[key] : none;
}

/// Reads the document of a glTF or GLB, and its buffers: those in it and those in files below `folder`, or anywhere. Faults of buffers
/// stay in it.
/// What is compressed in it is unpacked (unpack_gltf).
/// Errors: not JSON, too large or nested too deeply, cut short, another version than 2.
Result<GltfDocument> open_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files);

/// What an image or a buffer without a place in the document is: base64 in its "uri", or a file below `folder`, or anywhere; no more than
/// its first bytes. Errors: as read_file's, a place that is not allowed, no base64.
Result<std::string> bytes_at(const std::string& uri, std::optional<std::size_t> first_bytes, const std::filesystem::path& folder,
                             BufferFiles buffer_files);

/// Makes buffers, buffer views and accessors of what meshopt (EXT_meshopt_compression) and Draco (KHR_draco_mesh_compression) have
/// compressed, so that the document reads as if it never was. Faults stay in it, as that Weft was built without what unpacks it.
void unpack_gltf(GltfDocument& document);

/// A stream of Draco's, and what a document says is in it.
struct DracoMesh {
  struct Attribute {
    std::uint64_t id, component;   // the stream's name for it; glTF's component type
    std::size_t width;
    std::size_t size() const { return width * (component <= 5121 ? 1 : component <= 5123 ? 2 : 4); }   // bytes of a vertex
  };
  std::string_view bytes;
  std::uint64_t vertices = 0, corners = 0;
  std::vector<Attribute> attributes;
  std::uint64_t size() const;   // of what it is unpacked to: 32-bit indices, then each attribute
};

/// One mesh after another, `total` bytes. Errors: no stream of Draco's, or another number or type of anything than the document says; a
/// Weft without Draco.
Result<std::string> unpack_draco(std::span<const DracoMesh> meshes, std::uint64_t total);

inline constexpr std::uint64_t kMostIndices = std::uint64_t{6} * kMostVertices;   // a closed triangle mesh has two triangles a vertex

/// Elements in a buffer; none for an attribute that a primitive does not have.
struct Accessor {
  const char* bytes = nullptr;
  std::size_t step = 0;
  std::uint64_t count = 0, component = 0;
  bool is_normalized = false;

  template <class T>
  T at(std::size_t element) const {
    T value;
    std::memcpy(&value, bytes + element * step, sizeof value);
    return value;
  }
  std::uint32_t index(std::size_t element) const {
    return component == 5121 ? at<std::uint8_t>(element) : component == 5123 ? at<std::uint16_t>(element) : at<std::uint32_t>(element);
  }
  /// The k-th number of an element; a normalised integer is a fraction.
  double number(std::size_t element, std::size_t k) const;
  Vec3 vector(std::size_t element) const {
    return {static_cast<float>(number(element, 0)), static_cast<float>(number(element, 1)), static_cast<float>(number(element, 2))};
  }
};

enum class Components { indices, floats, numbers };   // numbers: floats, and integers of up to 16 bits

/// The accessor that `key` of `object` names, sparse or not. `type` is SCALAR, VEC2 to VEC4 or MAT4. None, and a fault, where it is not
/// what is wanted or reaches beyond its buffer.
Accessor accessor(GltfDocument& document, const json& object, const char* key, std::string_view type, Components components);

/// The same of three numbers each, as values of which the document keeps nothing.
std::vector<Vec3> vectors(GltfDocument& document, const json& object, const char* key);

/// The parent of each node, kNone at the top; a fault unless nodes are a forest.
std::vector<std::size_t> parents_of(GltfDocument& document, const json& nodes);

/// A set of vertices that a document's scene shows.
struct ShownVertices {
  std::size_t node = 0;               // the document's; kNone: none
  std::size_t skin = kNone;           // the document's
  const json* attributes = nullptr;   // of the primitive that they are of
  const json* targets = nullptr;      // of that, too: its morph targets
  const json* mesh = nullptr;         // that has this primitive
  std::size_t count = 0;
};

/// The morph targets of all that is shown. Those of a mesh that two nodes show are there twice: each node has its own weights.
class MorphReader {
 public:
  explicit MorphReader(GltfDocument& document) : document_(document) {}

  /// For one set of vertices after another. `place`: where their node has them, in the space of the mesh.
  void read(const ShownVertices& vertices, const Eigen::Affine3d& place);
  std::vector<Skin::Morph>& morphs() { return morphs_; }
  /// Those of a node of the document: the first, and how many.
  std::pair<std::size_t, std::size_t> of_node(std::size_t node) const;

 private:
  std::size_t first_of(const ShownVertices& vertices);

  GltfDocument& document_;
  std::vector<Skin::Morph> morphs_;
  std::map<std::pair<std::size_t, const json*>, std::size_t> first_;   // by node and mesh
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> of_node_;
  std::size_t vertices_ = 0;      // so far
  std::uint64_t moved_ = 0;       // these times morph targets
};

/// The skins and morph targets of all that is shown, as one: over its vertices, in their order. What has no skin goes with its node. A
/// fault where there is something wrong.
std::optional<Skin> read_skin(GltfDocument& document, std::span<const ShownVertices> shown);

/// Vertex colours and attributes of the file's own, over all vertices that are shown; 1 where there is none.
std::map<std::string, std::vector<Vec4>> read_attributes(GltfDocument& document, std::span<const ShownVertices> shown);

/// How a primitive's material takes texture coordinates: from TEXCOORD_`set`, and then scaled, turned and shifted
/// (KHR_texture_transform), as its base colour does, or the first of its other textures.
struct TextureCoordinates {
  std::uint64_t set = 0;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;
  auto operator<=>(const TextureCoordinates&) const = default;
  Vec2 at(Vec2 uv) const;
};

/// The materials of what is shown, and the textures and images of these.
class MaterialReader {
 public:
  explicit MaterialReader(GltfDocument& document) : document_(document) {}

  /// Of a primitive; kNone: none, or one that the document has not.
  std::uint32_t number_of(const json& primitive);
  TextureCoordinates coordinates_of(std::uint32_t material);
  /// Those that triangles have, renumbered in `material_of`; none, and a fault, where something about them is wrong. Where no triangle has
  /// one there is none.
  std::shared_ptr<const Materials> take(std::vector<std::uint32_t>& material_of, const std::filesystem::path& folder,
                                        BufferFiles buffer_files);
  /// Of those that were taken: with textures whose coordinates are not those of coordinates_of.
  std::size_t differing() const { return differing_; }

 private:
  /// The document's list. What is wrong with materials is no fault of the mesh: it is kept until they are taken.
  const json& all();
  void set_aside();

  GltfDocument& document_;
  std::string fault_;
  std::map<std::uint32_t, TextureCoordinates> known_;
  std::size_t differing_ = 0;
};

/// A GLB in memory, of what another reader has found.
struct GltfWriter {
  JsonTree nodes = json::array(), meshes = json::array(), materials = json::array();

  /// Values that lie densely, a multiple of four bytes; returns their accessor's number.
  std::size_t add_values(const std::string& values, std::size_t count, int component, const char* type);
  /// Below `parent`, or at the top with kNone; returns its number.
  std::size_t add_node(JsonTree node, std::size_t parent);
  std::string finish();

 private:
  void add(JsonTree& list, JsonTree entry);

  JsonTree accessors_ = json::array(), views_ = json::array(), tops_ = json::array();
  std::string bytes_;
};

}   // namespace weft::parts
