// glTF: the triangles of its scene. Materials, animations and cameras stay outside, and so do skins and morph targets, which are
// counted. Every range is checked before anything is read from it, and what is copied is bounded by kMostVertices and kMostIndices,
// however often a document shows it.
#include "engine/mesh/gltf.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <map>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

static_assert(std::endian::native == std::endian::little, "accessors are read as they lie in memory");

constexpr std::size_t kDeepestNodes = 256;                                 // a cloth's file has one or two levels
constexpr std::uint64_t kMostIndices = std::uint64_t{6} * kMostVertices;   // a closed triangle mesh has two triangles a vertex

/// Elements in a buffer; none for an attribute that a primitive does not have.
struct Accessor {
  const char* bytes = nullptr;
  std::size_t step = 0;
  std::uint64_t count = 0, component = 0;

  template <class T>
  T at(std::size_t element) const {
    T value;
    std::memcpy(&value, bytes + element * step, sizeof value);
    return value;
  }
  std::uint32_t index(std::size_t element) const {
    return component == 5121 ? at<std::uint8_t>(element) : component == 5123 ? at<std::uint16_t>(element) : at<std::uint32_t>(element);
  }
};

enum Mode : std::uint64_t { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

/// The accessors that primitives share, or do not.
struct Vertices {
  Accessor position, normal, tangent, uv;
};

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
  std::vector<Vertices> vertices;
  std::vector<Primitive> primitives;   // of triangles; each has one at least
  std::size_t points = 0, lines = 0, morph_targets = 0;
};

bool harmless(const std::string& extension) {
  return extension.starts_with("KHR_materials_") || extension == "KHR_texture_transform" || extension == "KHR_texture_basisu" ||
         extension == "KHR_lights_punctual" || extension == "EXT_texture_webp";
}

bool has(const json& object, const char* key) { return object.is_object() && object.contains(key); }

