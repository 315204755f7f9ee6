// Labels in command buffers, and the validation layers that cannot hold them.
#include "compute/labels.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/on_device.h"

namespace weft::compute {
namespace {

VkPhysicalDeviceToolProperties tool(const char* layer, const char* version) {
  auto made = typed<VkPhysicalDeviceToolProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TOOL_PROPERTIES);
  std::strcpy(made.layer, layer);
  std::strcpy(made.version, version);
  return made;
}

TEST(Labels, validation_before_243_does_not_hold_them) {
  constexpr const char* kKhronos = "VK_LAYER_KHRONOS_validation";
  for (const char* version : {"239", "242", "1.3.239", "", "of my own"}) EXPECT_FALSE(holds_labels(tool(kKhronos, version))) << version;
  for (const char* version : {"243", "275", "1.3.243", "1.4.304"}) EXPECT_TRUE(holds_labels(tool(kKhronos, version))) << version;
  EXPECT_TRUE(holds_labels(tool("", "1.25")));                                // RenderDoc is no layer of theirs
  EXPECT_TRUE(holds_labels(tool("VK_LAYER_LUNARG_api_dump", "2")));
}

bool records_labels(const Functions& fn) {
  EXPECT_EQ(fn.vkCmdBeginDebugUtilsLabelEXT == nullptr, fn.vkCmdEndDebugUtilsLabelEXT == nullptr);
  return fn.vkCmdBeginDebugUtilsLabelEXT != nullptr;
}

// The layer is asked in its own words, so that this fails where it stops answering, too.
TEST_F(OnDevice, labels_are_recorded_where_the_active_layer_holds_them_on_own_and_borrowed_devices) {
  const auto layers_of = device().vk().vkEnumerateInstanceLayerProperties;
  uint32_t count = 0;
  layers_of(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  layers_of(&count, layers.data());
  uint32_t version = 0;
  for (const VkLayerProperties& layer : layers)
    if (std::strcmp(layer.layerName, "VK_LAYER_KHRONOS_validation") == 0) version = layer.specVersion;
  ASSERT_GT(version, 0u);
  const bool holds = version >= VK_MAKE_API_VERSION(0, 1, 3, 243);
  EXPECT_EQ(records_labels(device().vk()), holds);
  const BorrowedDevice lent{device().vk().vkGetInstanceProcAddr, device().instance(), device().physical(),
                            device().handle(), device().queue(), device().queue_family()};
  const Result<std::unique_ptr<Device>> guest = Device::borrow(lent);
  ASSERT_TRUE(guest) << guest.error();
  EXPECT_EQ(records_labels((*guest)->vk()), holds);
}

}  // namespace
}  // namespace weft::compute
