// What of a plan is too large for a device, in the scene's own words.
#pragma once

#include <string>

#include "engine/solve/plan.h"

namespace weft {

/// Of a device; as they stand here, what every device with Vulkan has at least, with Weft's threads a workgroup for GPUs.
struct SizeLimits {
  std::uint64_t storage_bytes = 1u << 27;   // maxStorageBufferRange
  std::uint64_t workgroups = 65535;         // maxComputeWorkGroupCount
  std::uint32_t workgroup = 64;             // threads
};

/// What made a buffer or a pass as large as it is: the key that a scene has for what `grows` with the capacity for contacts, or the largest
/// part of the scene, with the value.
std::string cause_of_size(bool grows, const Cooked& subject);

/// A sentence that names the key and its value, or the cloth, and the limit that the first buffer or pass breaks; empty: none does.
std::string beyond(const SizeLimits& limits, std::string_view device, const Plan& plan, const Cooked& subject);

}  // namespace weft
