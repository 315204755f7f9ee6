// See samples/godot/skinned_glb.h.
//
//   a GLB: 12 bytes (magic, version, length), then chunks: length, type, bytes;
//   the first is JSON, the second binary, each padded to 4 bytes
//
// The engine's file is read back, and accessors, nodes, a skin and an animation are added to it.
#include "samples/godot/skinned_glb.h"

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/export.h"

namespace weft_godot {
namespace {

using nlohmann::json;
using weft::fail;
using weft::Mesh;
using weft::Result;
using weft::Skin;
using weft::Vec3;
using weft::Vec4;

constexpr int kFloat = 5126, kShort = 5123;   // of glTF's component types

struct Glb {
  json root;
  std::string bytes;   // of its buffer

  template <class T>
  std::size_t add(const std::vector<T>& values, int component, const char* type) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    root["accessors"].push_back(
        {{"bufferView", root["bufferViews"].size() - 1}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    return root["accessors"].size() - 1;
  }
};

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

Result<Glb> read(const std::filesystem::path& file) {
  std::ostringstream whole;
  whole << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string bytes = whole.str();
  const std::size_t text = bytes.size() >= 20 ? word(bytes, 12) : 0, rest = 20 + text;
  if (text == 0 || rest + 8 > bytes.size()) return fail(weft::ErrorKind::other, file.string(), " cannot be read back");
  return Glb{json::parse(bytes.substr(20, text)), bytes.substr(rest + 8, word(bytes, rest))};
}

Result<void> write(const std::filesystem::path& file, Glb& glb) {
  glb.bytes.resize((glb.bytes.size() + 3) / 4 * 4);
  glb.root["buffers"][0]["byteLength"] = glb.bytes.size();
  std::string text = glb.root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    out.write(reinterpret_cast<const char*>(&narrow), sizeof narrow);
  };
  put(0x46546C67), put(2), put(12 + 8 + text.size() + 8 + glb.bytes.size());
  put(text.size()), put(0x4E4F534A), out << text;
  put(glb.bytes.size()), put(0x004E4942), out << glb.bytes;
  out.close();
  if (!out) return fail(weft::ErrorKind::other, file.string(), " cannot be written");
  return {};
}

// Of a primitive's vertices, from what a mesh's points have.
template <class T>
std::vector<T> of_vertices(const Mesh& mesh, const std::vector<T>& of_points) {
  std::vector<T> values;
  for (const std::uint32_t point : mesh.point_of) values.push_back(of_points[point]);
  return values;
}

void add_animation(Glb& glb, const Skin::Animation& animation, std::size_t first_node) {
  json samplers = json::array(), channels = json::array();
  for (const Skin::Channel& channel : animation.channels) {
    const bool turns = channel.moves == Skin::Moves::rotation;
    const std::size_t times = glb.add(channel.times, kFloat, "SCALAR");
    glb.root["accessors"][times]["min"] = {channel.times.front()};
    glb.root["accessors"][times]["max"] = {channel.times.back()};
    std::vector<Vec3> places;
    for (const Vec4& v : channel.values) places.push_back({v.x, v.y, v.z});
    const std::size_t values = turns ? glb.add(channel.values, kFloat, "VEC4") : glb.add(places, kFloat, "VEC3");
    samplers.push_back({{"input", times}, {"output", values}, {"interpolation", "STEP"}});
    const char* path = turns ? "rotation" : channel.moves == Skin::Moves::scale ? "scale" : "translation";
    channels.push_back({{"sampler", samplers.size() - 1}, {"target", {{"node", first_node + channel.node}, {"path", path}}}});
  }
  glb.root["animations"].push_back({{"name", animation.name}, {"samplers", samplers}, {"channels", channels}});
}

void add_skin(Glb& glb, const Mesh& mesh, json& attributes) {
  const Skin& skin = *mesh.skin;
  attributes["JOINTS_0"] = glb.add(of_vertices(mesh, skin.joints_of), kShort, "VEC4");
  attributes["WEIGHTS_0"] = glb.add(of_vertices(mesh, skin.weights), kFloat, "VEC4");
  const std::size_t first = glb.root["nodes"].size();
  json joints = json::array();
  std::vector<std::array<float, 16>> binds;
  for (const Skin::Joint& joint : skin.joints) {   // each has a node of its own
    const weft::Affine& m = joint.inverse_bind;
    binds.push_back({m.x.x, m.x.y, m.x.z, 0, m.y.x, m.y.y, m.y.z, 0, m.z.x, m.z.y, m.z.z, 0, m.origin.x, m.origin.y, m.origin.z, 1});
    joints.push_back(glb.root["nodes"].size());
    glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size());
    glb.root["nodes"].push_back({{"name", joint.name}});
  }
  glb.root["skins"].push_back({{"joints", joints}, {"inverseBindMatrices", glb.add(binds, kFloat, "MAT4")}});
  for (json& node : glb.root["nodes"])
    if (node.contains("mesh")) node["skin"] = 0;
  for (const Skin::Animation& animation : skin.animations) add_animation(glb, animation, first);
}

}  // namespace

Result<void> write_skinned_glb(const std::filesystem::path& file, const Mesh& mesh) {
  weft::RenderMesh plain = mesh.render;   // as one primitive: by materials its triangles would have another order
  plain.material_of.clear();
  plain.materials.reset();
  if (auto done = weft::write_glb(file, plain); !done || (!mesh.skin && mesh.attributes.empty())) return done;
  auto glb = read(file);
  if (!glb) return glb.take_error();
  json added = json::object();
  for (const auto& [name, values] : mesh.attributes) added[name] = glb->add(of_vertices(mesh, values), kFloat, "VEC4");
  if (mesh.skin) add_skin(*glb, mesh, added);
  glb->root["meshes"][0]["primitives"][0]["attributes"].update(added);
  return write(file, *glb);
}

}  // namespace weft_godot
