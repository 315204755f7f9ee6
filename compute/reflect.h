// What a shader touches, read from its SPIR-V. No Vulkan needed.
//
// A shader is the only place that says which buffers it reads and which it writes; bindings, descriptor layouts and barriers
// all follow from what is found here. A buffer counts as read or written where the shader's declaration allows it
// (`readonly`, `writeonly`) and its code does so; where a pointer goes where no instruction tells, the declaration alone counts.
//
// Based on: SPIR-V Specification 1.6, sections 2.3 (physical layout) and 3 (binary form).
// Limitations: one entry point per module; arrays of descriptors count as one binding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"

namespace weft::compute {

struct Binding {
  enum class Kind {
    storage_buffer,
    uniform_buffer,
    uniform_texel_buffer,  ///< samplerBuffer, textureBuffer
    storage_texel_buffer,  ///< imageBuffer
    combined_image,        ///< sampler2D
    sampled_image,         ///< texture2D
    storage_image,
    sampler,
    other,
  };
  uint32_t set = 0;
  uint32_t binding = 0;
  Kind kind = Kind::other;
  bool read = false;
  bool written = false;
  uint32_t element_bytes = 0;  ///< of the array that a storage block ends in; 0: it ends in none
  std::string name;  ///< the variable's, or its block's; empty when names were stripped
};

const char* kind_name(Binding::Kind kind);

struct SpecConstant {
  uint32_t id = 0;
  uint32_t value = 0;  ///< the default, as 32 bits
  std::string name;
};

struct Reflection {
  std::string entry_point;
  std::vector<Binding> bindings;            ///< by set, then binding
  std::array<uint32_t, 3> local_size{};     ///< with the defaults of specialisation constants; 0 0 0 when not compute
  std::array<std::optional<uint32_t>, 3> local_size_id;  ///< the specialisation constant that sets it, if one does
  uint32_t push_constant_bytes = 0;
  std::vector<SpecConstant> spec_constants;  ///< by id
};

/// Any words are safe to pass; what is not SPIR-V comes back as a sentence.
Result<Reflection> reflect(std::span<const uint32_t> spirv);

/// Instructions of all functions, from each OpFunction to its end: without types, constants, names and decorations.
size_t instructions_of(std::span<const uint32_t> spirv);

}  // namespace weft::compute
