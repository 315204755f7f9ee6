// See samples/host_engine/assets.h.
#include "samples/host_engine/assets.h"

#include <cmath>
#include <numbers>
#include <span>
#include <system_error>
#include <vector>

#include "compute/file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace host {

weft::RenderMesh sphere() {
  constexpr std::uint32_t kAround = 64, kDown = 32;
  weft::RenderMesh mesh;
  for (std::uint32_t j = 0; j <= kDown; ++j)
    for (std::uint32_t i = 0; i <= kAround; ++i) {
      const float along = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kAround;
      const float down = std::numbers::pi_v<float> * static_cast<float>(j) / kDown;
      mesh.positions.push_back({std::sin(down) * std::sin(along), std::cos(down), std::sin(down) * std::cos(along)});
    }
  mesh.normals = mesh.positions;
  for (std::uint32_t j = 0; j < kDown; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t a = j * (kAround + 1) + i, b = a + kAround + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  return mesh;
}

weft::RenderMesh box() {
  weft::RenderMesh mesh;
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3 out = side * axes[axis], u = side * axes[(axis + 1) % 3], v = axes[(axis + 2) % 3];
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const Vec3 corner : {out - u - v, out + u - v, out + u + v, out - u + v}) {
        mesh.positions.push_back(0.5f * corner);
        mesh.normals.push_back(out);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  return mesh;
}

Result<Buffer> create_indices(const Device& device, std::span<const weft::Triangle> triangles) {
  return Buffer::create(device, std::as_bytes(triangles), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
}

Result<Model> Model::create(const Device& device, const weft::RenderMesh& mesh) {
  const auto upload = [&](const std::vector<Vec3>& values) {
    std::vector<weft::Vec4> padded;
    for (const Vec3& v : values) padded.push_back({v.x, v.y, v.z, 0});
    return Buffer::create(device, std::as_bytes(std::span(padded)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  };
  auto positions = upload(mesh.positions), normals = upload(mesh.normals), indices = create_indices(device, mesh.triangles);
  for (auto* made : {&positions, &normals, &indices})
    if (!*made) return made->take_error();
  Model model;
  model.positions_ = std::move(*positions);
  model.normals_ = std::move(*normals);
  model.indices_ = std::move(*indices);
  model.vertices_ = static_cast<std::uint32_t>(mesh.positions.size());
  model.index_count_ = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  return model;
}

Drawable Model::drawable() const {
  Drawable drawable;
  drawable.positions.buffer = positions_.handle();
  drawable.normals.buffer = normals_.handle();
  drawable.positions.count = drawable.normals.count = vertices_;
  drawable.indices = indices_.handle();
  drawable.index_count = index_count_;
  return drawable;
}

Result<void> write_png(const std::filesystem::path& file, VkExtent2D size, std::span<const std::byte> rgba) {
  std::error_code code;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), code);
  if (code) return fail("the folder ", file.parent_path().string(), " cannot be made: ", code.message());
  std::vector<char> bytes;
  const auto append = [](void* to, void* from, int count) {
    const char* first = static_cast<const char*>(from);
    static_cast<std::vector<char>*>(to)->insert(static_cast<std::vector<char>*>(to)->end(), first, first + count);
  };
  const auto width = static_cast<int>(size.width), height = static_cast<int>(size.height);
  if (stbi_write_png_to_func(append, &bytes, width, height, 4, rgba.data(), 4 * width) == 0)
    return fail(file.string(), " could not be encoded");
  return weft::write_file(file, std::as_bytes(std::span(bytes)));
}

}  // namespace host
