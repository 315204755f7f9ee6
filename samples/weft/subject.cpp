// Scenes from files and from bare meshes.
#include "samples/weft/subject.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>

#include "engine/reference/choice.h"
#include "engine/reference/intersections.h"
#include "engine/image.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"

namespace weft::command {

bool is_mesh(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Those of the second line cannot be read; it is the loader that says so, and which can.
  constexpr std::string_view kMeshes[] = {".gltf", ".glb", ".obj", ".ply", ".stl", ".dae", ".fbx",
                                          ".usd", ".usda", ".usdc", ".usdz", ".abc", ".3ds", ".blend"};
  return std::ranges::find(kMeshes, ending) != std::end(kMeshes);
}

namespace {

Result<Scene> load_any(const std::filesystem::path& file, std::span<const Assignment> assignments, BufferFiles buffer_files) {
  if (!is_mesh(file)) return load_scene(file, assignments);
  Result<Mesh> mesh = load_mesh(file, buffer_files);
  if (!mesh) return mesh.take_error();
  Vec3 low = mesh->points.front(), high = low;
  for (const Vec3& p : mesh->points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Scene scene = default_scene(file, low, high);
  if (assignments.empty()) return scene;
  return parse_scene(scene_text(scene), scene.folder, assignments);
}

}  // namespace

Result<Scene> load_subject(const std::filesystem::path& file, std::span<const Assignment> assignments, BufferFiles buffer_files) {
  Result<Scene> scene = load_any(file, assignments, buffer_files);
  if (scene) scene->buffer_files = buffer_files;
  return scene;
}

std::vector<std::pair<std::string, std::string>> maps_of(const Appearance& looks) {
  std::vector<std::pair<std::string, std::string>> maps = {
      {"albedo", looks.albedo}, {"normal", looks.normal}, {"roughness", looks.roughness}, {"occlusion", looks.occlusion}};
  std::erase_if(maps, [](const auto& map) { return map.second.empty(); });
  return maps;
}

std::vector<std::string> file_faults(const Scene& scene) {
  std::vector<std::string> faults;
  // A thousand cloths may show one file: each is read once, and told of wherever it stands.
  std::map<std::string, std::string> read;
  const auto look = [&](const std::string& file, const auto& fault_of, const std::string& key) {
    const auto [known, is_new] = read.try_emplace(file);
    if (is_new) known->second = fault_of(scene.folder / file);
    if (!known->second.empty()) faults.push_back(key + ": " + known->second);
  };
  const auto mesh_fault = [&](const std::filesystem::path& file) {
    const Result<Mesh> mesh = load_mesh(file, scene.buffer_files);
    return mesh ? "" : mesh.error();
  };
  const auto image_fault = [](const std::filesystem::path& file) {
    const Result<Image> image = read_image(file);
    return image ? "" : image.error();
  };
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const Cloth& cloth = scene.cloths[i];
    const std::string path = "cloths[" + std::to_string(i) + "].";
    if (!cloth.mesh.empty()) look(cloth.mesh, mesh_fault, path + "mesh");
    if (!cloth.render_mesh.empty()) look(cloth.render_mesh, mesh_fault, path + "render_mesh");
    for (const auto& [key, map] : maps_of(cloth.appearance)) look(map, image_fault, path + "appearance." + key);
    for (const auto& [key, map] : painted_maps(cloth)) look(map, image_fault, path + key);
  }
  for (const std::uint32_t i : mesh_colliders(scene)) look(scene.colliders[i].mesh, mesh_fault, "colliders[" + std::to_string(i) + "].mesh");
  return faults;
}

std::string crossing_note(const Scene& scene, const CookedFabric& fabric) {
  constexpr std::uint64_t kMostCandidates = 256;   // an edge: a flat sheet has ten, a crumpled one some dozens
  if (!contacts_on(scene)) return "";
  std::vector<Vec3> positions;
  positions.reserve(fabric.positions.size());
  for (const gpu::vec4& particle : fabric.positions) positions.push_back({particle.x, particle.y, particle.z});
  const CrossingCount found =
      count_crossings_among(positions, fabric.triangles, kMostCandidates * fabric.edges.size(), fabric.cloth_triangles);
  if (found.pairs == 0) return "";
  return "contacts: cloth starts out crossing or touching cloth or a mesh, in " + std::string(found.all ? "" : "at least ") +
         std::to_string(found.pairs) + " pairs of edge and triangle" +
         (scene.contacts.untangle ? "; it is untangled over the first frames." : ", and contacts.untangle is off.");
}

namespace {

// The device's own curve, for scenes that choose by one; nothing where none was saved.
Result<std::optional<Curve>> saved_curve(const compute::Device& device, const Scene& scene) {
  const std::filesystem::path file = curve_file(device.name());
  if (scene.solver.method != Method::automatic || !is_there(file)) return std::optional<Curve>();
  std::ifstream stream(file, std::ios::binary);
  auto curve = parse_curve(std::string{std::istreambuf_iterator<char>(stream), {}});
  if (!curve) return fail(file.string(), ": ", curve.error(), "; weft accuracy --save writes a new one");
  return std::optional<Curve>(std::move(*curve));
}

}  // namespace

Started start(const compute::Device& device, const Scene& scene, bool timings) {
  const auto curve = saved_curve(device, scene);
  if (!curve) {
    complain(curve.error());
    return {nullptr, kBadInput};
  }
  SimulationOptions options;
  options.curve = *curve ? &**curve : nullptr;
  options.timings = timings;
  options.pipeline_cache = pipeline_cache();
  auto simulation = Simulation::create(device, scene, options);
  if (simulation) return {std::move(*simulation), kDone};
  complain(simulation.error());
  const Result<std::vector<Mesh>> meshes = make_meshes(scene);
  return {nullptr, meshes && cook(scene, *meshes) ? kFailed : kBadInput};
}

}  // namespace weft::command
