// The GPU that Weft works on: its own, or one borrowed from a host.
//
// An own device is picked by `DeviceChoice::name`; without a name the best one is taken (discrete, then integrated, then
// virtual, then the software driver), and name() says which. A borrowed device belongs to the host: nothing of it is
// destroyed, vkDeviceWaitIdle is never called, and its queue is touched only inside submit().
//
// Needed: Vulkan 1.1, of the instance and of the device, and a queue family with compute. No feature and no extension need be enabled.
// With synchronization2 and timelineSemaphore, of their versions of Vulkan or of their KHR extensions, Weft makes use of them: its
// barriers are then as fine as Features says, and the results are the same bits.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compute/features.h"
#include "compute/functions.h"
#include "compute/result.h"
#include "compute/specialize.h"

namespace weft::compute {

class SharedPasses;

struct DeviceChoice {
  /// "" takes the best device, a number the one with that index in list_devices(), anything else the best whose name
  /// contains it, upper and lower case alike.
  std::string name;
  /// Khronos validation with synchronization validation; the sentence says so if the layer is not installed.
  /// Under a layer before 1.3.243 no labels are recorded (compute/labels.h).
  bool validation = false;
  /// Also asks for Vulkan 1.3, dynamic rendering and a queue that draws. Without it a compute-only device is good enough, though
  /// both are still taken where there is a choice.
  bool graphics = false;
  /// For a window: what the window library asks for, and VK_KHR_swapchain.
  std::vector<std::string> instance_extensions;
  std::vector<std::string> device_extensions;
  /// Hears every validation message as it comes, also those at destruction; may be called from any thread.
  std::function<void(const std::string&)> on_validation_message;
};

/// What a host lends. All of it must outlive the Device. Other threads of the host must not use the queue while a
/// function of Weft that is documented to submit is running.
struct BorrowedDevice {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  /// What the host gave vkCreateDevice, looked at in borrow alone: features that it enables there are made use of, and those that the
  /// host's readers need (compute/readers.h) must be among them. Null: what the device supports is taken to be enabled, since Vulkan does
  /// not tell what a device was created with. Whoever has not enabled synchronization2 and timelineSemaphore, or does not know, as a
  /// plug-in of an engine, gives one that enables nothing: an empty VkDeviceCreateInfo.
  const VkDeviceCreateInfo* created_with = nullptr;
};

/// The limits that decide what fits on a device.
struct DeviceLimits {
  VkDeviceSize max_storage_buffer_bytes = 0;     ///< maxStorageBufferRange
  uint32_t max_texel_buffer_elements = 0;        ///< maxTexelBufferElements
  VkDeviceSize max_allocation_bytes = 0;         ///< maxMemoryAllocationSize
  VkDeviceSize max_buffer_bytes = 0;             ///< maxBufferSize (Vulkan 1.3); before that as max_allocation_bytes
  VkDeviceSize storage_buffer_alignment = 1;     ///< minStorageBufferOffsetAlignment
  VkDeviceSize texel_buffer_alignment = 1;       ///< minTexelBufferOffsetAlignment
  uint32_t max_storage_buffers_per_stage = 0;    ///< maxPerStageDescriptorStorageBuffers
  uint32_t max_push_constant_bytes = 0;          ///< maxPushConstantsSize
  uint32_t shared_memory_bytes = 0;              ///< maxComputeSharedMemorySize
  uint32_t max_workgroup_invocations = 0;        ///< maxComputeWorkGroupInvocations, and maxComputeWorkGroupSize[0]: they are rows
  uint32_t max_workgroups_x = 0;                 ///< maxComputeWorkGroupCount[0]
  uint32_t subgroup_size = 0;                    ///< lanes
  double timestamp_period_ns = 0;                ///< nanoseconds per tick; 0: the queue has no timestamps
  uint32_t timestamp_bits = 0;                   ///< valid bits of a timestamp
};

/// One line of `weft info`.
struct DeviceDescription {
  uint32_t index = 0;  ///< what DeviceChoice::name takes
  std::string name;
  std::string type;    ///< "discrete", "integrated", "virtual", "software" or "other"
  std::string api;     ///< "1.3.224"
  std::string driver;  ///< name and version, as the driver says them
  VkDeviceSize memory_bytes = 0;  ///< the largest device-local heap
  DeviceLimits limits;
  Features features;   ///< that it supports
  bool draws = false;  ///< Vulkan 1.3 with dynamicRendering, and a queue with graphics
  std::string refusal; ///< why Weft cannot use it; empty when it can
};

/// Every device the loader knows, in the loader's order. Errors: no loader, no driver, memory.
Result<std::vector<DeviceDescription>> list_devices();

class Device {
 public:
  /// Errors: no loader, no driver, no device that the choice names or that has what Weft needs; an extension or the validation layer that
  /// is wanted and not there; memory; what Vulkan refuses.
  static Result<std::unique_ptr<Device>> create(const DeviceChoice& choice = {});
  /// Errors: a handle that is null; an instance or a device without Vulkan 1.1; a queue family without compute; a Vulkan function that is
  /// missing; memory.
  static Result<std::unique_ptr<Device>> borrow(const BorrowedDevice& lent);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const Functions& vk() const;
  VkInstance instance() const;
  VkPhysicalDevice physical() const;
  VkDevice handle() const;
  VkQueue queue() const;
  uint32_t queue_family() const;
  /// What the queue family can do.
  VkQueueFlags queue_flags() const;
  /// Those that are enabled and that the device has the functions of. Of a borrowed device without BorrowedDevice::created_with only the
  /// host knows what is enabled; then it is what the device supports.
  const Features& features() const;

