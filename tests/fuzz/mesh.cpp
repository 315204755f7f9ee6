// Any bytes as a mesh: they end in a sentence, or in a mesh whose indices are in range and whose points are finite.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "engine/mesh.h"

namespace {

// A file is named by what its bytes could be; it goes when the program ends.
class File {
 public:
  explicit File(std::string_view content) {
    constexpr std::pair<std::string_view, const char*> kinds[] = {
        {"glTF", ".glb"}, {"{", ".gltf"}, {"ply", ".ply"}, {"solid", ".stl"}, {"<?xml", ".dae"}, {"; FBX", ".fbx"}, {"Kaydara", ".fbx"}};
    const auto is_begun = [&](const auto& kind) { return content.starts_with(kind.first); };
    const auto found = std::ranges::find_if(kinds, is_begun);
    const char* kind = found == std::end(kinds) ? ".obj" : found->second;
    const std::filesystem::path memory = "/dev/shm";
    path_ = (std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) /
            ("weft_fuzz_" + std::to_string(getpid()) + kind);
    std::ofstream(path_, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  ~File() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const File file({reinterpret_cast<const char*>(bytes), size});
  const auto mesh = weft::load_mesh(file.path());
  if (!mesh) {
    demand(!mesh.error().empty());
    return 0;
  }
  demand(!mesh->triangles.empty() && mesh->render.triangles.size() == mesh->triangles.size());
  demand(mesh->render.normals.size() == mesh->render.positions.size() && mesh->render.uvs.size() == mesh->render.positions.size());
  demand(bool(weft::check(*mesh)));
  for (const weft::Vec3& p : mesh->points) demand(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  for (const weft::Vec3& n : mesh->render.normals) demand(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z));
  for (const weft::Triangle& triangle : mesh->triangles)
    for (const std::uint32_t v : triangle) demand(v < mesh->points.size());
  for (const weft::Triangle& triangle : mesh->render.triangles)
    for (const std::uint32_t v : triangle) demand(v < mesh->render.positions.size());
  for (const weft::WingedEdge& edge : mesh->edges) demand(edge.a < mesh->points.size() && edge.b < mesh->points.size() && edge.a != edge.b);
  return 0;
}
