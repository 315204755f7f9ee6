// Creates or borrows the device. See device.h.
#include "compute/device.h"

#include <atomic>
#include <mutex>
#include <optional>
#include <utility>

#include "compute/inventory.h"
#include "compute/labels.h"
#include "compute/shared_passes.h"
#include "compute/synchronization.h"

namespace weft::compute {

struct Device::State {
  std::optional<Instance> own;  // empty when borrowed
  Functions fn;
  VkInstance instance = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  Candidate candidate;
  Features features;            // enabled
  mutable std::mutex queue_mutex;
  mutable std::atomic<bool> lost = false;
  mutable Specializer specializer;
  mutable SharedPasses passes;

  ~State() {
    if (!own || device == VK_NULL_HANDLE) return;
    // Null only when the device lacked functions: there is then nothing to call.
    if (fn.vkDeviceWaitIdle != nullptr) fn.vkDeviceWaitIdle(device);
    if (fn.vkDestroyDevice != nullptr) fn.vkDestroyDevice(device, nullptr);
  }
};

Result<std::vector<DeviceDescription>> list_devices() try {
  Result<Instance> instance = Instance::create({});
  if (!instance) return instance.take_error();
  Result<std::vector<Candidate>> candidates = find_candidates(instance->functions(), instance->handle());
  if (!candidates) return candidates.take_error();
  std::vector<DeviceDescription> descriptions;
  for (const Candidate& candidate : *candidates) descriptions.push_back(candidate.description);
  return descriptions;
} catch (...) {
  return caught("the Vulkan devices");
}

namespace {

Result<VkDevice> create_device(const Functions& fn, const Candidate& candidate, const DeviceChoice& choice, Features& enabled) {
  uint32_t count = 0;
  fn.vkEnumerateDeviceExtensionProperties(candidate.physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> offered(count);
  fn.vkEnumerateDeviceExtensionProperties(candidate.physical, nullptr, &count, offered.data());
  std::vector<const char*> extensions;
  for (const std::string& wanted : choice.device_extensions) {
    bool found = false;
    for (const VkExtensionProperties& extension : offered) found = found || wanted == extension.extensionName;
    if (!found) return fail("the Vulkan device ", candidate.description.name, " has no extension ", wanted);
    extensions.push_back(wanted.c_str());
  }

  // Those that Weft makes use of, as far as there are any.
  auto v13 = typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  v13.synchronization2 = candidate.description.features.synchronization2;
  v13.dynamicRendering = candidate.description.draws;
  auto v12 = typed<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  if (candidate.version >= VK_API_VERSION_1_3) v12.pNext = &v13;
  v12.timelineSemaphore = candidate.description.features.timeline_semaphore;
  const float priority = 1.0f;
  auto queue = typed<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = candidate.queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto create = typed<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  if (candidate.version >= VK_API_VERSION_1_2) create.pNext = &v12;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  create.ppEnabledExtensionNames = extensions.data();
  enabled = enabled_features(create);
  VkDevice device = VK_NULL_HANDLE;
  const VkResult result = fn.vkCreateDevice(candidate.physical, &create, nullptr, &device);
  if (result != VK_SUCCESS) {
    return fail("the Vulkan device ", candidate.description.name, " could not be created: ", result_name(result));
  }
  return device;
}

// A feature is of use with its functions alone: a host may have enabled it for a version of Vulkan that its instance does not ask for.
void drop_features_without_functions(const Functions& fn, Features& features) {
  features.synchronization2 &= fn.vkQueueSubmit2 != nullptr && fn.vkCmdPipelineBarrier2 != nullptr;
  features.timeline_semaphore &= fn.vkWaitSemaphores != nullptr && fn.vkGetSemaphoreCounterValue != nullptr;
  features.dynamic_rendering &= fn.vkCmdBeginRendering != nullptr && fn.vkCmdEndRendering != nullptr;
}

void drop_labels_unless_they_hold(Functions& fn, VkInstance instance, VkPhysicalDevice physical) {
  if (labels_hold(fn, instance, physical)) return;
  fn.vkCmdBeginDebugUtilsLabelEXT = nullptr;
  fn.vkCmdEndDebugUtilsLabelEXT = nullptr;
}

}  // namespace

Result<std::unique_ptr<Device>> Device::create(const DeviceChoice& choice) try {
  Result<Instance> instance = Instance::create(choice);
  if (!instance) return instance.take_error();
  Result<std::vector<Candidate>> candidates = find_candidates(instance->functions(), instance->handle());
  if (!candidates) return candidates.take_error();
  std::vector<DeviceDescription> descriptions;
  for (const Candidate& candidate : *candidates) descriptions.push_back(candidate.description);
  Result<uint32_t> index = choose_device(descriptions, choice.name, choice.graphics);
  if (!index) return index.take_error();

  auto state = std::make_unique<State>();
  state->own.emplace(std::move(*instance));
  state->fn = state->own->functions();
  state->instance = state->own->handle();
  state->candidate = (*candidates)[*index];
  Result<VkDevice> device = create_device(state->fn, state->candidate, choice, state->features);
  if (!device) return device.take_error();
  state->device = *device;
  if (Result<void> loaded = state->fn.load_device(*device); !loaded) return loaded.take_error();
  drop_features_without_functions(state->fn, state->features);
  drop_labels_unless_they_hold(state->fn, state->instance, state->candidate.physical);
  state->fn.vkGetDeviceQueue(state->device, state->candidate.queue_family, 0, &state->queue);
  return std::unique_ptr<Device>(new Device(std::move(state)));
} catch (...) {
  return caught("the Vulkan device");
}

Result<std::unique_ptr<Device>> Device::borrow(const BorrowedDevice& lent) try {
  const auto absent = [](const char* what) { return fail("the device lent to Weft has no ", what, " (it is null)"); };
  if (lent.get_instance_proc_addr == nullptr) return absent("vkGetInstanceProcAddr");
  if (lent.instance == VK_NULL_HANDLE) return absent("VkInstance");
  if (lent.physical == VK_NULL_HANDLE) return absent("VkPhysicalDevice");
  if (lent.device == VK_NULL_HANDLE) return absent("VkDevice");
  if (lent.queue == VK_NULL_HANDLE) return absent("VkQueue");
  auto state = std::make_unique<State>();
  state->fn.vkGetInstanceProcAddr = lent.get_instance_proc_addr;
  if (Result<void> loaded = state->fn.load_instance(lent.instance); !loaded) return loaded.take_error();
  if (Result<void> loaded = state->fn.load_device(lent.device); !loaded) return loaded.take_error();
  drop_labels_unless_they_hold(state->fn, lent.instance, lent.physical);
  state->candidate = describe(state->fn, lent.physical, 0, {lent.queue_family, state->fn.version_of(lent.device)});
  const DeviceDescription& description = state->candidate.description;
  if (!description.refusal.empty()) {
    return fail("the device lent to Weft, ", description.name, ", cannot be used: ", description.refusal);
  }
  state->features = lent.created_with != nullptr ? enabled_features(*lent.created_with) : state->candidate.description.features;
  drop_features_without_functions(state->fn, state->features);
  state->instance = lent.instance;
  state->device = lent.device;
  state->queue = lent.queue;
  return std::unique_ptr<Device>(new Device(std::move(state)));
} catch (...) {
  return caught("the borrowed Vulkan device");
}

Device::Device(std::unique_ptr<State> state) : state_(std::move(state)) {}
Device::~Device() {
  if (!state_) return;
  wait_idle();
  state_->passes.clear();   // while there is a device to ask
}

const Functions& Device::vk() const { return state_->fn; }
VkInstance Device::instance() const { return state_->instance; }
VkPhysicalDevice Device::physical() const { return state_->candidate.physical; }
VkDevice Device::handle() const { return state_->device; }
VkQueue Device::queue() const { return state_->queue; }
uint32_t Device::queue_family() const { return state_->candidate.queue_family; }
VkQueueFlags Device::queue_flags() const { return state_->candidate.queue_flags; }
const Features& Device::features() const { return state_->features; }
const std::string& Device::name() const { return state_->candidate.description.name; }
const DeviceDescription& Device::description() const { return state_->candidate.description; }
const DeviceLimits& Device::limits() const { return state_->candidate.description.limits; }
const VkPhysicalDeviceProperties& Device::properties() const { return state_->candidate.properties; }
const VkPhysicalDeviceMemoryProperties& Device::memory() const { return state_->candidate.memory; }
bool Device::is_software() const { return properties().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
bool Device::draws() const { return can_draw(state_->candidate, features()); }
bool Device::is_borrowed() const { return !state_->own; }
double Device::timestamp_period_ns() const { return limits().timestamp_period_ns; }

// Called with handles that nobody owns yet. Where there is no memory for a name, the object has none.
void Device::name_object_raw(VkObjectType type, uint64_t handle, std::string_view name) const noexcept try {
  if (vk().vkSetDebugUtilsObjectNameEXT == nullptr || handle == 0) return;
  const std::string text(name);
  auto named = typed<VkDebugUtilsObjectNameInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT);
  named.objectType = type;
  named.objectHandle = handle;
  named.pObjectName = text.c_str();
  vk().vkSetDebugUtilsObjectNameEXT(this->handle(), &named);
} catch (const std::bad_alloc&) {
}

Result<void> Device::submit(const VkSubmitInfo2& work, VkFence fence) const try {
  const std::lock_guard lock(state_->queue_mutex);
  const VkResult result = heard(submit_to(vk(), features(), queue(), work, fence));
  if (result != VK_SUCCESS) return fail("submitting to ", name(), " failed: ", result_name(result));
  return {};
} catch (...) {
  return caught("a submit");
}

VkResult Device::present(const VkPresentInfoKHR& what) const {
  const std::lock_guard lock(state_->queue_mutex);
  return heard(vk().vkQueuePresentKHR(queue(), &what));
}

void Device::wait_idle() const {
  if (is_borrowed()) return;
  const std::lock_guard lock(state_->queue_mutex);
  vk().vkDeviceWaitIdle(handle());
}

Specializer& Device::specializer() const { return state_->specializer; }
SharedPasses& Device::passes() const { return state_->passes; }
bool Device::is_lost() const { return state_->lost; }

VkResult Device::heard(VkResult result) const {
  if (result == VK_ERROR_DEVICE_LOST) state_->lost = true;
  return result;
}

std::vector<std::string> Device::validation_messages() const {
  if (!state_->own) return {};
  const Messages& messages = state_->own->messages();
  const std::lock_guard lock(messages.mutex);
  return messages.heard;
}

}  // namespace weft::compute
