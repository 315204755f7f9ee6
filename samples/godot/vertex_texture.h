// The vertices of a simulation as a texture that Godot's shaders fetch: Godot 4.6 does not lend the vertex buffers of its meshes.
//
//   an array of RGBA32F, kSlots times two layers: positions, normals. A vertex is the texel (v % kWidth, v / kWidth).
//
// A slot holds the end of a tick. What is drawn lies between two ticks, and motion vectors ask where it was drawn before: that is up to
// four slots at once, of which the newest tick's is no other than one of the last drawn ones where nothing was drawn since.
#pragma once

#include "samples/godot/gpu.h"

namespace weft_godot {

class VertexTexture {
 public:
  static constexpr std::uint32_t kWidth = 1024, kSlots = 4;
  static weft::Result<std::unique_ptr<VertexTexture>> create(const weft::Simulation& simulation);
  /// Godot's draws with it must be done.
  ~VertexTexture();
  VertexTexture(const VertexTexture&) = delete;
  VertexTexture& operator=(const VertexTexture&) = delete;

  /// Behind a frame of the simulation.
  void record(VkCommandBuffer commands, std::uint32_t slot);
  /// As Godot's RenderingDevice knows it.
  godot::Rid rid() const { return rid_; }
  /// Godot forgets it; its image is still there.
  void free_rid();

 private:
  VertexTexture(const weft::compute::Device& device, const weft::FrameView& positions, const weft::FrameView& normals)
      : device_(&device), positions_(positions), normals_(normals) {}
  weft::Result<void> make_image();
  void copy(VkCommandBuffer commands, const weft::FrameView& from, std::uint32_t layer) const;
  void barrier(VkCommandBuffer commands, std::uint32_t first, std::uint32_t layers, bool before) const;

  const weft::compute::Device* device_;
  weft::FrameView positions_, normals_;
  std::uint32_t rows_ = 0;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  bool is_new_ = true;
  godot::Rid rid_;
};

}  // namespace weft_godot
