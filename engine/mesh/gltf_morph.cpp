// Morph targets of a glTF (glTF 2.0, 3.7.2.2): for each the vertices that it moves, and by what. Deltas are in the space of their node; they
// leave here in that of the mesh. Tangents are not read: nothing here turns by them.
#include <algorithm>
#include <cmath>

#include "engine/finite.h"
#include "engine/mesh/gltf.h"
#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

constexpr std::uint64_t kMostMoved = 32'000'000;   // vertices times morph targets: 28 bytes each that is moved

bool moves(Vec3 v) { return v.x != 0 || v.y != 0 || v.z != 0; }

// How a delta of a normal changes the unit normal in the space of the mesh: as the normal is turned there, and by its length.
Vec3 turned(const Eigen::Affine3d& place, Vec3 normal, Vec3 delta) {
  const Eigen::Matrix3d linear = place.linear();
  Eigen::Matrix3d cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)), linear.col(0).cross(linear.col(1));
  const double size = (cofactors * wide(normal)).norm(), side = linear.determinant() < 0 ? -1 : 1;
  return size > 1e-12 ? narrow(Eigen::Vector3d(side / size * (cofactors * wide(delta)))) : Vec3{};
}

}  // namespace

std::pair<std::size_t, std::size_t> MorphReader::of_node(std::size_t node) const {
  const auto at = of_node_.find(node);
  return at == of_node_.end() ? std::pair<std::size_t, std::size_t>() : at->second;
}

// With their names and their weights, when their mesh is first met under this node.
std::size_t MorphReader::first_of(const ShownVertices& vertices) {
  const std::size_t count = vertices.targets->size();
  const auto [known, added] = first_.try_emplace({vertices.node, vertices.mesh}, morphs_.size());
  if (!added) {
    if (const std::size_t before = of_node(vertices.node).second; before != count)
      document_.say("the primitives of a mesh have ", before, " and ", count, " morph targets");
    return known->second;
  }
  if (morphs_.size() + count > kMostMorphs) {
    document_.say("it has ", morphs_.size() + count, " morph targets or more; at most ", kMostMorphs, " are allowed");
    return 0;
  }
  of_node_[vertices.node] = {morphs_.size(), count};
  if (count == 0) return known->second;
  static const json none = json::object();
  const json& nodes = document_.list(document_.tree.root, "nodes");
  const json& node = vertices.node < nodes.size() ? nodes[vertices.node] : none;
  const json& weights = document_.list(has(node, "weights") ? node : *vertices.mesh, "weights");
  if (!weights.empty() && weights.size() != count) document_.say("a mesh has ", count, " morph targets and ", weights.size(), " weights");
  const json& extras = has(*vertices.mesh, "extras") ? (*vertices.mesh)["extras"] : none;   // which have names by custom, if they have
  const json& names = has(extras, "targetNames") && extras["targetNames"].is_array() ? extras["targetNames"] : none;
  for (std::size_t m = 0; m < count && document_.fault.empty(); ++m) {
    Skin::Morph& morph = morphs_.emplace_back();
    if (m < names.size() && names[m].is_string()) morph.name = names[m];
    if (weights.empty()) continue;
    if (weights[m].is_number()) morph.weight = static_cast<float>(weights[m].get<double>());
    else document_.say("the weight of morph target ", m, " is ", weights[m].dump().substr(0, 40), ", not a number");
  }
  return known->second;
}

void MorphReader::read(const ShownVertices& vertices, const Eigen::Affine3d& place) {
  const std::size_t begin = std::exchange(vertices_, vertices_ + vertices.count);
  const std::size_t first = first_of(vertices), count = vertices.targets->size();
  moved_ += std::uint64_t{vertices.count} * count;
  if (moved_ > kMostMoved) document_.say("its morph targets, times their vertices, are more than ", kMostMoved);
  if (count == 0 || !document_.fault.empty()) return;
  Accessor normals;
  if (vertices.attributes->contains("NORMAL")) normals = accessor(document_, *vertices.attributes, "NORMAL", "VEC3", Components::numbers);
  for (std::size_t m = 0; m < count && document_.fault.empty(); ++m) {
    const json& target = (*vertices.targets)[m];
    const auto deltas = [&](const char* key) {
      if (!has(target, key)) return std::vector<Vec3>();
      std::vector<Vec3> values = vectors(document_, target, key);
      if (values.size() != vertices.count)
        document_.say("a primitive has ", vertices.count, " positions but ", values.size(), " of ", key, " in morph target ", m);
      if (!std::ranges::all_of(values, [](Vec3 v) { return is_finite(v); }))
        document_.say("morph target ", m, " has a ", key, " that is not finite, or of ", kTooLarge, " or more");
      return values;
    };
    const std::vector<Vec3> positions = deltas("POSITION"), turns = normals.bytes ? deltas("NORMAL") : std::vector<Vec3>();
    if (!document_.fault.empty()) return;
    Skin::Morph& morph = morphs_[first + m];
    for (std::size_t v = 0; v < vertices.count; ++v) {
      const Vec3 delta = positions.empty() ? Vec3{} : positions[v], turn = turns.empty() ? Vec3{} : turns[v];
      if (!moves(delta) && !moves(turn)) continue;
      if (moves(turn)) morph.normal_deltas.resize(morph.points.size());   // those before did not turn
      morph.points.push_back(static_cast<std::uint32_t>(begin + v));
      morph.deltas.push_back(narrow(Eigen::Vector3d(place.linear() * wide(delta))));
      if (moves(turn) || !morph.normal_deltas.empty()) morph.normal_deltas.push_back(turned(place, normals.vector(v), turn));
    }
  }
}

}  // namespace weft::parts
