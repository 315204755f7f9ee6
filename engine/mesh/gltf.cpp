// The triangles of a glTF's scene.
//
// A file may be anyone's: every range and reference is checked before anything is taken, and what is held is bounded by kMostVertices,
// kMostIndices and kMostPieces, however often a document shows it. Primitives of a mesh that share their accessors share the vertices.
// Skins and vertex colours (gltf_skin.cpp), morph targets (gltf_morph.cpp) and materials (gltf_material.cpp) are read beside it.
#include "engine/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

constexpr std::size_t kMostPieces = 100'000;   // nodes, and sets of vertices

enum Mode : std::uint64_t { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

/// The accessors that primitives share, or do not.
struct Vertices {
  Accessor position, normal, tangent, uv;
  TextureCoordinates coordinates;
  const json *attributes, *targets;
};
using AccessorNumbers = std::tuple<std::array<std::uint64_t, 6>, TextureCoordinates, std::string>;   // the text: of morph targets

struct Primitive {
  std::size_t vertices;     // of its mesh's
  std::uint32_t material;   // the document's
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
  std::vector<Primitive> primitives;   // of triangles; each has one at least; in the order of their vertices
  std::size_t points = 0, lines = 0, morph_targets = 0;
};

bool harmless(const std::string& extension) {
  return extension.starts_with("KHR_materials_") || extension == "KHR_texture_transform" || extension == "KHR_texture_basisu" ||
         extension == "KHR_lights_punctual" || extension == "EXT_texture_webp" || extension == "KHR_mesh_quantization" ||
         extension == "EXT_meshopt_compression" || extension == "KHR_draco_mesh_compression";
}

class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document) : document_(document), root_(document.tree.root), materials_(document) {}

  Result<Harvest> read(const std::filesystem::path& folder, BufferFiles buffer_files) {
    for (const json& name : document_.list(root_, "extensionsRequired"))
      if (!name.is_string() || !harmless(name.get<std::string>()))
        document_.say("it needs the extension ", name.dump(), ", which is not read");
    for (const json& mesh : document_.list(root_, "meshes"))
      if (document_.fault.empty()) read_part(mesh);
    if (document_.fault.empty()) show_scene();
    if (!document_.fault.empty()) return Error{document_.fault};
    out_.source_vertices = out_.render.positions.size();
    // A file is read without what is wrong in these.
    out_.attributes = read_attributes(document_, shown_);
    out_.attribute_fault = std::exchange(document_.fault, {});
    if (out_.skins > 0 || out_.morph_targets > 0) out_.skin = read_skin(document_, shown_);
    out_.skin_fault = std::exchange(document_.fault, {});
    out_.render.materials = materials_.take(out_.render.material_of, folder, buffer_files);
    out_.material_fault = std::exchange(document_.fault, {});
    out_.other_coordinates = materials_.differing();
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
    std::ranges::stable_sort(part.primitives, {}, &Primitive::vertices);
  }

  void read_primitive(const json& primitive, Part& part, std::map<AccessorNumbers, std::size_t>& known) {
    const std::uint64_t mode = document_.natural(primitive, "mode", triangles);
    if (mode > triangle_fan) return say("a primitive has the mode ", mode, "; the highest is ", std::uint64_t{triangle_fan});
    const json& attributes = member(primitive, "attributes");
    const Accessor position = accessor(document_, attributes, "POSITION", "VEC3", Components::numbers);
    if (!document_.fault.empty()) return;
    Primitive read{part.vertices.size(), materials_.number_of(primitive), mode, position.count, {}};
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
    const TextureCoordinates coordinates = materials_.coordinates_of(read.material);
    const std::string uv = "TEXCOORD_" + std::to_string(coordinates.set);
    AccessorNumbers all{{}, coordinates, targets.empty() ? std::string() : targets.dump()};
    auto& numbers = std::get<0>(all);
    Vertices vertices{position, {}, {}, {}, coordinates, &attributes, &targets};
    std::size_t k = 0;
    numbers[k++] = document_.natural(attributes, "POSITION", kNone);
    for (const auto& [name, type, into] : {std::tuple{"NORMAL", "VEC3", &vertices.normal}, {"TANGENT", "VEC4", &vertices.tangent},
                                           {uv.c_str(), "VEC2", &vertices.uv}}) {
      numbers[k++] = document_.natural(attributes, name, kNone);
      if (!attributes.contains(name)) continue;
      *into = accessor(document_, attributes, name, type, Components::numbers);
      if (into->count != position.count) say("a primitive has ", position.count, " positions but ", into->count, " of ", name);
    }
    for (const char* name : {"JOINTS_0", "WEIGHTS_0"})
      numbers[k++] = attributes.contains(name) && attributes[name].is_number_unsigned() ? attributes[name].get<std::uint64_t>() : kNone;
    const auto [which, added] = known.try_emplace(std::move(all), part.vertices.size());
    read.vertices = which->second;
    part.primitives.push_back(read);
    if (added) part.vertices.push_back(vertices);
  }

  /// Where a node lies below its parent.
  Eigen::Affine3d place(const json& node, std::size_t n) {
    const auto numbers = [&]<std::size_t N>(const char* key, std::array<double, N> values) {
      const json& list = document_.list(node, key);
      if (list.empty()) return values;
      if (list.size() != N || !std::ranges::all_of(list, [](const json& x) { return x.is_number(); }))
        say("node ", n, ": \"", key, "\" is not ", N, " numbers");
      else
        for (std::size_t k = 0; k < N; ++k) values[k] = list[k].template get<double>();
      return values;
    };
    Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
    const auto columns = numbers("matrix", std::array<double, 16>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    for (Eigen::Index k = 0; k < 12; ++k) matrix.matrix()(k % 3, k / 3) = columns[static_cast<std::size_t>(k / 3 * 4 + k % 3)];
    const auto shift = numbers("translation", std::array<double, 3>{}), size = numbers("scale", std::array<double, 3>{1, 1, 1});
    const auto turn = numbers("rotation", std::array<double, 4>{0, 0, 0, 1});
    Eigen::Vector4d q(turn[0], turn[1], turn[2], turn[3]);   // of any length
    q.stableNormalize();
    const auto rotation = q.norm() > 0.5 ? Eigen::Quaterniond(q) : Eigen::Quaterniond::Identity();
    return matrix * Eigen::Translation3d(shift[0], shift[1], shift[2]) * rotation * Eigen::Scaling(size[0], size[1], size[2]);
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
    const Eigen::Affine3d here = Eigen::Affine3d::Identity();
    const json& nodes = document_.list(root_, "nodes");
    const std::vector<std::size_t> tops = roots(nodes, parents_of(document_, nodes));
    std::vector<Eigen::Affine3d> places;
    for (std::size_t n = 0; n < nodes.size(); ++n) places.push_back(place(nodes[n], n));   // faults of nodes that no scene shows, too
    // A file of meshes without nodes is a library in glTF's words; every mesh is shown once.
    if (nodes.empty() && document_.list(root_, "scenes").empty())
      for (const Part& part : parts_) show(part, here, kNone, kNone);
    std::vector<Visit> stack;
    for (std::size_t k = tops.size(); k-- > 0;) stack.push_back({tops[k], here});
    while (!stack.empty() && document_.fault.empty()) {
      const auto [n, parent] = stack.back();
      stack.pop_back();
      const json& node = nodes[n];
      if (++shown_nodes_ > kMostPieces) return say("its scene has more than ", kMostPieces, " nodes");
      const Eigen::Affine3d own = parent * places[n];
      if (has(node, "mesh")) {
        const std::uint64_t mesh = document_.natural(node, "mesh", 0);
        if (mesh >= parts_.size()) return say("node ", n, ": \"mesh\" points to ", mesh, " of ", parts_.size());
        std::size_t skin = kNone;
        if (has(node, "skin") && !parts_[mesh].primitives.empty()) {
          ++out_.skins;
          skin = node["skin"].is_number_unsigned() ? node["skin"].get<std::size_t>() : kNone - 1;
        }
        show(parts_[mesh], skin == kNone ? own : here, n, skin);   // joints alone place what has a skin (glTF 2.0, 3.7.3.3)
      }
      const json& children = document_.list(node, "children");
      for (std::size_t k = children.size(); k-- > 0;) stack.push_back({children[k].get<std::size_t>(), own});   // the first is taken next
    }
    if (out_.render.triangles.empty()) say("it has no triangle in its scene");
  }

  /// `from` and `skin` are the document's.
  void show(const Part& part, const Eigen::Affine3d& place, std::size_t from, std::size_t skin) {
    out_.points += part.points;
    out_.lines += part.lines;
    out_.morph_targets += part.morph_targets;
    std::size_t vertices = out_.render.positions.size(), triangles = out_.render.triangles.size();
    for (const Vertices& some : part.vertices) vertices += some.position.count;
    for (const Primitive& primitive : part.primitives) triangles += primitive.triangle_count();
    sets_ += part.vertices.size();
    if (vertices > kMostVertices) return say("it has more than ", kMostVertices, " vertices");
    if (triangles > kMostIndices / 3) return say("it has more than ", kMostIndices / 3, " triangles");
    if (sets_ > kMostPieces) return say("its primitives have more than ", kMostPieces, " sets of accessors");
    const bool turned = place.linear().determinant() < 0;   // a mirrored triangle is wound backwards
    auto primitive = part.primitives.begin();
    for (std::size_t k = 0; k < part.vertices.size(); ++k) {
      const Vertices& some = part.vertices[k];
      const auto base = static_cast<std::uint32_t>(out_.render.positions.size());
      append(some, place);
      shown_.push_back({from, skin, some.attributes, some.targets, part.mesh, some.position.count});
      for (; primitive != part.primitives.end() && primitive->vertices == k; ++primitive)
        for (std::size_t i = 0; i < primitive->triangle_count(); ++i) {
          const auto [a, b, c] = primitive->triangle(i);
          out_.render.triangles.push_back(turned ? Triangle{base + c, base + b, base + a} : Triangle{base + a, base + b, base + c});
          out_.render.material_of.push_back(primitive->material);
        }
    }
  }

  void append(const Vertices& vertices, const Eigen::Affine3d& place) {
    RenderMesh& render = out_.render;
    // A mirrored mesh is turned inside out with its winding, and its normals with it. The cofactors are the inverse transpose times the
    // determinant, and exist for a flattening transform too.
    const Eigen::Matrix3d linear = place.linear();
    const double side = linear.determinant() < 0 ? -1 : 1;
    Eigen::Matrix3d cofactors;
    cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)), linear.col(0).cross(linear.col(1));
    const bool is_moved = place.matrix() != Eigen::Affine3d::Identity().matrix();   // else bits stay
    const auto vector = [](const Accessor& from, std::size_t v) {
      return Eigen::Vector3d(from.number(v, 0), from.number(v, 1), from.number(v, 2));
    };
    const float missing = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t v = 0; v < vertices.position.count; ++v) {
      const Eigen::Vector3d at = vector(vertices.position, v);
      render.positions.push_back(narrow(is_moved ? Eigen::Vector3d(place * at) : at));
      Vec3& normal = render.normals.emplace_back();
      Vec4& tangent = render.tangents.emplace_back();
      Vec2& uv = render.uvs.emplace_back(Vec2{missing, missing});
      if (vertices.uv.bytes) {
        uv = vertices.coordinates.at({static_cast<float>(vertices.uv.number(v, 0)), static_cast<float>(vertices.uv.number(v, 1))});
        out_.bad_uvs += !finite(uv);
      }
      if (!vertices.normal.bytes) continue;   // tangents without normals do not count (glTF 2.0, 3.7.2.1)
      normal = narrow(Eigen::Vector3d((side * (cofactors * vector(vertices.normal, v))).normalized()));
      out_.bad_normals += !finite(normal) || normal == Vec3{};
      if (!vertices.tangent.bytes) continue;
      const Vec3 along = narrow(Eigen::Vector3d((linear * vector(vertices.tangent, v)).normalized()));
      tangent = {along.x, along.y, along.z, static_cast<float>(side * (vertices.tangent.number(v, 3) < 0 ? -1 : 1))};
    }
  }

  GltfDocument& document_;
  const json& root_;
  Harvest out_;
  MaterialReader materials_;
  std::vector<Part> parts_;
  std::vector<ShownVertices> shown_;
  std::uint64_t index_total_ = 0;
  std::size_t sets_ = 0, shown_nodes_ = 0;
};

}   // namespace

Result<Harvest> read_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files) {
  Result<GltfDocument> document = open_gltf(content, folder, buffer_files);
  if (!document) return document.take_error();
  return GltfReader(*document).read(folder, buffer_files);
}

}   // namespace weft::parts
