// See samples/host_engine/device.h.
#include "samples/host_engine/device.h"

#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace host {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL hear(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* said, void* user) {
  ++static_cast<Complaints*>(user)->count;
  std::fprintf(stderr, "validation: %s\n", said->pMessage);
  return VK_FALSE;
}

// A family that draws and computes, or none.
bool find_family(VkPhysicalDevice physical, std::uint32_t& family) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  constexpr VkQueueFlags kBoth = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (family = 0; family < count; ++family)
    if ((families[family].queueFlags & kBoth) == kBoth) return true;
  return false;
}

int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 3;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 1;
    default: return 0;
  }
}

bool is_number(const std::string& text) { return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos; }

}  // namespace

Result<std::unique_ptr<Device>> Device::create(const DeviceRequest& request) {
  std::unique_ptr<Device> made(new Device);
  if (auto done = made->create_instance(request); !done) return done.take_error();
  if (auto done = made->pick(request.name); !done) return done.take_error();
  if (auto done = made->create_device(); !done) return done.take_error();
  return made;
}

Result<void> Device::create_instance(const DeviceRequest& request) {
  auto application = typed<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "host_engine";
  application.apiVersion = VK_API_VERSION_1_3;
  auto create = typed<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  create.pApplicationInfo = &application;

  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  auto messenger = typed<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = hear;
  messenger.pUserData = request.validation;
  const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  auto features = typed<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.pNext = &messenger;   // hears what happens at the instance's creation and end
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enabled;
  if (request.validation != nullptr) {
    create.pNext = &features;
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &kValidationLayer;
    create.enabledExtensionCount = 2;
    create.ppEnabledExtensionNames = extensions;
  }
  const VkResult result = vkCreateInstance(&create, nullptr, &instance_);
  if (result == VK_ERROR_LAYER_NOT_PRESENT)
    return fail("validation was asked for, and the layer ", kValidationLayer,
                " is not installed: on Debian, apt install vulkan-validationlayers");
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    return fail("no Vulkan driver is installed: on Debian, apt install mesa-vulkan-drivers brings one that needs no GPU");
  if (auto done = checked(result, "vkCreateInstance"); !done) return done;
  if (request.validation == nullptr) return {};
  const auto create_messenger =
      reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  return checked(create_messenger(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

Result<void> Device::pick(const std::string& name) {
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance_, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance_, &count, devices.data());
  int best = -1;
  for (std::uint32_t k = 0; k < count; ++k) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[k], &properties);
    const bool wanted =
        is_number(name) ? name == std::to_string(k) : std::string_view(properties.deviceName).find(name) != std::string_view::npos;
    std::uint32_t family = 0;
    if (!wanted || properties.apiVersion < VK_API_VERSION_1_3 || !find_family(devices[k], family)) continue;
    if (rank(properties.deviceType) <= best) continue;
    best = rank(properties.deviceType);
    physical_ = devices[k];
    family_ = family;
  }
  if (best >= 0) return {};
  if (name.empty()) return fail("none of ", count, " Vulkan devices has Vulkan 1.3 and a queue that draws and computes");
  return fail("none of ", count, " Vulkan devices that draw and compute is called \"", name, "\"");
}

Result<void> Device::create_device() {
  auto v13 = typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  v13.synchronization2 = VK_TRUE;    // Weft makes use of it, too
  v13.dynamicRendering = VK_TRUE;    // the engine's renderer only
  auto v12 = typed<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  v12.pNext = &v13;
  v12.timelineSemaphore = VK_TRUE;   // and of this
  const float priority = 1;
  auto queue = typed<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto create = typed<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  create.pNext = &v12;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  if (auto done = checked(vkCreateDevice(physical_, &create, nullptr, &device_), "vkCreateDevice"); !done) return done;
  vkGetDeviceQueue(device_, family_, 0, &queue_);
  return {};
}

Device::~Device() {
  if (device_ != VK_NULL_HANDLE) {
    vkDeviceWaitIdle(device_);
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy =
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

std::string Device::name() const {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical_, &properties);
  return properties.deviceName;
}

Result<std::uint32_t> Device::memory_type(std::uint32_t types, VkMemoryPropertyFlags wanted) const {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
  for (std::uint32_t k = 0; k < memory.memoryTypeCount; ++k)
    if ((types >> k & 1) != 0 && (memory.memoryTypes[k].propertyFlags & wanted) == wanted) return k;
  return fail(name(), " has no memory with the properties ", wanted);
}

Result<void> Device::submit(const VkSubmitInfo2& work) const {
  return checked(vkQueueSubmit2(queue_, 1, &work, VK_NULL_HANDLE), "vkQueueSubmit2");
}

weft::compute::BorrowedDevice Device::lend() const {
  return {.get_instance_proc_addr = vkGetInstanceProcAddr, .instance = instance_, .physical = physical_, .device = device_, .queue = queue_,
          .queue_family = family_};
}

Result<Buffer> Buffer::create(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage) {
  Buffer made;
  made.device_ = device.handle();
  auto create = typed<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  create.size = bytes;
  create.usage = usage;
  if (auto done = checked(vkCreateBuffer(device.handle(), &create, nullptr, &made.buffer_), "vkCreateBuffer"); !done)
    return done.take_error();
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.handle(), made.buffer_, &needs);
  auto type = device.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  if (!type) return type.take_error();
  auto allocate = typed<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = *type;
  if (auto done = checked(vkAllocateMemory(device.handle(), &allocate, nullptr, &made.memory_), "vkAllocateMemory"); !done)
    return done.take_error();
  if (auto done = checked(vkBindBufferMemory(device.handle(), made.buffer_, made.memory_, 0), "vkBindBufferMemory"); !done)
    return done.take_error();
  void* mapped = nullptr;
  if (auto done = checked(vkMapMemory(device.handle(), made.memory_, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory"); !done)
    return done.take_error();
  made.mapped_ = static_cast<std::byte*>(mapped);
  return made;
}

Result<Buffer> Buffer::create(const Device& device, std::span<const std::byte> contents, VkBufferUsageFlags usage) {
  auto made = create(device, contents.size(), usage);
  if (made) std::memcpy(made->mapped(), contents.data(), contents.size());
  return made;
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

Buffer::~Buffer() {
  if (device_ == VK_NULL_HANDLE) return;
  vkDestroyBuffer(device_, buffer_, nullptr);
  vkFreeMemory(device_, memory_, nullptr);
}

}  // namespace host
