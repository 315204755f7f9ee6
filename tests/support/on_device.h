// A test on whatever Vulkan device there is, with validation and synchronization validation on: one message fails it.
// Without a Vulkan device such a test fails: the software driver is always there.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/device.h"

namespace weft::compute {

inline constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                        VK_BUFFER_USAGE_TRANSFER_DST_BIT;

inline std::span<const std::byte> bytes_of(const std::vector<uint32_t>& values) { return std::as_bytes(std::span(values)); }

/// One device for a test, and silence from validation until the very end, destruction included.
class OnDevice : public testing::Test {
 protected:
  void SetUp() override {
    DeviceChoice choice;
    choice.validation = true;
    choice.on_validation_message = [this](const std::string& message) { heard_.push_back(message); };
    Result<std::unique_ptr<Device>> created = Device::create(choice);
    ASSERT_TRUE(created) << created.error();
    device_ = std::move(*created);
  }
  void TearDown() override {
    device_.reset();
    for (const std::string& message : heard_) {
      if (!expects_messages_) ADD_FAILURE() << message;
    }
  }
  const Device& device() const { return *device_; }

  std::vector<std::string> heard_;
  std::unique_ptr<Device> device_;
  bool expects_messages_ = false;
};

}  // namespace weft::compute
