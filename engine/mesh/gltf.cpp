// glTF, checked and stripped to the triangles of its scene before assimp sees it (engine/mesh/gltf_decode.cpp).
//
// assimp decodes well, but it trusts lengths and references, follows materials and animations that a cloth does not need, and has a
// mesh for every primitive, with all vertices of its accessors. So every range is checked here, and what passed is written into a
// new GLB in memory, where primitives that share their accessors are one. Skins and vertex colours (gltf_skin.cpp) and morph targets
// (gltf_morph.cpp) are read beside it. What is copied is bounded by kMostVertices, kMostIndices and kMostPieces, however often a document shows it.
#include "engine/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <map>
#include <utility>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

constexpr std::size_t kMostPieces = 100'000;                               // nodes, and sets of vertices: kilobytes each in assimp

enum Mode : std::uint64_t { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

/// The accessors that primitives share, or do not.
struct Vertices {
  Accessor position, normal, tangent, uv;
  const json *attributes, *targets;
};
using AccessorNumbers = std::pair<std::array<std::uint64_t, 6>, std::string>;   // the text: of morph targets

struct Primitive {
  std::size_t vertices;   // of its mesh's
  std::uint64_t mode, count;
  Accessor indices;

  std::uint32_t corner(std::size_t i) const { return indices.bytes ? indices.index(i) : static_cast<std::uint32_t>(i); }
  std::size_t triangle_count() const { return mode == triangles ? count / 3 : count - 2; }
  Triangle triangle(std::size_t i) const {
    if (mode == triangles) return {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)};
    if (mode == triangle_fan) return {corner(0), corner(i + 1), corner(i + 2)};
    return i % 2 == 0 ? Triangle{corner(i), corner(i + 1), corner(i + 2)} : Triangle{corner(i + 1), corner(i), corner(i + 2)};
  }
};

struct Part {
  const json* mesh = nullptr;          // the document's
  std::vector<Vertices> vertices;
  std::vector<Primitive> primitives;   // of triangles; each has one at least
  std::size_t points = 0, lines = 0, morph_targets = 0;
  std::size_t written = kNone;   // its number in the GLB
};

bool harmless(const std::string& extension) {
  return extension.starts_with("KHR_materials_") || extension == "KHR_texture_transform" || extension == "KHR_texture_basisu" ||
         extension == "KHR_lights_punctual" || extension == "EXT_texture_webp";
}

class GltfStripper {
 public:
  explicit GltfStripper(GltfDocument& document) : document_(document), root_(document.tree.root) {}

  Result<GltfGeometry> strip() {
    for (const json& name : document_.list(root_, "extensionsRequired"))
      if (!name.is_string() || !harmless(name.get<std::string>()))
        document_.say("it needs the extension ", name.dump(), ", which is not read");
    for (const json& mesh : document_.list(root_, "meshes"))
      if (document_.fault.empty()) read_part(mesh);
    if (document_.fault.empty()) show_scene();
    if (!document_.fault.empty()) return Error{document_.fault};
    // A file is read without what is wrong in these.
    out_.attributes = read_attributes(document_, shown_);
    out_.attribute_fault = std::exchange(document_.fault, {});
    if (out_.skins > 0 || out_.morph_targets > 0) out_.skin = read_skin(document_, shown_);
    out_.skin_fault = std::exchange(document_.fault, {});
    out_.glb = glb_.finish();
    return std::move(out_);
  }

 private:
  template <class... Parts>
  void say(const Parts&... parts) {
    document_.say(parts...);
  }

  void check_indices(const Accessor& indices, std::uint64_t vertices) {
    for (std::size_t i = 0; i < indices.count; ++i)
      if (indices.index(i) >= vertices) return say("index ", i, " is ", indices.index(i), ", past the last of ", vertices, " vertices");
  }

  void read_part(const json& mesh) {
    Part& part = parts_.emplace_back();
    part.mesh = &mesh;
    std::map<AccessorNumbers, std::size_t> known;   // by the numbers of their accessors
    for (const json& primitive : document_.list(mesh, "primitives")) {
      read_primitive(primitive, part, known);
      if (!document_.fault.empty()) return;
      part.morph_targets = std::max(part.morph_targets, document_.list(primitive, "targets").size());
    }
  }

