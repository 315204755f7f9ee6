// Who reads what Weft has made, in a host's own commands, and what buffers must be created for that.
//
//     draws                               VERTEX_ATTRIBUTE_INPUT           VERTEX_ATTRIBUTE_READ
//     skinning, culling in compute        COMPUTE_SHADER                   SHADER_STORAGE_READ
//     builds of acceleration structures   ACCELERATION_STRUCTURE_BUILD     SHADER_READ
//     copies                              COPY                             TRANSFER_READ
//
// The stages and accesses are Vulkan's (VK_PIPELINE_STAGE_2_*_BIT, VK_ACCESS_2_*_BIT); several readers are or-ed together.
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
