// A window with a Vulkan device behind it: events in, pictures out, and an interface drawn over them.
//
// A frame: poll(), begin(), the commands of a picture, finish(). The picture is an image of any size; finish() stretches it over the
// window, draws what Dear ImGui has collected, and presents. One frame is under way at a time: what a click changes is in the next.
#pragma once

#include <vulkan/vulkan.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compute/commands.h"
#include "compute/device.h"

struct GLFWwindow;

namespace weft::view {

/// A key that went down, or repeats: GLFW's numbers.
struct Key {
  int key = 0;
  bool with_control = false, again = false;
};

/// What the pointer did, in the order in which it did: however slow frames are, a press is where it was.
struct Pointed {
  enum class What { moved, pressed, released, scrolled };
  What what = What::moved;
  int button = 0;                   // GLFW's number
  double x = 0, y = 0;              // in screen coordinates, from the window's upper left corner; scrolled: notches
  bool with_control = false, with_shift = false;
};

struct WindowRequest {
  std::string title;
  int width = 1280, height = 800;   // in screen coordinates
  std::string device;               // as compute::DeviceChoice::name
  bool validation = false;
};

class Window {
 public:
  /// Errors: no display; no device that draws and can present to it; what Vulkan refuses.
  static Result<std::unique_ptr<Window>> create(const WindowRequest& request);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  const compute::Device& device() const { return *device_; }
  compute::Device& device() { return *device_; }
  VkExtent2D size() const { return size_; }   // pixels of what is presented
  /// Neither is drawn.
  bool is_minimised() const;
  bool wants_to_close() const;
  void close();
  void set_title(const std::string& title);

  /// Hears what the user did; waits for up to `seconds` where nothing was.
  void poll(double seconds);
  /// Whether the user did anything, or the window must be drawn again, since the last call.
  bool take_heard() { return std::exchange(is_heard_, false); }
  /// Keys since the last call: all of them, also those that were up again before a frame saw them down.
  std::vector<Key> take_keys();
  std::vector<Pointed> take_pointed();
  /// Files dropped since the last call.
  std::vector<std::filesystem::path> take_dropped();

  /// Waits for the frame before, and begins one of Dear ImGui's. Nothing where there is nothing to draw into: minimised, or changing its
  /// size.
  Result<std::optional<VkCommandBuffer>> begin();
  /// `picture` in the layout TRANSFER_SRC_OPTIMAL, of `extent` pixels. Returns when it is presented and done.
  Result<void> finish(VkImage picture, VkExtent2D extent);
  /// Waits for the last frame.
  Result<void> wait();
  /// Milliseconds from the last frame's submit until it was done; 0 before the first.
  double drawn_ms() const { return drawn_ms_; }

 private:
  Window() = default;
  Result<void> create_surface(const WindowRequest& request);
  void listen();
  static Window& of(GLFWwindow* window);
  Result<void> create_frame();
  Result<void> create_interface();
  Result<void> create_letters();
  Result<void> create_swapchain();
  void destroy_swapchain();

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<compute::Device> device_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D size_{};
  struct Target {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    compute::OwnedSemaphore drawn;   // presenting waits for it: one an image, as nothing else says when it is free again
  };
  std::vector<Target> targets_;
  compute::CommandPool pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  compute::OwnedSemaphore acquired_;
  compute::OwnedFence fence_;
  std::uint32_t target_ = 0;
  bool is_under_way_ = false, is_stale_ = false, has_interface_ = false, has_letters_ = false, is_heard_ = true;
  double drawn_ms_ = 0;
  std::vector<std::filesystem::path> dropped_;
  std::vector<Key> keys_;
  std::vector<Pointed> pointed_;
  double x_ = 0, y_ = 0;   // of the pointer, as last heard
};

}  // namespace weft::view
