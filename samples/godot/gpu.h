// Godot's Vulkan device, lent to Weft, and the few Vulkan objects of this plug-in's own. All of it is for Godot's render thread alone.
#pragma once

#include <memory>
#include <vector>

#include "engine/simulation.h"
#include "samples/godot/godot.h"

namespace weft_godot {

/// Borrows the device on which Godot draws. Errors: a Godot that draws otherwise (headless, Compatibility, Direct3D 12, Metal); what
/// Device::borrow names.
weft::Result<std::unique_ptr<weft::compute::Device>> borrow_device();

/// A buffer that the CPU reads, mapped.
struct ReadBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const float* floats = nullptr;
};
weft::Result<ReadBuffer> make_read_buffer(const weft::compute::Device& device, VkDeviceSize bytes);
void destroy(const weft::compute::Device& device, const ReadBuffer& buffer);

/// Commands for Godot's queue: a few command buffers, each with a fence. What is submitted on the render thread comes before what Godot
/// draws afterwards.
class Commands {
 public:
  static constexpr std::size_t kUnderWay = 3;
  static weft::Result<std::unique_ptr<Commands>> create(const weft::compute::Device& device);
  ~Commands();   // waits
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// A command buffer that is being recorded, and its number below kUnderWay; waits until its last commands are done.
  struct Begun {
    VkCommandBuffer commands;
    std::size_t place;
  };
  weft::Result<Begun> begin();
  weft::Result<void> submit();
  /// Whether the last commands of a place are done; true where there were none.
  bool is_done(std::size_t place) const;
  void wait();

 private:
  explicit Commands(const weft::compute::Device& device) : device_(&device) {}
  struct Place {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    bool is_under_way = false;
  };
  const weft::compute::Device* device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::array<Place, kUnderWay> places_;
  std::size_t next_ = 0;
};

}  // namespace weft_godot
