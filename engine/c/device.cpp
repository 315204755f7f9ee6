// See engine/c/weft.h: devices.
#include "engine/c/inside.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

weft_status weft_device_create(const char* name, weft_device** device, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    weft::compute::DeviceChoice choice;
    choice.name = name != nullptr ? name : "";
    auto made = weft::compute::Device::create(choice);
    if (!made) return made.take_error();
    *device = new weft_device{std::move(*made)};
    return {};
  });
}

weft_status weft_device_borrow(const weft_borrowed* lent, weft_device** device, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(lent);
    WEFT_GIVEN(device);
    weft::compute::BorrowedDevice all;
    all.get_instance_proc_addr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(lent->get_instance_proc_addr);
    all.instance = static_cast<VkInstance>(lent->instance);
    all.physical = static_cast<VkPhysicalDevice>(lent->physical);
    all.device = static_cast<VkDevice>(lent->device);
    all.queue = static_cast<VkQueue>(lent->queue);
    all.queue_family = lent->queue_family;
    all.created_with = static_cast<const VkDeviceCreateInfo*>(lent->created_with);
    auto made = weft::compute::Device::borrow(all);
    if (!made) return made.take_error();
    *device = new weft_device{std::move(*made)};
    return {};
  });
}

void weft_device_destroy(weft_device* device) { delete device; }

const char* weft_device_name(const weft_device* device) { return device != nullptr ? device->device->name().c_str() : ""; }
