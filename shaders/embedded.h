// The compiled shaders, carried inside the library: no file has to be found at run time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace weft {

/// SPIR-V words of the shader with this name ("stretch", "shading/cloth.vert"), empty if there is none.
std::span<const std::uint32_t> shader(std::string_view name);

}  // namespace weft
