// `weft info`: the devices there are, what they support, and why one cannot be used.
#include <cstdio>

#include "compute/device.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"

namespace weft::command {

namespace {

std::string size_text(VkDeviceSize bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB"};
  double size = static_cast<double>(bytes);
  int unit = 0;
  while (size >= 1024 && unit < 3) {
    size /= 1024;
    ++unit;
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.4g %s", size, units[unit]);
  return text;
}

void print(const compute::DeviceDescription& device) {
  const compute::DeviceLimits& limits = device.limits;
  std::printf("%u: %s (%s)\n", device.index, device.name.c_str(), device.type.c_str());
  std::printf("   Vulkan %s, driver %s\n", device.api.c_str(), device.driver.c_str());
  std::printf("   memory %s, one allocation %s, one buffer %s, one storage buffer %s, %u texels\n", size_text(device.memory_bytes).c_str(),
              size_text(limits.max_allocation_bytes).c_str(), size_text(limits.max_buffer_bytes).c_str(),
              size_text(limits.max_storage_buffer_bytes).c_str(), limits.max_texel_buffer_elements);
  std::printf("   subgroups of %u, workgroups of at most %u, %s shared memory, %u storage buffers a stage, %u bytes of push constants\n",
              limits.subgroup_size, limits.max_workgroup_invocations, size_text(limits.shared_memory_bytes).c_str(),
              limits.max_storage_buffers_per_stage, limits.max_push_constant_bytes);
  if (limits.timestamp_period_ns > 0)
    std::printf("   timestamps every %g ns, %u bits\n", limits.timestamp_period_ns, limits.timestamp_bits);
  else
    std::printf("   no timestamps: passes are timed on the CPU\n");
  std::printf("   barriers %s, frames in order by %s\n", device.features.synchronization2 ? "of synchronization2" : "of Vulkan 1.0",
              device.features.timeline_semaphore ? "timeline semaphores" : "fences");
  std::printf("   %s\n", device.draws ? "draws pictures" : "draws no pictures: run with --no-picture");
  if (!device.refusal.empty()) std::printf("   cannot be used: %s\n", device.refusal.c_str());
}

}  // namespace

Exit info() {
  const auto devices = compute::list_devices();
  if (!devices) {
    complain(devices.error());
    return kFailed;
  }
  for (const compute::DeviceDescription& device : *devices) print(device);
  const auto taken = compute::Device::create();
  if (!taken) {
    complain(taken.error());
    return kFailed;
  }
  std::printf("Without --device, %u is taken: %s\n", (*taken)->description().index, (*taken)->name().c_str());
  return kDone;
}

}  // namespace weft::command