class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document) : document_(document), root_(document.root) {}

  Result<Harvest> read() {
    for (const json& name : document_.list(root_, "extensionsRequired"))
      if (!name.is_string() || !harmless(name.get<std::string>()))
        document_.say("it needs the extension ", name.dump(), ", which is not read");
    for (const json& mesh : document_.list(root_, "meshes"))
      if (document_.fault.empty()) read_part(mesh);
    if (document_.fault.empty()) show_scene();
    if (!document_.fault.empty()) return Error{document_.fault};
    out_.source_vertices = out_.render.positions.size();
    return std::move(out_);
  }

 private:
  template <class... Parts>
  void say(const Parts&... parts) {
    document_.say(parts...);
  }

  /// `width` is 1 for indices, else the numbers of a vector.
  Accessor accessor(const json& object, const char* key, std::size_t width) {
    const json* accessor = document_.entry(document_.list(root_, "accessors"), object, key);
    if (!accessor) return {};
    if (has(*accessor, "sparse")) say("the accessor of \"", key, "\" is sparse, which is not read");
    const bool indices = width == 1;
    const std::uint64_t component = document_.natural(*accessor, "componentType", 0);
    const std::size_t size = width * (component == 5121 ? 1 : component == 5123 ? 2 : 4);
    const bool right_component = indices ? component == 5121 || component == 5123 || component == 5125 : component == 5126;
    if (!right_component)
      say("the accessor of \"", key, "\" has the component type ", component, "; ",
          indices ? "5121, 5123 and 5125 (integers)" : "only 5126 (float)", " can be read");
    const std::string type = indices ? "SCALAR" : "VEC" + std::to_string(width);
    if (!accessor->is_object() || accessor->value("type", json()) != type) say("the accessor of \"", key, "\" is not a ", type);
    if (!has(*accessor, "bufferView")) say("the accessor of \"", key, "\" has no \"bufferView\", and so nothing that can be read");
    const json* view = document_.entry(document_.list(root_, "bufferViews"), *accessor, "bufferView");
    if (!view) return {};
    const std::uint64_t buffer = document_.natural(*view, "buffer", 0), view_offset = document_.natural(*view, "byteOffset", 0),
                        view_size = document_.natural(*view, "byteLength", 0);
    const std::uint64_t offset = document_.natural(*accessor, "byteOffset", 0), count = document_.natural(*accessor, "count", 0);
    const std::uint64_t stride = document_.natural(*view, "byteStride", 0), step = stride ? stride : size;
    if (buffer >= document_.buffers.size() || view_offset + view_size > document_.buffers[buffer].size())
      say("the buffer view of \"", key, "\" reaches past the end of its buffer: ", view_offset, " + ", view_size, " bytes");
    if (step < size || step > 252) say("the buffer view of \"", key, "\" has a stride of ", step, " bytes, outside ", size, " ... 252");
    if (count > kMostIndices)
      say("the accessor of \"", key, "\" has ", count, " elements; at most ", kMostIndices, " are allowed");
    else if (count > 0 && offset + (count - 1) * step + size > view_size)
      say("the accessor of \"", key, "\" reaches past the end of its buffer view: ", count, " elements in ", view_size, " bytes");
    if (!document_.fault.empty()) return {};
    return {document_.buffers[buffer].data() + view_offset + offset, step, count, component};
  }

  void check_indices(const Accessor& indices, std::uint64_t vertices) {
    for (std::size_t i = 0; i < indices.count; ++i)
      if (indices.index(i) >= vertices) return say("index ", i, " is ", indices.index(i), ", past the last of ", vertices, " vertices");
  }

  void read_part(const json& mesh) {
    Part& part = parts_.emplace_back();
    std::map<std::array<std::uint64_t, 4>, std::size_t> known;   // by the numbers of their accessors
    for (const json& primitive : document_.list(mesh, "primitives")) {
      read_primitive(primitive, part, known);
      if (!document_.fault.empty()) return;
      part.morph_targets = std::max(part.morph_targets, document_.list(primitive, "targets").size());
    }
  }

  void read_primitive(const json& primitive, Part& part, std::map<std::array<std::uint64_t, 4>, std::size_t>& known) {
    const std::uint64_t mode = document_.natural(primitive, "mode", triangles);
    if (mode > triangle_fan) return say("a primitive has the mode ", mode, "; the highest is ", std::uint64_t{triangle_fan});
    const json attributes = primitive.is_object() ? primitive.value("attributes", json::object()) : json::object();
    const json extensions = primitive.is_object() ? primitive.value("extensions", json::object()) : json::object();
    if (has(extensions, "KHR_draco_mesh_compression") && !has_plain_copy(attributes))
      return say("a primitive is compressed (KHR_draco_mesh_compression), which is not read");

    const Accessor position = accessor(attributes, "POSITION", 3);
    if (!document_.fault.empty()) return;
    Primitive read{part.vertices.size(), mode, position.count, {}};
    if (has(primitive, "indices")) {
      read.indices = accessor(primitive, "indices", 1);
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

    std::array<std::uint64_t, 4> numbers{};
    Vertices vertices{position, {}, {}, {}};
    std::size_t k = 0;
    numbers[k++] = document_.natural(attributes, "POSITION", kNone);
    for (const auto& [name, width, into] : {std::tuple{"NORMAL", std::size_t{3}, &vertices.normal}, {"TANGENT", 4, &vertices.tangent},
                                            {"TEXCOORD_0", 2, &vertices.uv}}) {
      numbers[k++] = document_.natural(attributes, name, kNone);
      if (!attributes.contains(name)) continue;
      *into = accessor(attributes, name, width);
      if (into->count != position.count) say("a primitive has ", position.count, " positions but ", into->count, " of ", name);
    }
    const auto [which, added] = known.try_emplace(numbers, part.vertices.size());
    read.vertices = which->second;
    part.primitives.push_back(read);
    if (added) part.vertices.push_back(vertices);
  }

  /// Whether an attribute that is compressed as well can be read without that, as glTF allows.
  bool has_plain_copy(const json& attributes) {
    const json* accessor = document_.entry(document_.list(root_, "accessors"), attributes, "POSITION");
    return accessor && has(*accessor, "bufferView");
  }

  Eigen::Affine3d local(const json& node, std::size_t n) {
    const auto numbers = [&](const char* key, std::size_t length) {
      std::vector<double> read;
      for (const json& number : document_.list(node, key)) {
        if (!number.is_number() || read.size() == length) {
          say("node ", n, ": \"", key, "\" is not ", length, " numbers");
          break;
        }
        read.push_back(number.get<double>());
      }
      if (!read.empty() && read.size() != length) say("node ", n, ": \"", key, "\" is not ", length, " numbers");
      return document_.fault.empty() ? read : std::vector<double>();
    };
    Eigen::Affine3d result = Eigen::Affine3d::Identity();
    if (const auto m = numbers("matrix", 16); !m.empty()) {
      result.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix4d>(m.data()).topRows<3>();   // column by column, in both
      return result;
    }
    if (const auto t = numbers("translation", 3); !t.empty()) result.translate(Eigen::Vector3d(t[0], t[1], t[2]));
    if (const auto q = numbers("rotation", 4); !q.empty()) result.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
    if (const auto s = numbers("scale", 3); !s.empty()) result.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    return result;
  }

  /// The parent of each node, kNone at the top; a fault unless nodes are a forest.
  std::vector<std::size_t> parents(const json& nodes) {
    std::vector<std::size_t> parent(nodes.size(), kNone);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      for (const json& child : document_.list(nodes[n], "children")) {
        const std::uint64_t c = child.is_number_unsigned() ? child.get<std::uint64_t>() : kNone;
        if (c < nodes.size() && parent[c] == kNone)
          parent[c] = n;
        else
          say("node ", n, " has the child ", child.dump().substr(0, 40), ", which does not exist or has another parent");
      }
    for (std::size_t n = 0; n < parent.size(); ++n) {
      std::size_t steps = 0;
      for (std::size_t up = n; up != kNone && steps <= kDeepestNodes; up = parent[up]) ++steps;
      if (steps > kDeepestNodes) say("node ", n, " lies below itself or deeper than ", kDeepestNodes, " levels");
    }
    return parent;
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
      std::size_t node;
      Eigen::Affine3d parent;
    };
    const json& nodes = document_.list(root_, "nodes");
    const std::vector<std::size_t> tops = roots(nodes, parents(nodes));
    for (std::size_t n = 0; n < nodes.size(); ++n) local(nodes[n], n);   // faults of nodes that no scene shows, too
    // A file of meshes without nodes is a library in glTF's words; every mesh is shown once.
    if (nodes.empty() && document_.list(root_, "scenes").empty())
      for (const Part& part : parts_) show(part, Eigen::Affine3d::Identity());
    std::vector<Visit> stack;
    for (std::size_t k = tops.size(); k-- > 0;) stack.push_back({tops[k], Eigen::Affine3d::Identity()});
    while (!stack.empty() && document_.fault.empty()) {
      const auto [n, parent] = stack.back();
      stack.pop_back();
      const json& node = nodes[n];
      const Eigen::Affine3d place = parent * local(node, n);
      if (has(node, "mesh")) {
        const std::uint64_t mesh = document_.natural(node, "mesh", 0);
        if (mesh >= parts_.size()) return say("node ", n, ": \"mesh\" points to ", mesh, " of ", parts_.size());
        const bool skinned = has(node, "skin") && !parts_[mesh].primitives.empty();
        out_.skins += skinned;
        show(parts_[mesh], skinned ? Eigen::Affine3d::Identity() : place);   // joints alone place a skinned mesh (glTF 2.0, 3.7.3.3)
      }
      const json& children = document_.list(node, "children");
      for (std::size_t k = children.size(); k-- > 0;) stack.push_back({children[k].get<std::size_t>(), place});   // the first is taken next
    }
    if (out_.render.triangles.empty()) say("it has no triangle in its scene");
  }

  void show(const Part& part, const Eigen::Affine3d& place) {
    out_.points += part.points;
    out_.lines += part.lines;
    out_.morph_targets += part.morph_targets;
    std::vector<std::size_t> first;   // render vertex of each set of vertices
    for (const Vertices& vertices : part.vertices) {
      first.push_back(out_.render.positions.size());
      if (first.back() + vertices.position.count > kMostVertices) return say("it has more than ", kMostVertices, " vertices");
      append(vertices, place);
    }
    // A mirrored triangle is wound backwards; turned, it faces the way its transformed normals do.
    const bool mirrored = place.linear().determinant() < 0;
    for (const Primitive& primitive : part.primitives) {
      if (out_.render.triangles.size() + primitive.triangle_count() > kMostIndices / 3)
        return say("it has more than ", kMostIndices / 3, " triangles");
      for (std::size_t i = 0; i < primitive.triangle_count(); ++i) {
        Triangle triangle = primitive.triangle(i);
        if (mirrored) std::swap(triangle[0], triangle[2]);
        for (std::uint32_t& v : triangle) v += static_cast<std::uint32_t>(first[primitive.vertices]);
        out_.render.triangles.push_back(triangle);
      }
    }
  }

  void append(const Vertices& vertices, const Eigen::Affine3d& place) {
    const Eigen::Matrix3d linear = place.linear();
    const double side = linear.determinant() < 0 ? -1 : 1;
    // The cofactors are the inverse transpose times the determinant, and exist for a flattening transform too.
    Eigen::Matrix3d cofactors;
    cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)), linear.col(0).cross(linear.col(1));
    const float missing = std::numeric_limits<float>::quiet_NaN();
    RenderMesh& render = out_.render;
    for (std::size_t v = 0; v < vertices.position.count; ++v) {
      render.positions.push_back(narrow(place * wide(vertices.position.at<Vec3>(v))));
      Vec3& normal = render.normals.emplace_back();
      Vec4& tangent = render.tangents.emplace_back();
      Vec2& uv = render.uvs.emplace_back(Vec2{missing, missing});
      if (vertices.uv.bytes) {
        uv = vertices.uv.at<Vec2>(v);
        out_.bad_uvs += !finite(uv);
      }
      if (!vertices.normal.bytes) continue;   // tangents without normals do not count (glTF 2.0, 3.7.2.1)
      normal = narrow((side * (cofactors * wide(vertices.normal.at<Vec3>(v)))).normalized());
      out_.bad_normals += !finite(normal) || normal == Vec3{};
      if (!vertices.tangent.bytes) continue;
      const Vec4 given = vertices.tangent.at<Vec4>(v);
      const Vec3 along = narrow((linear * wide(Vec3{given.x, given.y, given.z})).normalized());
      tangent = {along.x, along.y, along.z, static_cast<float>(given.w < 0 ? -side : side)};
    }
  }

  GltfDocument& document_;
  const json& root_;
  Harvest out_;
  std::vector<Part> parts_;
  std::uint64_t index_total_ = 0;
};

}   // namespace

Result<Harvest> read_gltf(const std::string& content, const std::filesystem::path& folder) {
  Result<GltfDocument> document = open_gltf(content, folder);
  if (!document) return document.take_error();
  return GltfReader(*document).read();
}

}   // namespace weft::parts
