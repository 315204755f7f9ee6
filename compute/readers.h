// Who reads what Weft has made, in a host's own commands, and what buffers must be created for that.
//
//     who                                 stage                              access
//     draws                               VERTEX_ATTRIBUTE_INPUT             VERTEX_ATTRIBUTE_READ
//     skinning, culling in compute        COMPUTE_SHADER                     SHADER_STORAGE_READ
//     builds of acceleration structures   ACCELERATION_STRUCTURE_BUILD_KHR   SHADER_READ
//     copies                              COPY                               TRANSFER_READ
//
// The names are Vulkan's (VK_PIPELINE_STAGE_2_*, VK_ACCESS_2_*); several readers are or-ed together, also those of different frames.
// Shaders that read by address take the usage SHADER_DEVICE_ADDRESS; builds of acceleration structures take it, too, and
// ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR.
#pragma once

#include "compute/device.h"

namespace weft::compute {

struct Readers {
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 accesses = 0;
};

/// Errors, each with the names of the bits: no stage or no access; one in which no buffer is read; an access that none of the stages
/// has, or a stage that has none of the accesses; a stage that needs another queue, or a feature that is not enabled
/// (Device::features).
Result<void> check_readers(const Device& device, const Readers& readers);

/// Whether a buffer that is read may be created for these. Errors, with the names of the bits: a usage in which no buffer of vertices
/// is read; one that needs a feature that is not enabled.
Result<void> check_usage(const Device& device, VkBufferUsageFlags usage);

}  // namespace weft::compute
