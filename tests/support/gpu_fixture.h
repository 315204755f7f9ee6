// A test on whatever Vulkan device there is, with validation and synchronization validation on: one message fails it. Where
// WEFT_TESTS_UNVALIDATED is set they are off, which takes a quarter off suites that run for long (tests/CMakeLists.txt).
// All tests of a program share one device. Without a device they fail: the software driver is always there.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "compute/device.h"
#include "tests/support/must.h"

namespace weft {

/// Owns the device between the program's first GPU test and its end, so that messages of its destruction count too.
class GpuEnvironment : public testing::Environment {
 public:
  /// Null when there is none; `refusal` says why.
  const compute::Device* device() {
    if (!device_ && refusal.empty()) {
      compute::DeviceChoice choice;
      choice.validation = std::getenv("WEFT_TESTS_UNVALIDATED") == nullptr;
      choice.on_validation_message = [this](const std::string& message) {
        const std::lock_guard lock(mutex_);
        heard_.push_back(message);
      };
      auto created = compute::Device::create(choice);
      if (created) device_ = std::move(*created);
      else refusal = created.error();
    }
    return device_.get();
  }
  /// What validation said since the last call.
  std::vector<std::string> take_messages() {
    const std::lock_guard lock(mutex_);
    return std::exchange(heard_, {});
  }
  void TearDown() override {
    device_.reset();
    for (const std::string& message : take_messages()) ADD_FAILURE() << "at the device's end: " << message;
  }

  std::string refusal;

 private:
  std::unique_ptr<compute::Device> device_;
  std::mutex mutex_;
  std::vector<std::string> heard_;
};

// GoogleTest owns it; one a program, however many files include this.
inline GpuEnvironment* const kGpu = static_cast<GpuEnvironment*>(testing::AddGlobalTestEnvironment(new GpuEnvironment));

class GpuTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(kGpu->device(), nullptr) << kGpu->refusal; }
  void TearDown() override {
    for (const std::string& message : kGpu->take_messages()) ADD_FAILURE() << message;
  }
  const compute::Device& device() const { return *kGpu->device(); }
};

}  // namespace weft