  void read_primitive(const json& primitive, Part& part, std::map<AccessorNumbers, std::size_t>& known) {
    const std::uint64_t mode = document_.natural(primitive, "mode", triangles);
    if (mode > triangle_fan) return say("a primitive has the mode ", mode, "; the highest is ", std::uint64_t{triangle_fan});
    static const json none = json::object();
    const auto member = [&](const char* key) -> const json& { return has(primitive, key) ? primitive[key] : none; };
    const json &attributes = member("attributes"), &extensions = member("extensions");
    if (has(extensions, "KHR_draco_mesh_compression") && !has_plain_copy(attributes))
      return say("a primitive is compressed (KHR_draco_mesh_compression), which is not read");

    const Accessor position = accessor(document_, attributes, "POSITION", "VEC3", Components::floats);
    if (!document_.fault.empty()) return;
    Primitive read{part.vertices.size(), mode, position.count, {}};
    if (has(primitive, "indices")) {
      read.indices = accessor(document_, primitive, "indices", "SCALAR", Components::indices);
      read.count = read.indices.count;
      check_indices(read.indices, position.count);
    }
    index_total_ += read.count;
    if (index_total_ > kMostIndices) say("it has ", index_total_, " indices or more; at most ", kMostIndices, " are allowed");
    if (!document_.fault.empty() || read.count == 0) return;
    if (mode == points)
      part.points += read.count;
    else if (mode < triangles)
      part.lines += mode == lines ? read.count / 2 : mode == line_loop ? read.count : read.count - 1;
    if (mode < triangles) return;
    if (mode == triangles && read.count % 3 != 0) return say("a primitive has ", read.count, " corners, which is no multiple of 3");
    if (read.count < 3) return say("a strip or fan has ", read.count, " corners; 3 are needed");

    const json& targets = document_.list(primitive, "targets");
    AccessorNumbers all{{}, targets.empty() ? std::string() : targets.dump()};
    std::array<std::uint64_t, 6>& numbers = all.first;
    Vertices vertices{position, {}, {}, {}, &attributes, &targets};
    std::size_t k = 0;
    numbers[k++] = document_.natural(attributes, "POSITION", kNone);
    for (const auto& [name, type, into] : {std::tuple{"NORMAL", "VEC3", &vertices.normal}, {"TANGENT", "VEC4", &vertices.tangent},
                                           {"TEXCOORD_0", "VEC2", &vertices.uv}}) {
      numbers[k++] = document_.natural(attributes, name, kNone);
      if (!attributes.contains(name)) continue;
      *into = accessor(document_, attributes, name, type, Components::floats);
      if (into->count != position.count) say("a primitive has ", position.count, " positions but ", into->count, " of ", name);
    }
    for (const char* name : {"JOINTS_0", "WEIGHTS_0"})
      numbers[k++] = attributes.contains(name) && attributes[name].is_number_unsigned() ? attributes[name].get<std::uint64_t>() : kNone;
    const auto [which, added] = known.try_emplace(std::move(all), part.vertices.size());
    read.vertices = which->second;
    part.primitives.push_back(read);
    if (added) part.vertices.push_back(vertices);
  }

  /// Whether an attribute that is compressed as well can be read without that, as glTF allows.
  bool has_plain_copy(const json& attributes) {
    const json* accessor = document_.entry(document_.list(root_, "accessors"), attributes, "POSITION");
    return accessor && has(*accessor, "bufferView");
  }

