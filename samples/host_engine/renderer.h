// The host engine's own renderer: one pipeline, dynamic rendering, depth, four samples, an off-screen picture.
//
// Every vertex has a position and a normal in a buffer each, 16 bytes apart: Weft's format (engine/frame_view.h), so that
// a cloth is drawn by binding Weft's buffers, and the engine's own meshes are kept the same way.
#pragma once

#include <array>
#include <span>

#include "engine/frame_view.h"
#include "engine/vector.h"
#include "samples/host_engine/device.h"

namespace host {

using weft::Vec3;

/// Column by column, as GLSL has it.
using Mat4 = std::array<float, 16>;

struct Stage {
  Vec3 eye, target;   // m
  Vec3 sun;           // the way its light goes
};

/// What is drawn, by whom it may be owned.
struct Drawable {
  weft::FrameView positions, normals;
  VkBuffer indices = VK_NULL_HANDLE;   // 32 bits each
  std::uint32_t index_count = 0;
  Vec3 place;
  Vec3 scale{1, 1, 1};
  Vec3 colour;                         // linear
  bool casts = true;                   // a shadow on the floor, which is the plane y = 0
};

class Renderer {
 public:
  static Result<std::unique_ptr<Renderer>> create(const Device& device, VkExtent2D size);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Records a whole picture.
  void draw(VkCommandBuffer commands, const Stage& stage, std::span<const Drawable> drawables) const;
  /// Records the copy of the last picture to where pixels() shows it.
  void read_back(VkCommandBuffer commands) const;
  /// RGBA, the first row on top; of the last read_back that the GPU has finished.
  std::span<const std::byte> pixels() const;
  VkExtent2D size() const { return size_; }

 private:
  struct Target {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
  };
  explicit Renderer(const Device& device, VkExtent2D size) : device_(&device), size_(size) {}
  Result<void> create_target(Target& target, VkFormat format, VkSampleCountFlagBits samples, VkImageUsageFlags usage);
  Result<void> create_pipeline();
  void draw_one(VkCommandBuffer commands, const Drawable& what, const Mat4& to_clip, Vec3 colour, bool lit, Vec3 sun) const;

  const Device* device_;
  VkExtent2D size_;
  Target colour_, depth_, picture_;   // the first two with four samples, averaged into the picture
  Buffer pixels_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace host
