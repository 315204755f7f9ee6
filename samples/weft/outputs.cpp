// Outputs against inputs, by the identity of files.
#include "samples/weft/outputs.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "compute/file.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

std::string decode_percent(const std::string& uri) {
  std::string plain;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      plain.push_back(static_cast<char>(code));
      i += 2;
    } else {
      plain.push_back(uri[i]);
    }
  }
  return plain;
}

// Of a glTF: all of it, or of a GLB its first chunk.
std::string document_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(20, '\0');
  if (!stream.read(head.data(), static_cast<std::streamsize>(head.size())) || !head.starts_with("glTF")) {
    stream.clear();
    stream.seekg(0);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::uint32_t length = 0;
  std::memcpy(&length, head.data() + 12, sizeof length);
  std::error_code none;
  const auto size = std::filesystem::file_size(file, none);
  std::string text(none ? 0 : static_cast<std::size_t>(std::min<std::uintmax_t>(length, size)), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

// What is wrong with a mesh's document is said where it is read.
void add_mesh(const std::filesystem::path& file, const std::string& as, std::vector<Input>& inputs) {
  inputs.push_back({file, as});
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".gltf" && ending != ".glb") return;
  const auto document = nlohmann::json::parse(document_in(file), nullptr, false);
  if (!document.is_object()) return;
  for (const auto& [list, what] : {std::pair("buffers", "a buffer of "), std::pair("images", "an image of ")}) {
    if (!document.contains(list) || !document[list].is_array()) continue;
    for (const auto& entry : document[list])
      if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string())
        inputs.push_back({file.parent_path() / decode_percent(entry["uri"].get<std::string>()), what + as});
  }
}

void add_curves(std::vector<Input>& inputs) {
  std::error_code none;
  for (std::filesystem::directory_iterator at(curve_file("").parent_path(), none), end; !none && at != end; at.increment(none))
    if (at->path().extension() == ".csv") inputs.push_back({at->path(), "the curve of a device"});
}

}  // namespace

std::vector<Input> inputs_of(const std::filesystem::path& file, const Scene& scene) {
  std::vector<Input> inputs = {{file, "the scene"}};
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const Cloth& cloth = scene.cloths[i];
    const std::string path = "cloths[" + std::to_string(i) + "].";
    if (!cloth.mesh.empty()) add_mesh(scene.folder / cloth.mesh, path + "mesh", inputs);
    if (!cloth.render_mesh.empty()) add_mesh(scene.folder / cloth.render_mesh, path + "render_mesh", inputs);
    for (const auto& [key, map] : maps_of(cloth.appearance)) inputs.push_back({scene.folder / map, path + "appearance." + key});
    for (const auto& [key, map] : painted_maps(cloth)) inputs.push_back({scene.folder / map, path + key});
  }
  for (const std::uint32_t i : mesh_colliders(scene))
    add_mesh(scene.folder / scene.colliders[i].mesh, "colliders[" + std::to_string(i) + "].mesh", inputs);
  if (scene.solver.method == Method::automatic) add_curves(inputs);
  return inputs;
}

Exit prepare_outputs(const std::filesystem::path& folder, std::span<const std::string> names, std::span<const Input> inputs) {
  if (const Result<void> made = make_folder(folder); !made) return failed(made.error());
  bool probed = false;
  for (const std::string& name : names) {
    const std::filesystem::path file = folder / name;
    std::error_code none;
    const auto status = std::filesystem::symlink_status(file, none);
    const bool there = std::filesystem::exists(status);
    for (const Input& input : inputs)
      if (there && std::filesystem::equivalent(file, input.file, none)) {
        complain(file.string() + " is read as " + input.as + " and would be overwritten: choose another --out");
        return kBadInput;
      }
    // One file that is new or plain tells of all others in the folder.
    if (probed && (!there || std::filesystem::is_regular_file(status))) continue;
    if (const Result<void> writable = probe_file(file); !writable) return failed(writable.error());
    probed = true;
  }
  return kDone;
}

}  // namespace weft::command
