// See samples/godot/gpu.h.
#include "samples/godot/gpu.h"

#include <dlfcn.h>

#include <string_view>

namespace weft_godot {
namespace {

using godot::Variant;
using weft::fail;
using weft::Result;
using weft::compute::Device;

constexpr std::uint64_t kLongest = 10'000'000'000;   // ns

// RenderingDevice::DriverResource
enum Resource { kDevice = 0, kPhysical = 1, kInstance = 2, kQueue = 3, kFamily = 4 };

template <class Handle>
Handle handle(const Variant& device, Resource which) {
  return reinterpret_cast<Handle>(device.call("get_driver_resource", int(which), godot::Rid{}, 0).to_int());
}

std::uint32_t memory_type(const Device& device, std::uint32_t among, VkMemoryPropertyFlags wanted) {
  for (std::uint32_t k = 0; k < device.memory().memoryTypeCount; ++k)
    if ((among >> k & 1) && (device.memory().memoryTypes[k].propertyFlags & wanted) == wanted) return k;
  return weft::kNone;
}

// The loader's, without names of objects: a layer gives these functions also where Godot's instance has not enabled VK_EXT_debug_utils, and
// then complains when they are called.
PFN_vkGetInstanceProcAddr instance_function = nullptr;
PFN_vkGetDeviceProcAddr device_function = nullptr;

bool is_left_out(const char* name) { return std::string_view(name).find("DebugUtils") != std::string_view::npos; }

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_for_device(VkDevice device, const char* name) {
  return is_left_out(name) ? nullptr : device_function(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find(VkInstance instance, const char* name) {
  if (is_left_out(name)) return nullptr;
  const PFN_vkVoidFunction found = instance_function(instance, name);
  if (found == nullptr || std::string_view(name) != "vkGetDeviceProcAddr") return found;
  device_function = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(find_for_device);
}

}  // namespace

Result<std::unique_ptr<Device>> borrow_device() {
  const Variant server = godot::singleton("RenderingServer");
  const Variant device = server.call("get_rendering_device");
  if (device.to_object() == nullptr)
    return fail(weft::ErrorKind::other,
                "Godot draws without a RenderingDevice (the Compatibility renderer, or headless): Weft needs the renderer "
                "Mobile or Forward+ with Vulkan");
  if (const std::string driver = server.call("get_current_rendering_driver_name").to_string(); driver != "vulkan")
    return fail(weft::ErrorKind::other, "Godot draws with ", driver, ": Weft needs its rendering driver vulkan");
  weft::compute::BorrowedDevice lent;
  // Godot has the loader open already.
  void* loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader == nullptr) return fail(weft::ErrorKind::other, "the Vulkan loader libvulkan.so.1 cannot be opened: ", dlerror());
  instance_function = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader, "vkGetInstanceProcAddr"));
  if (instance_function == nullptr) return fail(weft::ErrorKind::other, "libvulkan.so.1 has no vkGetInstanceProcAddr");
  lent.get_instance_proc_addr = find;
  lent.instance = handle<VkInstance>(device, kInstance);
  lent.physical = handle<VkPhysicalDevice>(device, kPhysical);
  lent.device = handle<VkDevice>(device, kDevice);
  lent.queue = handle<VkQueue>(device, kQueue);
  lent.queue_family = static_cast<std::uint32_t>(device.call("get_driver_resource", int(kFamily), godot::Rid{}, 0).to_int());
  const VkDeviceCreateInfo nothing_known{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, nullptr, 0, 0, nullptr, 0, nullptr, 0, nullptr, nullptr};
  lent.created_with = &nothing_known;
  return Device::borrow(lent);
}