  /// A node's place below its parent, as the document has it.
  JsonTree place(const json& node, std::size_t n) {
    JsonTree tree = json::object();
    json& copy = tree.root;
    for (const auto& [key, length] :
         {std::pair{"matrix", 16u}, std::pair{"translation", 3u}, std::pair{"rotation", 4u}, std::pair{"scale", 3u}}) {
      const json& numbers = document_.list(node, key);
      if (numbers.empty()) continue;
      if (numbers.size() != length || !std::ranges::all_of(numbers, [](const json& x) { return x.is_number(); }))
        say("node ", n, ": \"", key, "\" is not ", length, " numbers");
      else
        put(tree, key, numbers);
    }
    if (copy.contains("rotation")) {   // assimp takes the quaternion to have length 1
      json& rotation = copy["rotation"];
      auto turn = rotation.get<std::array<double, 4>>();
      Eigen::Map<Eigen::Vector4d>(turn.data()).stableNormalize();
      for (std::size_t k = 0; k < turn.size(); ++k) rotation[k] = turn[k];
    }
    return tree;
  }

  std::vector<std::size_t> roots(const json& nodes, const std::vector<std::size_t>& parent) {
    std::vector<std::size_t> shown;
    const json& scenes = document_.list(root_, "scenes");
    if (scenes.empty()) {
      for (std::size_t n = 0; n < parent.size(); ++n)
        if (parent[n] == kNone) shown.push_back(n);
      return shown;
    }
    const json* scene = root_.contains("scene") ? document_.entry(scenes, root_, "scene") : &scenes[0];
    std::vector<std::uint8_t> is_shown(nodes.size(), 0);
    for (const json& node : document_.list(scene ? *scene : scenes[0], "nodes")) {
      const std::uint64_t n = node.is_number_unsigned() ? node.get<std::uint64_t>() : kNone;
      if (n >= nodes.size())
        say("its scene has the node ", node.dump().substr(0, 40), " of ", nodes.size());
      else if (is_shown[n]++)
        say("its scene has the node ", n, " twice");
      else
        shown.push_back(n);
    }
    return shown;
  }

  void show_scene() {
    struct Visit {
      std::size_t node, parent;   // of the document; in the GLB
    };
    const json& nodes = document_.list(root_, "nodes");
    const std::vector<std::size_t> tops = roots(nodes, parents_of(document_, nodes));
    for (std::size_t n = 0; n < nodes.size(); ++n) place(nodes[n], n);   // faults of nodes that no scene shows, too
    // A file of meshes without nodes is a library in glTF's words; every mesh is shown once.
    if (nodes.empty() && document_.list(root_, "scenes").empty())
      for (Part& part : parts_) show(part, glb_.add_node(JsonTree(json::object()), kNone), kNone, kNone);
    std::vector<Visit> stack;
    for (std::size_t k = tops.size(); k-- > 0;) stack.push_back({tops[k], kNone});
    while (!stack.empty() && document_.fault.empty()) {
      const auto [n, parent] = stack.back();
      stack.pop_back();
      const json& node = nodes[n];
      const std::size_t copy = glb_.add_node(place(node, n), parent);
      if (copy >= kMostPieces) return say("its scene has more than ", kMostPieces, " nodes");
      if (has(node, "mesh")) {
        const std::uint64_t mesh = document_.natural(node, "mesh", 0);
        if (mesh >= parts_.size()) return say("node ", n, ": \"mesh\" points to ", mesh, " of ", parts_.size());
        std::size_t skin = kNone;
        if (has(node, "skin") && !parts_[mesh].primitives.empty()) {
          ++out_.skins;
          skin = node["skin"].is_number_unsigned() ? node["skin"].get<std::size_t>() : kNone - 1;
          glb_.nodes.root[copy]["name"] = kSkinned;
        }
        show(parts_[mesh], copy, n, skin);
      }
      const json& children = document_.list(node, "children");
      for (std::size_t k = children.size(); k-- > 0;) stack.push_back({children[k].get<std::size_t>(), copy});   // the first is taken next
    }
    if (out_.triangles == 0) say("it has no triangle in its scene");
  }

