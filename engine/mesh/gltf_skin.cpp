// Skins, animations and vertex attributes of a glTF (glTF 2.0, 3.7.3 and 3.11). The skins of all that a scene shows become one, over all of
// its vertices: joints lie one after another, and what has no skin is carried by its node. Morph targets are the same skin's.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/mesh/gltf.h"
#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

constexpr std::size_t kDeepestNodes = 256;                // a cloth's file has one or two levels, a character's twenty
constexpr std::size_t kMostSets = 4;                      // of four influences each: more are left out
constexpr std::size_t kMostAttributes = 16;               // of a file: 16 bytes a vertex each
constexpr std::uint64_t kMostKeyed = 16'000'000;          // values of all animations

Affine narrow_columns(const std::array<double, 16>& m) {   // column after column, as glTF has them
  const auto column = [&](std::size_t k) { return narrow(Eigen::Vector3d(m[4 * k], m[4 * k + 1], m[4 * k + 2])); };
  return {column(0), column(1), column(2), column(3)};
}

class SkinReader {
 public:
  SkinReader(GltfDocument& document, std::span<const ShownVertices> shown)
      : document_(document), root_(document.tree.root), shown_(shown), morphs_(document) {}

  std::optional<Skin> read() {
    read_nodes();
    for (const ShownVertices& vertices : shown_)
      if (is_sound()) morphs_.read(vertices, read_vertices(vertices));
    skin_.morphs = std::move(morphs_.morphs());
    const json& animations = document_.list(root_, "animations");
    for (std::size_t a = 0; a < animations.size() && is_sound(); ++a) read_animation(animations[a], a);
    if (is_sound())
      if (const auto good = check_skin(skin_, skin_.weights.size()); !good) say(good.why());
    return is_sound() ? std::optional(std::move(skin_)) : std::nullopt;
  }

 private:
  template <class... Parts>
  void say(const Parts&... parts) {
    document_.say(parts...);
  }
  bool is_sound() const { return document_.fault.empty(); }

  // Numbers of a node; left as they are where it has none.
  template <std::size_t N>
  bool numbers(const json& node, const char* key, std::array<double, N>& values) {
    const json& list = document_.list(node, key);
    if (list.size() != N || !std::ranges::all_of(list, [](const json& x) { return x.is_number(); })) return false;
    for (std::size_t k = 0; k < N; ++k) values[k] = list[k].get<double>();
    return true;
  }

