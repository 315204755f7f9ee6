// Any text as a scene: it ends in sentences, or in a scene that is written and read back the same, and that cooks.
#include <cstdlib>
#include <cstdint>
#include <string_view>

#include "engine/fabric.h"
#include "engine/mesh.h"
#include "engine/scene.h"

namespace {

// Cloths of more than this are read and not cooked: a large grid is no fault, and a fuzzer is to try many small ones.
constexpr std::uint64_t kMostCells = 200;

bool is_small(const weft::Scene& scene) {
  std::uint64_t cells = 0;
  for (const weft::Cloth& cloth : scene.cloths) {
    if (!cloth.grid) return false;
    cells += std::uint64_t(cloth.grid->cells_x) * cloth.grid->cells_y;
  }
  return cells <= kMostCells && weft::mesh_colliders(scene).empty();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  const auto scene = weft::parse_scene(text, "/nonexistent");
  if (!scene) {
    if (scene.error().empty()) std::abort();
    return 0;
  }
  const std::string written = weft::scene_text(*scene);
  const auto again = weft::parse_scene(written, "/nonexistent");
  if (!again || weft::scene_text(*again) != written) std::abort();
  if (!is_small(*scene)) return 0;
  const auto meshes = weft::make_meshes(*scene);
  if (meshes) (void)weft::cook(*scene, *meshes);
  return 0;
}
