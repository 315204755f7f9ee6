// A scene file's way in: bytes, JSON, assignments, values, and all faults at once; and its way out.
#include "engine/scene.h"

#include <fstream>

#include "engine/scene/faults.h"
#include "engine/scene/json.h"
#include "engine/scene/reader.h"
#include "engine/scene/writer.h"

namespace weft {

namespace {

Result<std::string> read_text(const std::filesystem::path& file) {
  const std::string name = printable(file.string(), 500);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return fail(name, ": there is no such file");
  if (!std::filesystem::is_regular_file(file, error)) return fail(name, ": is not a file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return fail(name, ": cannot be read: ", error.message());
  if (size > kLargestSceneBytes) return fail(name, ": ", size, " bytes are more than ", kLargestSceneBytes, ", the most a scene may have");
  std::string text(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream || static_cast<std::uintmax_t>(stream.gcount()) != size) return fail(name, ": cannot be read");
  return text;
}

}  // namespace

Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& folder, std::span<const Assignment> assignments) {
  return parse_scene_with(text, {folder}, assignments);
}

Result<Scene> parse_scene_with(std::string_view text, const Nameable& nameable, std::span<const Assignment> assignments) try {
  Result<JsonTree> tree = parse_json(text);
  if (!tree) return tree.take_error();
  nlohmann::json& value = tree->root;
  if (!value.is_object()) return fail("scene: ", shown(value), ", not an object");

  std::string refused;
  const auto refuse = [&](const std::string& sentences) {
    if (!refused.empty()) refused += '\n';
    refused += sentences;
  };
  for (const Assignment& assignment : assignments)
    if (Result<void> done = assign(value, assignment); !done) refuse(done.error());

  Scene scene;
  Faults faults;
  read_scene(value, nameable, scene, faults);
  if (!faults.empty()) refuse(faults.text());
  if (!refused.empty()) return Error{refused};
  return scene;
} catch (...) {
  return caught("the scene");
}

Result<Scene> load_scene(const std::filesystem::path& file, std::span<const Assignment> assignments) try {
  Result<std::string> text = read_text(file);
  if (!text) return text.take_error();
  Result<Scene> scene = parse_scene(*text, file.parent_path(), assignments);
  if (scene && scene->name.empty()) scene->name = file.stem().string();
  return scene;
} catch (...) {
  return caught("the scene");
}

std::vector<std::uint32_t> mesh_colliders(const Scene& scene) {
  std::vector<std::uint32_t> meshes;
  for (std::uint32_t i = 0; i < scene.colliders.size(); ++i)
    if (scene.colliders[i].shape == ColliderShape::mesh) meshes.push_back(i);
  return meshes;
}

std::string scene_text(const Scene& scene) {
  constexpr int kIndent = 2;
  return SceneWriter::written(scene).root.dump(kIndent, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace weft