  // Parents first: place_of_ tells where each node of the document lies then.
  void read_nodes() {
    const json& nodes = document_.list(root_, "nodes");
    const std::vector<std::size_t> parent = parents_of(document_, nodes);
    if (!is_sound()) return;
    place_of_.assign(nodes.size(), kNone);
    std::vector<std::size_t> way;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (std::size_t up = n; up != kNone && place_of_[up] == kNone; up = parent[up]) way.push_back(up);
      for (; !way.empty(); way.pop_back()) {
        const std::size_t at = way.back();
        place_of_[at] = static_cast<std::uint32_t>(skin_.nodes.size());
        skin_.nodes.push_back(node_of(nodes[at], parent[at] == kNone ? kNone : place_of_[parent[at]]));
      }
    }
  }

  Skin::Node node_of(const json& described, std::uint32_t parent) {
    Skin::Node node;
    node.parent = parent;
    std::array<double, 3> three;
    std::array<double, 4> four;
    std::array<double, 16> matrix;
    if (numbers(described, "translation", three)) node.translation = narrow(Eigen::Vector3d(three.data()));
    if (numbers(described, "scale", three)) node.scale = narrow(Eigen::Vector3d(three.data()));
    if (numbers(described, "rotation", four))
      node.rotation = {static_cast<float>(four[0]), static_cast<float>(four[1]), static_cast<float>(four[2]), static_cast<float>(four[3])};
    if (numbers(described, "matrix", matrix)) node.matrix = narrow_columns(matrix);
    return node;
  }

  // The number of the first joint of a skin of the document, which is added when it is first met.
  std::uint32_t joints_of_skin(std::size_t number) {
    const auto [known, added] = first_joint_.try_emplace(number, static_cast<std::uint32_t>(skin_.joints.size()));
    if (!added) return known->second;
    const json& skins = document_.list(root_, "skins");
    if (number >= skins.size()) {
      say("a node's \"skin\" points to ", number, " of ", skins.size());
      return 0;
    }
    const json& described = skins[number];
    const json& joints = document_.list(described, "joints");
    if (joints.empty()) say("skin ", number, " has no joints");
    Accessor inverse;
    if (described.is_object() && described.contains("inverseBindMatrices")) {
      inverse = accessor(document_, described, "inverseBindMatrices", "MAT4", Components::floats);
      if (inverse.count < joints.size())
        say("skin ", number, " has ", joints.size(), " joints and ", inverse.count, " inverse bind matrices");
    }
    if (!is_sound()) return 0;
    const json& nodes = document_.list(root_, "nodes");
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const std::size_t node = joints[k].is_number_unsigned() ? joints[k].get<std::size_t>() : kNone;
      if (node >= nodes.size()) {
        say("skin ", number, " has the joint ", joints[k].dump().substr(0, 40), ", and there are ", nodes.size(), " nodes");
        return 0;
      }
      Skin::Joint joint{.name = {}, .node = place_of_[node], .inverse_bind = {}};
      if (nodes[node].is_object() && nodes[node].contains("name") && nodes[node]["name"].is_string()) joint.name = nodes[node]["name"];
      if (inverse.bytes) {
        std::array<double, 16> matrix;
        for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] = inverse.number(k, i);
        joint.inverse_bind = narrow_columns(matrix);
      }
      skin_.joints.push_back(std::move(joint));
    }
    return known->second;
  }

  // What has no skin is carried by its node, in which it lies as it is.
  std::uint32_t joint_of_node(std::size_t node) {
    const auto [known, added] = node_joint_.try_emplace(node, static_cast<std::uint32_t>(skin_.joints.size()));
    if (!added) return known->second;
    const bool is_shown = node != kNone;   // a file of meshes without nodes shows all
    if (!is_shown) skin_.nodes.emplace_back();
    const std::uint32_t at = is_shown ? place_of_[node] : static_cast<std::uint32_t>(skin_.nodes.size() - 1);
    Skin alone;
    alone.nodes = skin_.nodes;
    alone.joints.push_back({.name = {}, .node = at, .inverse_bind = {}});
    const Affine place = joints_at(alone, kNone, 0)[0];
    skin_.joints.push_back({.name = {}, .node = at, .inverse_bind = narrow(wide(place).inverse())});
    return known->second;
  }

  // Returns where their node has them. A skinned mesh is placed by its joints instead.
  Eigen::Affine3d read_vertices(const ShownVertices& vertices) {
    if (vertices.skin == kNone) {
      const auto joint = static_cast<std::uint16_t>(joint_of_node(vertices.node));
      skin_.joints_of.insert(skin_.joints_of.end(), vertices.count, {joint, joint, joint, joint});
      skin_.weights.insert(skin_.weights.end(), vertices.count, {1, 0, 0, 0});
      return wide(skin_.joints[joint].inverse_bind).inverse();
    }
    const std::uint32_t first = joints_of_skin(vertices.skin), joints = static_cast<std::uint32_t>(skin_.joints.size()) - first;
    std::vector<std::array<Accessor, 2>> sets;
    for (std::size_t s = 0; s < kMostSets; ++s) {
      const std::string joint = "JOINTS_" + std::to_string(s), weight = "WEIGHTS_" + std::to_string(s);
      if (!vertices.attributes->contains(joint) && s > 0) break;
      sets.push_back({accessor(document_, *vertices.attributes, joint.c_str(), "VEC4", Components::numbers),
                      accessor(document_, *vertices.attributes, weight.c_str(), "VEC4", Components::numbers)});
      for (const Accessor& read : sets.back())
        if (read.count != vertices.count)
          say("a primitive has ", vertices.count, " positions but ", read.count, " of ", joint, " or ", weight);
    }
    for (std::size_t v = 0; v < vertices.count && is_sound(); ++v) add_influences(sets, v, first, joints);
    return Eigen::Affine3d::Identity();
  }

  // The four largest of a vertex, which share the weight of all.
  void add_influences(std::span<const std::array<Accessor, 2>> sets, std::size_t v, std::uint32_t first, std::uint32_t joints) {
    std::array<std::pair<double, std::uint32_t>, 4 * kMostSets> all{};
    double sum = 0;
    for (std::size_t s = 0; s < sets.size(); ++s)
      for (std::size_t k = 0; k < 4; ++k) {
        const double joint = sets[s][0].number(v, k), weight = sets[s][1].number(v, k);
        if (weight != 0 && !(joint >= 0 && joint < joints)) return say("vertex ", v, " has joint ", joint, " of ", joints);
        if (!(weight >= 0)) return say("vertex ", v, " has a weight of ", weight, ", less than 0 or not a number");
        all[4 * s + k] = {weight, weight != 0 ? static_cast<std::uint32_t>(joint) : 0};
        sum += weight;
      }
    std::ranges::stable_sort(all, std::greater(), &std::pair<double, std::uint32_t>::first);
    double kept = 0;
    for (std::size_t k = 0; k < Skin::kInfluences; ++k) kept += all[k].first;
    auto& joints_of = skin_.joints_of.emplace_back();
    auto& weights = skin_.weights.emplace_back();
    for (std::size_t k = 0; k < Skin::kInfluences; ++k) {
      joints_of[k] = static_cast<std::uint16_t>(first + all[k].second);
      weights[k] = static_cast<float>(kept > 0 ? all[k].first * sum / kept : 0);
    }
  }

  void read_animation(const json& described, std::size_t number) {
    Skin::Animation animation;
    animation.name = described.is_object() && described.contains("name") && described["name"].is_string()
                         ? described["name"].get<std::string>() : std::to_string(number);
    const json& samplers = document_.list(described, "samplers");
    const json& channels = document_.list(described, "channels");
    if (channels.empty()) say("animation ", number, " has no channels");
    for (const json& channel : channels) {
      if (!is_sound()) return;
      const json target = channel.is_object() && channel.contains("target") ? channel["target"] : json::object();
      const std::string path = target.is_object() && target.contains("path") && target["path"].is_string() ? target["path"] : json("");
      if (!target.contains("node")) continue;   // what an extension moves
      const json* sampler = document_.entry(samplers, channel, "sampler");
      const std::uint64_t node = document_.natural(target, "node", kNone);
      if (node >= place_of_.size()) say("animation ", number, " moves node ", node, " of ", place_of_.size());
      if (path != "translation" && path != "rotation" && path != "scale" && path != "weights")
        say("animation ", number, " moves the \"", path.substr(0, 40), "\" of a node");
      if (!is_sound()) return;
      if (path == "weights") add_weights(*sampler, node, animation, number);
      else animation.channels.push_back(channel_of(*sampler, place_of_[node], path, number));
    }
    if (!animation.channels.empty()) skin_.animations.push_back(std::move(animation));
  }

  Skin::Interpolation interpolation_of(const json& sampler, std::size_t number) {
    const std::string between =
        sampler.contains("interpolation") && sampler["interpolation"].is_string() ? sampler["interpolation"] : json("LINEAR");
    if (between == "STEP") return Skin::Interpolation::step;
    if (between == "CUBICSPLINE") return Skin::Interpolation::cubic;
    if (between != "LINEAR") say("animation ", number, " has the interpolation \"", between.substr(0, 40), "\"");
    return Skin::Interpolation::linear;
  }

  // A channel for each morph target of the node. At each time the file has the weights of all of them; with cubic interpolation all
  // in-tangents, then all weights, then all out-tangents. None for what is not shown.
  void add_weights(const json& sampler, std::size_t node, Skin::Animation& animation, std::size_t number) {
    const auto [first, count] = morphs_.of_node(node);
    if (count == 0) return;
    const Skin::Interpolation between = interpolation_of(sampler, number);
    const Accessor times = accessor(document_, sampler, "input", "SCALAR", Components::floats);
    const Accessor values = accessor(document_, sampler, "output", "SCALAR", Components::numbers);
    const std::size_t each = between == Skin::Interpolation::cubic ? 3 : 1;
    const std::uint64_t wanted = times.count * count * each;
    keyed_ += times.count * count + values.count;
    if (keyed_ > kMostKeyed) say("its animations have more than ", kMostKeyed, " values");
    if (values.count != wanted)
      say("animation ", number, " has ", values.count, " weights, and ", times.count, " times of ", count, " morph targets need ", wanted);
    if (!is_sound()) return;
    for (std::size_t m = 0; m < count; ++m) {
      Skin::Channel& channel = animation.channels.emplace_back();
      channel.node = static_cast<std::uint32_t>(first + m);
      channel.moves = Skin::Moves::weight;
      channel.interpolation = between;
      for (std::size_t k = 0; k < times.count; ++k) channel.times.push_back(times.at<float>(k));
      for (std::size_t k = 0; k < times.count * each; ++k)
        channel.values.push_back({static_cast<float>(values.number(k * count + m, 0)), 0, 0, 0});
    }
  }

  Skin::Channel channel_of(const json& sampler, std::uint32_t node, const std::string& path, std::size_t number) {
    Skin::Channel channel;
    channel.node = node;
    channel.moves = path == "translation" ? Skin::Moves::translation : path == "rotation" ? Skin::Moves::rotation : Skin::Moves::scale;
    channel.interpolation = interpolation_of(sampler, number);
    const bool turns = channel.moves == Skin::Moves::rotation;
    const Accessor times = accessor(document_, sampler, "input", "SCALAR", Components::floats);
    const Accessor values = accessor(document_, sampler, "output", turns ? "VEC4" : "VEC3", Components::numbers);
    keyed_ += times.count + values.count;
    if (keyed_ > kMostKeyed) say("its animations have more than ", kMostKeyed, " values");
    if (!is_sound()) return channel;
    for (std::size_t k = 0; k < times.count; ++k) channel.times.push_back(times.at<float>(k));
    for (std::size_t k = 0; k < values.count; ++k) {
      const auto part = [&](std::size_t i) { return static_cast<float>(values.number(k, i)); };
      channel.values.push_back({part(0), part(1), part(2), turns ? part(3) : 0});
    }
    return channel;
  }

  GltfDocument& document_;
  const json& root_;
  std::span<const ShownVertices> shown_;
  Skin skin_;
  MorphReader morphs_;
  std::vector<std::uint32_t> place_of_;
  std::map<std::size_t, std::uint32_t> first_joint_, node_joint_;
  std::uint64_t keyed_ = 0;
};

}  // namespace

