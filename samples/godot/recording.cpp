// See samples/godot/recording.h.
#include "samples/godot/recording.h"

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>

#include "samples/godot/simulated.h"
#include "samples/godot/skin.h"
#include "samples/godot/skinned_glb.h"

namespace weft_godot {
namespace {

using weft::fail;
using weft::Key;
using weft::Result;

void append(std::vector<Key>& keys, Key key, double time) {
  key.time = time;
  keys.push_back(key);
  key.time = std::nextafter(time, std::numeric_limits<double>::infinity());
  keys.push_back(key);
}

// The last float that is not after a time: a key there holds at that time, whatever time is rounded to.
float not_after(double time) {
  const auto near = static_cast<float>(time);
  return double(near) <= time ? near : std::nextafter(near, 0.0f);
}

// A file that is whole or not there.
Result<void> write_text(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, file, error);
  if (!out || error) return fail(weft::ErrorKind::other, file.string(), " cannot be written");
  return {};
}

}  // namespace

Recording::Recording(std::filesystem::path folder, const weft::Simulation& simulation, std::vector<weft::Mesh> meshes)
    : folder_(std::move(folder)), scene_(simulation.scene()), meshes_(std::move(meshes)) {
  scene_.name = "godot";
  scene_.description = "What ran in Godot, tick by tick.";
  for (weft::Cloth& cloth : scene_.cloths) {   // chosen vertices by their numbers in what is written
    if (!weft::painted_maps(cloth).empty()) {
      spoil("a cloth has painted maps, which are not written");
      cloth.maps = {};
      if (cloth.motion_constraints)
        cloth.motion_constraints->max_distance_map = cloth.motion_constraints->stiffness_map = cloth.motion_constraints->backstop_map = "";
      if (cloth.tear) cloth.tear->map = "";
    }
    if (cloth.skin) cloth.skin = weft::Skinning{.animation = "pose", .loops = false};
    for (weft::Anchor& anchor : cloth.anchors) {
      const std::vector<Key> keys = anchor.keys;
      anchor = {};
      anchor.keys = keys;
    }
  }
  // At the start, too, a key is followed by itself.
  for (weft::Collider& collider : scene_.colliders) append(collider.keys, collider.keys[0], 0), collider.keys.erase(collider.keys.begin());
  for (weft::Cloth& cloth : scene_.cloths)
    for (weft::Anchor& anchor : cloth.anchors)   // without any it goes with a skin
      if (!anchor.keys.empty()) append(anchor.keys, anchor.keys[0], 0), anchor.keys.erase(anchor.keys.begin());
  for (const weft::AnchorTarget& held : simulation.fabric().anchors)
    scene_.cloths[held.cloth].anchors[held.entry].vertices.push_back(held.vertex);
  // One whose vertices another has taken over holds nothing, which a scene does not allow.
  for (const weft::Cloth& cloth : scene_.cloths)
    for (const weft::Anchor& anchor : cloth.anchors)
      if (anchor.vertices.empty()) spoil("an anchor has no vertex of its own");
  if (std::abs(scene_.solver.rate - std::round(scene_.solver.rate)) > 0) spoil("its solver's rate is no whole number");
}

void Recording::add(double time, const Tick& tick, const weft::Scene& anchors) {
  ++ticks_;
  if (tick.seconds != 1 / scene_.solver.rate)
    spoil("a tick lasted another time than 1 / solver_rate: the engine's time scale, or its ticks a second");
  const std::vector<std::optional<Key>>& colliders = tick.colliders;
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k)
    append(scene_.colliders[k].keys, k < colliders.size() && colliders[k] ? *colliders[k] : scene_.colliders[k].keys.back(), time);
  for (std::size_t c = 0; c < scene_.cloths.size(); ++c) {
    for (std::size_t a = 0; a < scene_.cloths[c].anchors.size(); ++a)
      if (const std::vector<Key>& keys = anchors.cloths[c].anchors[a].keys; !keys.empty())
        append(scene_.cloths[c].anchors[a].keys, keys[0], time);
    if (c < tick.cloths.size() && !tick.cloths[c].bones.empty()) add_keys(*meshes_[c].skin, not_after(time), tick.cloths[c].bones);
  }
}

void Recording::spoil(std::string why) {
  if (spoilt_.empty()) spoilt_ = std::move(why);
}

Result<void> Recording::write(const weft::Simulation& simulation) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return fail(weft::ErrorKind::other, "the folder ", folder_.string(), " cannot be made: ", error.message());
  weft::Scene scene = scene_;
  scene.frames = ticks_;
  scene.folder = folder_;
  if (!spoilt_.empty()) scene.description += " Not exactly: " + spoilt_ + ".";
  const auto write_mesh = [&](const weft::Mesh& mesh, const std::string& name) -> Result<std::string> {
    if (auto done = write_skinned_glb(folder_ / name, mesh); !done) return done.take_error();
    return name;
  };
  std::size_t m = 0;
  for (std::size_t c = 0; c < scene.cloths.size(); ++c, ++m) {
    auto name = write_mesh(meshes_[m], "cloth" + std::to_string(c) + ".glb");
    if (!name) return name.take_error();
    scene.cloths[c].mesh = *name;
  }
  for (const std::uint32_t k : weft::mesh_colliders(scene)) {
    auto name = write_mesh(meshes_[m++], "collider" + std::to_string(k) + ".glb");
    if (!name) return name.take_error();
    scene.colliders[k].mesh = *name;
  }
  if (auto done = write_text(folder_ / "scene.json", weft::scene_text(scene)); !done) return done;
  auto vertices = simulation.read_vertex_positions();
  if (!vertices) return vertices.take_error();
  vertices->resize(weft::cloth_vertices(simulation.fabric()));
  return write_text(folder_ / "digest", digest_of(*vertices) + "\n");
}

std::string digest_of(std::span<const weft::Vec3> positions) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const weft::Vec3 p : positions)
    for (const float x : {p.x, p.y, p.z})
      for (const std::uint32_t bits = std::bit_cast<std::uint32_t>(x); const int shift : {0, 8, 16, 24})
        hash = (hash ^ (bits >> shift & 255)) * 0x100000001b3;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace weft_godot