Result<ReadBuffer> make_read_buffer(const Device& device, VkDeviceSize bytes) {
  const weft::compute::Functions& vk = device.vk();
  ReadBuffer made;
  const VkBufferCreateInfo info{
      VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, nullptr, 0, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, VK_SHARING_MODE_EXCLUSIVE, 0, nullptr};
  if (vk.vkCreateBuffer(device.handle(), &info, nullptr, &made.buffer) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a buffer of ", bytes, " bytes cannot be made");
  VkMemoryRequirements needed;
  vk.vkGetBufferMemoryRequirements(device.handle(), made.buffer, &needed);
  const std::uint32_t type =
      memory_type(device, needed.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  const VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needed.size, type};
  void* mapped = nullptr;
  if (type == weft::kNone || vk.vkAllocateMemory(device.handle(), &allocate, nullptr, &made.memory) != VK_SUCCESS ||
      vk.vkBindBufferMemory(device.handle(), made.buffer, made.memory, 0) != VK_SUCCESS ||
      vk.vkMapMemory(device.handle(), made.memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
    destroy(device, made);
    return fail(weft::ErrorKind::memory, "there is no memory of ", bytes, " bytes that the CPU can read");
  }
  made.floats = static_cast<const float*>(mapped);
  return made;
}

void destroy(const Device& device, const ReadBuffer& buffer) {
  device.vk().vkDestroyBuffer(device.handle(), buffer.buffer, nullptr);
  device.vk().vkFreeMemory(device.handle(), buffer.memory, nullptr);
}

Result<std::unique_ptr<Commands>> Commands::create(const Device& device) {
  const weft::compute::Functions& vk = device.vk();
  std::unique_ptr<Commands> made(new Commands(device));
  const VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     device.queue_family()};
  if (vk.vkCreateCommandPool(device.handle(), &pool, nullptr, &made->pool_) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a command pool cannot be made");
  for (Place& place : made->places_) {
    const VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, made->pool_,
                                               VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    if (vk.vkAllocateCommandBuffers(device.handle(), &allocate, &place.commands) != VK_SUCCESS ||
        vk.vkCreateFence(device.handle(), &fence, nullptr, &place.fence) != VK_SUCCESS)
      return fail(weft::ErrorKind::memory, "a command buffer cannot be made");
  }
  return made;
}

Commands::~Commands() {
  wait();
  for (const Place& place : places_) device_->vk().vkDestroyFence(device_->handle(), place.fence, nullptr);
  device_->vk().vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

Result<Commands::Begun> Commands::begin() {
  const weft::compute::Functions& vk = device_->vk();
  Place& place = places_[next_];
  if (place.is_under_way) {
    if (const VkResult waited = vk.vkWaitForFences(device_->handle(), 1, &place.fence, VK_TRUE, kLongest); waited != VK_SUCCESS)
      return fail("an earlier tick is not done: ", weft::compute::result_name(device_->heard(waited)));
    vk.vkResetFences(device_->handle(), 1, &place.fence);
    place.is_under_way = false;
  }
  const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                       nullptr};
  if (const VkResult begun = vk.vkBeginCommandBuffer(place.commands, &begin); begun != VK_SUCCESS)
    return fail("a command buffer cannot be begun: ", weft::compute::result_name(begun));
  return Begun{place.commands, next_};
}

Result<void> Commands::submit() {
  const weft::compute::Functions& vk = device_->vk();
  Place& place = places_[next_];
  if (const VkResult ended = vk.vkEndCommandBuffer(place.commands); ended != VK_SUCCESS)
    return fail("a command buffer cannot be ended: ", weft::compute::result_name(ended));
  const VkSubmitInfo work{VK_STRUCTURE_TYPE_SUBMIT_INFO, nullptr, 0, nullptr, nullptr, 1, &place.commands, 0, nullptr};
  if (const VkResult submitted = vk.vkQueueSubmit(device_->queue(), 1, &work, place.fence); submitted != VK_SUCCESS)
    return fail("a tick cannot be submitted: ", weft::compute::result_name(device_->heard(submitted)));
  place.is_under_way = true;
  next_ = (next_ + 1) % kUnderWay;
  return {};
}

bool Commands::is_done(std::size_t k) const {
  const Place& place = places_[k];
  return !place.is_under_way || device_->vk().vkGetFenceStatus(device_->handle(), place.fence) == VK_SUCCESS;
}

void Commands::wait() {
  for (const Place& place : places_)
    if (place.is_under_way) device_->heard(device_->vk().vkWaitForFences(device_->handle(), 1, &place.fence, VK_TRUE, kLongest));
}

}  // namespace weft_godot