  const std::string& name() const;
  const DeviceDescription& description() const;
  const DeviceLimits& limits() const;
  const VkPhysicalDeviceProperties& properties() const;
  const VkPhysicalDeviceMemoryProperties& memory() const;
  /// A CPU that plays GPU (lavapipe, SwiftShader).
  bool is_software() const;
  /// Whether Shading can draw: Vulkan 1.3, a queue that draws, and synchronization2 and dynamicRendering among features().
  bool draws() const;
  bool is_borrowed() const;
  /// Nanoseconds per timestamp tick, 0 when the queue has no timestamps.
  double timestamp_period_ns() const;

  /// The name that validation, RenderDoc and crash dumps show. Does nothing without VK_EXT_debug_utils.
  template <class Handle>
  void name_object(VkObjectType type, Handle handle, std::string_view name) const {
    name_object_raw(type, reinterpret_cast<uint64_t>(handle), name);
  }

  /// The only place where the queue is touched. Serialised: any thread may call it. Without synchronization2 it goes to vkQueueSubmit
  /// (compute/synchronization.h). Errors: no memory, a lost device.
  Result<void> submit(const VkSubmitInfo2& work, VkFence fence = VK_NULL_HANDLE) const;
  /// Presents under the same lock; the caller reads VK_SUBOPTIMAL_KHR and VK_ERROR_OUT_OF_DATE_KHR from the result.
  VkResult present(const VkPresentInfoKHR& what) const;
  /// Waits for everything submitted; for destructors and tests of an own device. Does nothing on a borrowed one.
  void wait_idle() const;

  /// A submit or a wait has said VK_ERROR_DEVICE_LOST: nothing works on this device any more. Thread-safe.
  bool is_lost() const;
  /// `result`, remembered if it says that the device is lost; for those who call Vulkan's waits themselves.
  VkResult heard(VkResult result) const;

  /// What was specialised for this device, so that simulations share it.
  Specializer& specializer() const;

  /// What was compiled for it, likewise.
  SharedPasses& passes() const;

  /// Warnings and errors of the validation layers so far; empty when they are off. Thread-safe.
  std::vector<std::string> validation_messages() const;

 private:
  struct State;
  explicit Device(std::unique_ptr<State> state);
  void name_object_raw(VkObjectType type, uint64_t handle, std::string_view name) const noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace weft::compute
