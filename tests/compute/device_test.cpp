// Devices: which one is taken, what is said when none can be, and memory on it.
#include "compute/device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <string>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/descriptors.h"
#include "compute/inventory.h"
#include "tests/support/on_device.h"

namespace weft::compute {
namespace {

/// Sets a variable of the environment for one test.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value, 1);
  }
  ~Environment() {
    if (before_) setenv(name_, before_->c_str(), 1);
    else unsetenv(name_);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

DeviceDescription described(uint32_t index, const char* name, const char* type, const char* refusal = "") {
  DeviceDescription out;
  out.index = index;
  out.name = name;
  out.type = type;
  out.draws = true;
  out.refusal = refusal;
  return out;
}

const std::vector<DeviceDescription> kMachine = {
    described(0, "Soft Pipe", "software"), described(1, "Small Graphics", "integrated"),
    described(2, "Big Graphics", "discrete"), described(3, "Old Graphics", "discrete", "it has Vulkan 1.1.0")};

TEST(Choice, unless_one_is_named_the_discrete_device_is_taken_then_the_integrated_then_software) {
  EXPECT_EQ(*choose_device(kMachine, "", false), 2u);
  EXPECT_EQ(*choose_device(std::span(kMachine).first(2), "", false), 1u);
  EXPECT_EQ(*choose_device(std::span(kMachine).first(1), "", false), 0u);
}

TEST(Choice, a_number_is_an_index_and_a_part_of_a_name_ignores_case) {
  EXPECT_EQ(*choose_device(kMachine, "1", false), 1u);
  EXPECT_EQ(*choose_device(kMachine, "soft", false), 0u);
  EXPECT_EQ(*choose_device(kMachine, "GRAPHICS", false), 2u);
}

TEST(Choice, an_unknown_device_is_answered_with_what_there_is) {
  EXPECT_EQ(choose_device(std::span(kMachine).first(2), "nvidia", false).error(),
            "no Vulkan device is called \"nvidia\"; there are: 0: Soft Pipe; 1: Small Graphics");
  EXPECT_EQ(choose_device(std::span(kMachine).first(1), "7", false).error(),
            "there is no Vulkan device 7; there are: 0: Soft Pipe");
  EXPECT_FALSE(choose_device(kMachine, "99999999999999999999", false));
}

TEST(Choice, a_device_that_cannot_be_used_says_why) {
  EXPECT_EQ(choose_device(kMachine, "3", false).error(),
            "Vulkan device 3 (Old Graphics) cannot be used: it has Vulkan 1.1.0");
  EXPECT_EQ(choose_device(kMachine, "old", false).error(),
            "the Vulkan device Old Graphics cannot be used: it has Vulkan 1.1.0");
  std::vector<DeviceDescription> headless = {kMachine[0]};
  headless[0].draws = false;
  EXPECT_TRUE(choose_device(headless, "", false));
  EXPECT_FALSE(choose_device(headless, "", true));
}

TEST(Inventory, every_device_says_its_limits_or_why_it_cannot_be_used) {
  const Result<std::vector<DeviceDescription>> devices = list_devices();
  ASSERT_TRUE(devices) << devices.error();
  for (const DeviceDescription& device : *devices) {
    EXPECT_FALSE(device.name.empty());
    EXPECT_FALSE(device.driver.empty());
    if (!device.refusal.empty()) continue;
    EXPECT_GE(device.limits.max_storage_buffer_bytes, 1u << 27);  // what Vulkan promises at least
    EXPECT_GE(device.limits.shared_memory_bytes, 16384u);
    EXPECT_GE(device.limits.subgroup_size, 1u);
  }
}

TEST(Inventory, a_machine_without_a_driver_is_told_what_to_install) {
  const Environment files("VK_DRIVER_FILES", "/nowhere/driver.json");
  const Environment older("VK_ICD_FILENAMES", "/nowhere/driver.json");
  const Result<std::unique_ptr<Device>> created = Device::create();
  ASSERT_FALSE(created);
  EXPECT_NE(created.error().find("mesa-vulkan-drivers"), std::string::npos) << created.error();
}

TEST(Inventory, a_missing_validation_layer_is_named) {
  const Environment layers("VK_LAYER_PATH", "/nowhere");
  DeviceChoice choice;
  choice.validation = true;
  const Result<std::unique_ptr<Device>> created = Device::create(choice);
  ASSERT_FALSE(created);
  EXPECT_NE(created.error().find("VK_LAYER_KHRONOS_validation"), std::string::npos) << created.error();
}

TEST(Inventory, a_missing_extension_is_named) {
  DeviceChoice choice;
  choice.device_extensions = {"VK_WEFT_imaginary"};
  const Result<std::unique_ptr<Device>> created = Device::create(choice);
  ASSERT_FALSE(created);
  EXPECT_NE(created.error().find("VK_WEFT_imaginary"), std::string::npos) << created.error();
}

TEST_F(OnDevice, a_device_is_found_again_by_its_index_and_its_name) {
  for (const std::string& name : {std::to_string(device().description().index), device().name()}) {
    DeviceChoice choice;
    choice.name = name;
    const Result<std::unique_ptr<Device>> again = Device::create(choice);
    ASSERT_TRUE(again) << again.error();
    EXPECT_EQ((*again)->name(), device().name());
  }
}

TEST_F(OnDevice, what_is_uploaded_is_read_back) {
  const BufferRequest requests[] = {{"first", 1000 * 4, kStorage},
                                    {"empty", 0, kStorage},
                                    {"texels", 77 * 4, kStorage | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                     VK_FORMAT_R32_UINT}};
  const Result<Arena> arena = Arena::create(device(), Memory::device, "test", requests);
  ASSERT_TRUE(arena) << arena.error();
  EXPECT_EQ((*arena)[1].bytes, 16u);
  EXPECT_NE((*arena)[2].view, VkBufferView(VK_NULL_HANDLE));
  EXPECT_GE(arena->total_bytes(), 4000u + 16u + 77 * 4);
  std::vector<uint32_t> first(1000), texels(77, 9);
  std::iota(first.begin(), first.end(), 3);
  const Upload uploads[] = {{&(*arena)[0], bytes_of(first)}, {&(*arena)[1], {}}, {&(*arena)[2], bytes_of(texels)}};
  const Result<void> uploaded = upload_all(device(), uploads);
  ASSERT_TRUE(uploaded) << uploaded.error();
  std::vector<uint32_t> read_first(1000), read_texels(77);
  ASSERT_TRUE(read_back(device(), (*arena)[0], std::as_writable_bytes(std::span(read_first))));
  ASSERT_TRUE(read_back(device(), (*arena)[2], std::as_writable_bytes(std::span(read_texels))));
  EXPECT_EQ(read_first, first);
  EXPECT_EQ(read_texels, texels);
}

TEST_F(OnDevice, more_bytes_than_a_buffer_has_are_refused) {
  const BufferRequest request{"small", 32, kStorage};
  const Result<Arena> arena = Arena::create(device(), Memory::device, "test", {&request, 1});
  ASSERT_TRUE(arena) << arena.error();
  std::vector<uint32_t> many(9);
  EXPECT_EQ(upload(device(), (*arena)[0], bytes_of(many)).error(),
            "an upload of 36 bytes does not fit buffer small of 32 bytes");
  EXPECT_EQ(read_back(device(), (*arena)[0], std::as_writable_bytes(std::span(many))).error(),
            "reading 36 bytes back from buffer small goes past its 32 bytes");
}

TEST_F(OnDevice, a_buffer_above_a_limit_is_refused_with_its_name_its_size_and_the_limit) {
  const auto refusal = [&](const BufferRequest& request) {
    const Result<Arena> arena = Arena::create(device(), Memory::device, "test", {&request, 1});
    return arena ? std::string() : arena.error();
  };
  const std::string beyond = refusal({"huge", ~VkDeviceSize{0}, kStorage});
  EXPECT_NE(beyond.find("huge of 18446744073709551615 bytes"), std::string::npos) << beyond;
  const VkDeviceSize storage = device().limits().max_storage_buffer_bytes + 1;
  const std::string large = refusal({"large", storage, kStorage});
  EXPECT_NE(large.find("large"), std::string::npos) << large;
  EXPECT_NE(large.find(std::to_string(storage)), std::string::npos) << large;
  const uint64_t elements = uint64_t{device().limits().max_texel_buffer_elements} + 1;
  const std::string texels = refusal(
      {"texels", elements * 4, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, VK_FORMAT_R32_UINT});
  EXPECT_NE(texels.find("texels"), std::string::npos) << texels;
  const std::string format =
      refusal({"depth", 64, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, VK_FORMAT_D32_SFLOAT});
  EXPECT_NE(format.find("depth"), std::string::npos) << format;
}

TEST_F(OnDevice, an_arena_that_no_heap_can_hold_is_refused_and_names_its_largest_buffer) {
  // Each buffer is within its limit; together they are above the largest allocation or the heap.
  const VkDeviceSize each = std::min(device().limits().max_storage_buffer_bytes, device().limits().max_allocation_bytes);
  const std::vector<BufferRequest> requests(2000, BufferRequest{"slab", each, kStorage});
  const Result<Arena> arena = Arena::create(device(), Memory::device, "all of it", requests);
  ASSERT_FALSE(arena);
  EXPECT_NE(arena.error().find("slab"), std::string::npos) << arena.error();
  EXPECT_NE(arena.error().find("all of it"), std::string::npos) << arena.error();
}

TEST_F(OnDevice, a_loan_with_something_missing_is_refused) {
  BorrowedDevice lent{device().vk().vkGetInstanceProcAddr, device().instance(), device().physical(),
                      device().handle(), device().queue(), 1000};
  EXPECT_NE(Device::borrow(lent).error().find("queue family 1000"), std::string::npos);
  lent.queue = VK_NULL_HANDLE;
  EXPECT_EQ(Device::borrow(lent).error(), "the device lent to Weft has no VkQueue (it is null)");
}

TEST_F(OnDevice, a_texel_binding_wants_a_buffer_with_a_format) {
  const BufferRequest request{"plain", 64, kStorage};
  const Result<Arena> arena = Arena::create(device(), Memory::device, "test", {&request, 1});
  ASSERT_TRUE(arena) << arena.error();
  const DescriptorBinding binding{3, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER};
  const Result<DescriptorLayout> layout = DescriptorLayout::create(device(), "texels", {&binding, 1});
  ASSERT_TRUE(layout) << layout.error();
  const BoundBuffer viewless{3, &(*arena)[0]};
  const BoundBuffer stranger{4, &(*arena)[0]};
  EXPECT_FALSE(DescriptorSet::create(device(), "texels", *layout, {&viewless, 1}));
  EXPECT_FALSE(DescriptorSet::create(device(), "texels", *layout, {&stranger, 1}));
}

TEST_F(OnDevice, a_timeline_reaches_the_value_that_a_submit_signals) {
  const Result<OwnedSemaphore> timeline = create_timeline(device(), "timeline", 5);
  ASSERT_TRUE(timeline) << timeline.error();
  auto signal = typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  signal.semaphore = timeline->get();
  signal.value = 6;
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  auto work = typed<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  work.signalSemaphoreInfoCount = 1;
  work.pSignalSemaphoreInfos = &signal;
  ASSERT_TRUE(device().submit(work));
  EXPECT_TRUE(wait_for(device(), timeline->get(), 6));
  const Result<void> never = wait_for(device(), timeline->get(), 7, 0.01);
  ASSERT_FALSE(never);
  EXPECT_NE(never.error().find("within 0.01 s"), std::string::npos) << never.error();
}

}  // namespace
}  // namespace weft::compute
