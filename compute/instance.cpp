// An instance of Weft's own, with validation when asked for. See inventory.h.
#include <cstring>
#include <utility>

#include "compute/inventory.h"

namespace weft::compute {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL hear(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* said, void* user) try {
  Messages& messages = *static_cast<Messages*>(user);
  const std::string text = said->pMessage != nullptr ? said->pMessage : "a validation message without text";
  {
    const std::lock_guard lock(messages.mutex);
    messages.heard.push_back(text);
  }
  if (messages.listener) messages.listener(text);
  return VK_FALSE;
} catch (const std::bad_alloc&) {   // nothing may be thrown through a driver
  return VK_FALSE;
}

std::vector<VkExtensionProperties> extensions_of(const Functions& fn, const char* layer) {
  uint32_t count = 0;
  if (fn.vkEnumerateInstanceExtensionProperties(layer, &count, nullptr) != VK_SUCCESS) return {};
  std::vector<VkExtensionProperties> found(count);
  if (fn.vkEnumerateInstanceExtensionProperties(layer, &count, found.data()) != VK_SUCCESS) return {};
  return found;
}

bool contains(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
  for (const VkExtensionProperties& extension : extensions) {
    if (name == extension.extensionName) return true;
  }
  return false;
}

bool has_layer(const Functions& fn, std::string_view name) {
  uint32_t count = 0;
  if (fn.vkEnumerateInstanceLayerProperties(&count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkLayerProperties> layers(count);
  if (fn.vkEnumerateInstanceLayerProperties(&count, layers.data()) != VK_SUCCESS) return false;
  for (const VkLayerProperties& layer : layers) {
    if (name == layer.layerName) return true;
  }
  return false;
}

}  // namespace

Result<Instance> Instance::create(const DeviceChoice& choice, uint32_t version) {
  Result<Loader> loader = Loader::open();
  if (!loader) return loader.take_error();
  Instance made(std::move(*loader));
  Functions& fn = made.functions_;
  if (Result<void> loaded = fn.load_global(made.loader_.get_instance_proc_addr()); !loaded) return loaded.take_error();

  std::vector<VkExtensionProperties> offered = extensions_of(fn, nullptr);
  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  if (choice.validation) {
    if (!has_layer(fn, kValidationLayer)) {
      return fail(ErrorKind::other, "validation was asked for, and the layer ", kValidationLayer,
                  " is not installed: on Debian, apt install vulkan-validationlayers");
    }
    layers.push_back(kValidationLayer);
    for (const VkExtensionProperties& extension : extensions_of(fn, kValidationLayer)) offered.push_back(extension);
    for (const char* needed : {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME}) {
      if (!contains(offered, needed)) {
        return fail(ErrorKind::other, "validation was asked for, and neither the loader nor ", kValidationLayer, " has ", needed);
      }
    }
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  if (contains(offered, VK_EXT_DEBUG_UTILS_EXTENSION_NAME)) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  for (const std::string& wanted : choice.instance_extensions) {
    if (!contains(offered, wanted)) return fail(ErrorKind::other, "the Vulkan instance extension ", wanted, " is not available");
    extensions.push_back(wanted.c_str());
  }

  made.messages_ = std::make_unique<Messages>();
  made.messages_->listener = choice.on_validation_message;
  auto messenger = typed<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Not the general type: there the loader talks about drivers it could not open, which is no fault of ours.
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = hear;
  messenger.pUserData = made.messages_.get();
  const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  auto features = typed<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.pNext = &messenger;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enabled;

  auto application = typed<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "weft";
  application.pEngineName = "weft";
  application.apiVersion = version;
  auto create = typed<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  create.pNext = choice.validation ? &features : nullptr;
  create.pApplicationInfo = &application;
  create.enabledLayerCount = static_cast<uint32_t>(layers.size());
  create.ppEnabledLayerNames = layers.data();
  create.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  create.ppEnabledExtensionNames = extensions.data();
  const VkResult result = fn.vkCreateInstance(&create, nullptr, &made.handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    return fail(ErrorKind::other, "no Vulkan driver is installed, or none for this machine: on Debian, apt install mesa-vulkan-drivers ",
                "brings one for most GPUs and one that needs none");
  }
  if (result != VK_SUCCESS) return fail("the Vulkan instance could not be created: ", result_name(result));
  if (Result<void> loaded = fn.load_instance(made.handle_); !loaded) return loaded.take_error();
  if (choice.validation) {
    const VkResult messaged =
        fn.vkCreateDebugUtilsMessengerEXT(made.handle_, &messenger, nullptr, &made.messenger_);
    if (messaged != VK_SUCCESS) return fail("validation messages could not be heard: ", result_name(messaged));
  }
  return made;
}

Instance::Instance(Instance&& other) noexcept
    : loader_(std::move(other.loader_)),
      functions_(other.functions_),
      handle_(std::exchange(other.handle_, VK_NULL_HANDLE)),
      messenger_(std::exchange(other.messenger_, VK_NULL_HANDLE)),
      messages_(std::move(other.messages_)) {}

Instance::~Instance() {
  if (handle_ == VK_NULL_HANDLE) return;
  if (messenger_ != VK_NULL_HANDLE) functions_.vkDestroyDebugUtilsMessengerEXT(handle_, messenger_, nullptr);
  // Null only when the instance lacked functions: there is then nothing to call.
  if (functions_.vkDestroyInstance != nullptr) functions_.vkDestroyInstance(handle_, nullptr);
}

}  // namespace weft::compute
