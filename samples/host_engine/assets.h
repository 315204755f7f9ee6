// What the host engine owns besides the cloth: models of a few shapes, and the PNG at the end.
#pragma once

#include <filesystem>
#include <span>

#include "engine/mesh.h"
#include "samples/host_engine/renderer.h"

namespace host {

/// Radius 1 about the origin.
weft::RenderMesh sphere();
/// From -1/2 to 1/2 along each axis, with sharp edges.
weft::RenderMesh box();

/// A mesh of the engine's own.
class Model {
 public:
  static Result<Model> create(const Device& device, const weft::RenderMesh& mesh);
  Drawable drawable() const;

 private:
  Buffer positions_, normals_, indices_;
  std::uint32_t vertices_ = 0, index_count_ = 0;
};

/// The index buffer of a mesh whose vertices somebody else has.
Result<Buffer> create_indices(const Device& device, std::span<const weft::Triangle> triangles);

/// Writes under a temporary name and renames; makes the folder if there is none.
Result<void> write_png(const std::filesystem::path& file, VkExtent2D size, std::span<const std::byte> rgba);

}  // namespace host