std::vector<std::size_t> parents_of(GltfDocument& document, const json& nodes) {
  std::vector<std::size_t> parent(nodes.size(), kNone);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (const json& child : document.list(nodes[n], "children")) {
      const std::uint64_t c = child.is_number_unsigned() ? child.get<std::uint64_t>() : kNone;
      if (c < nodes.size() && parent[c] == kNone)
        parent[c] = n;
      else
        document.say("node ", n, " has the child ", child.dump().substr(0, 40), ", which does not exist or has another parent");
    }
  for (std::size_t n = 0; n < parent.size(); ++n) {
    std::size_t steps = 0;
    for (std::size_t up = n; up != kNone && steps <= kDeepestNodes; up = parent[up]) ++steps;
    if (steps > kDeepestNodes) document.say("node ", n, " lies below itself or deeper than ", kDeepestNodes, " levels");
  }
  return parent;
}

std::optional<Skin> read_skin(GltfDocument& document, std::span<const ShownVertices> shown) { return SkinReader(document, shown).read(); }

std::map<std::string, std::vector<Vec4>> read_attributes(GltfDocument& document, std::span<const ShownVertices> shown) {
  std::map<std::string, std::vector<Vec4>> attributes;
  std::size_t first = 0, total = 0;
  for (const ShownVertices& vertices : shown) total += vertices.count;
  for (const ShownVertices& vertices : shown) {
    const std::size_t begin = std::exchange(first, first + vertices.count);
    for (const auto& [name, number] : vertices.attributes->items()) {
      const bool is_colour = name.starts_with("COLOR_");
      if (!is_colour && !name.starts_with("_")) continue;
      const json* described = document.entry(document.list(document.tree.root, "accessors"), *vertices.attributes, name.c_str());
      const bool is_typed = described && described->contains("type") && (*described)["type"].is_string();
      const std::string type = is_typed ? (*described)["type"] : json("");
      const std::size_t width = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
      if (width == 0) document.say("the accessor of \"", name, "\" has the type \"", type.substr(0, 40), "\"; SCALAR to VEC4 can be read");
      if (!document.fault.empty()) return {};
      const Accessor read = accessor(document, *vertices.attributes, name.c_str(), type, Components::numbers);
      if (read.count != vertices.count) document.say("a primitive has ", vertices.count, " positions but ", read.count, " of ", name);
      if (attributes.size() >= kMostAttributes && !attributes.contains(name))
        document.say("it has more than ", kMostAttributes, " attributes");
      if (!document.fault.empty()) return {};
      std::vector<Vec4>& values = attributes.try_emplace(name, total, Vec4{1, 1, 1, 1}).first->second;
      for (std::size_t v = 0; v < vertices.count; ++v) {
        float parts[4] = {1, 1, 1, 1};
        for (std::size_t k = 0; k < width; ++k) parts[k] = static_cast<float>(read.number(v, k));
        values[begin + v] = {parts[0], parts[1], parts[2], parts[3]};
        if (!std::isfinite(parts[0] + parts[1] + parts[2] + parts[3])) document.say("\"", name, "\" has a value that is not finite");
      }
    }
  }
  if (!document.fault.empty()) return {};
  return attributes;
}

}  // namespace weft::parts