  /// `node` is that of the GLB, `from` and `skin` are the document's.
  void show(Part& part, std::size_t node, std::size_t from, std::size_t skin) {
    out_.points += part.points;
    out_.lines += part.lines;
    out_.morph_targets += part.morph_targets;
    if (part.primitives.empty()) return;
    for (const Vertices& vertices : part.vertices) {
      out_.vertices += vertices.position.count;
      shown_.push_back({from, skin, vertices.attributes, vertices.targets, part.mesh, vertices.position.count});
    }
    if (out_.vertices > kMostVertices) return say("it has more than ", kMostVertices, " vertices");
    for (const Primitive& primitive : part.primitives) out_.triangles += primitive.triangle_count();
    if (out_.triangles > kMostIndices / 3) return say("it has more than ", kMostIndices / 3, " triangles");
    if (part.written == kNone) write(part);
    glb_.nodes.root[node]["mesh"] = part.written;
  }

  /// A primitive for each set of vertices, with the triangles of all that share it.
  void write(Part& part) {
    sets_ += part.vertices.size();
    if (sets_ > kMostPieces) return say("its primitives have more than ", kMostPieces, " sets of accessors");
    std::vector<std::vector<std::uint32_t>> corners;
    for (const Vertices& vertices : part.vertices) {
      // A reader may keep only vertices that corners name, in that order; so triangles come first that name all (see decode_gltf).
      std::vector<std::uint32_t>& list = corners.emplace_back(3 * triangles_that_name(vertices.position.count));
      for (std::size_t i = 0; i < list.size(); ++i) list[i] = static_cast<std::uint32_t>(std::min(i, vertices.position.count - 1));
    }
    for (const Primitive& primitive : part.primitives)
      for (std::size_t i = 0; i < primitive.triangle_count(); ++i) {
        const Triangle triangle = primitive.triangle(i);
        corners[primitive.vertices].insert(corners[primitive.vertices].end(), triangle.begin(), triangle.end());
      }
    JsonTree primitives = json::array();
    for (std::size_t k = 0; k < part.vertices.size(); ++k) {
      const Vertices& vertices = part.vertices[k];
      JsonTree tree = object_of("POSITION", add<Vec3>(vertices.position, "VEC3"));
      json& attributes = tree.root;
      if (vertices.normal.bytes) attributes["NORMAL"] = add<Vec3>(vertices.normal, "VEC3");
      if (vertices.tangent.bytes) attributes["TANGENT"] = add<Vec4>(vertices.tangent, "VEC4");
      if (vertices.uv.bytes) {
        // assimp turns the second number of a texture coordinate over, which rounds; so both travel as first ones.
        attributes["TEXCOORD_0"] = add<Vec2>(vertices.uv, "VEC2", [](Vec2 uv) { return Vec2{uv.x, 0}; });
        attributes["TEXCOORD_1"] = add<Vec2>(vertices.uv, "VEC2", [](Vec2 uv) { return Vec2{uv.y, 0}; });
      }
      const std::string bytes(reinterpret_cast<const char*>(corners[k].data()), corners[k].size() * sizeof(std::uint32_t));
      const std::size_t indices = glb_.add_values(bytes, corners[k].size(), 5125, "SCALAR");
      JsonTree primitive = object_of("attributes", std::move(tree), "indices", indices);
      primitives.root.push_back(std::move(primitive.root));
    }
    part.written = glb_.meshes.root.size();
    JsonTree mesh = object_of("primitives", std::move(primitives));
    glb_.meshes.root.push_back(std::move(mesh.root));
  }

  template <class T, class Change = std::identity>
  std::size_t add(const Accessor& from, const char* type, Change change = {}) {
    std::string bytes(from.count * sizeof(T), '\0');
    for (std::size_t v = 0; v < from.count; ++v) {
      const T value = change(from.at<T>(v));
      std::memcpy(bytes.data() + v * sizeof(T), &value, sizeof value);
    }
    return glb_.add_values(bytes, from.count, 5126, type);
  }

  GltfDocument& document_;
  const json& root_;
  GltfGeometry out_;
  GltfWriter glb_;
  std::vector<Part> parts_;
  std::vector<ShownVertices> shown_;
  std::uint64_t index_total_ = 0;
  std::size_t sets_ = 0;
};

}   // namespace

Result<GltfGeometry> strip_gltf(GltfDocument& document) { return GltfStripper(document).strip(); }

}   // namespace weft::parts
