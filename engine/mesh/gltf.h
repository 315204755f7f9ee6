// A glTF's document and its buffers, how values are taken out of it, and the GLB that assimp decodes; internal to the sources that read
// glTF.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
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
  std::vector<std::string> buffers;   // each as long as the document says
  std::string fault;

  template <class... Parts>
  void say(const Parts&... parts) {
    if (fault.empty()) fault = fail(parts...).message;
  }

  const json& list(const json& object, const char* key);
  std::uint64_t natural(const json& object, const char* key, std::uint64_t missing);

  /// An entry of a list by an index found under `key`; nothing (and a fault) when it points past the end.
  const json* entry(const json& from, const json& object, const char* key);
};

/// Reads the document of a glTF or GLB, and its buffers: those in it and those in files below `folder`, or anywhere. Faults of buffers
/// stay in it.
/// Errors: not JSON, too large or nested too deeply, cut short, another version than 2.
Result<GltfDocument> open_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files);

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
};

enum class Components { indices, floats, numbers };   // numbers: floats, and integers of up to 16 bits

/// The accessor that `key` of `object` names. `type` is SCALAR, VEC2 to VEC4 or MAT4. None, and a fault, where it is not what is wanted or
/// reaches beyond its buffer.
Accessor accessor(GltfDocument& document, const json& object, const char* key, std::string_view type, Components components);

/// The same of three floats each, sparse or not, as values: none, and a fault, where it is not that.
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

/// A GLB in memory, as assimp is given it.
struct GltfWriter {
  JsonTree nodes = json::array(), meshes = json::array();

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

/// The name of a node whose mesh has a skin: joints alone place it, not the node (glTF 2.0, 3.7.3.3), though the node places its children.
inline constexpr const char* kSkinned = "skinned";

/// How many triangles a primitive of the GLB has before its own: they name its vertices one after the other.
inline std::size_t triangles_that_name(std::size_t vertices) { return (vertices + 2) / 3; }

/// What a document shows. `vertices` and `triangles` count what its nodes show, as often as they do.
struct GltfGeometry {
  std::string glb;
  std::size_t vertices = 0, triangles = 0, points = 0, lines = 0, skins = 0, morph_targets = 0;
  std::optional<Skin> skin;   // over these vertices, where there are skins or morph targets
  std::map<std::string, std::vector<Vec4>> attributes;
  std::string skin_fault, attribute_fault;   // why there is none
};

/// Checks a document, and writes the triangles of its scene anew. Errors: see read_gltf.
Result<GltfGeometry> strip_gltf(GltfDocument& document);

}   // namespace weft::parts
