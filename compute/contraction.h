// Forbids contraction: a compiler may make one operation, with one rounding, of a product and a sum. Where it does differs from module to
// module, and from one width of workgroups to another: two modules that share functions then differ in the last bit. Built-in functions are
// not arithmetic, and may still be contracted inside (SPIR-V 1.6, 3.20): cross is not used for that (shaders/shared.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace weft::compute {

/// The module with all of its arithmetic decorated NoContraction (SPIR-V 1.6, 3.20; GLSL's `precise`). Words that are no module stay as
/// they are.
std::vector<uint32_t> without_contraction(std::span<const uint32_t> spirv);

}  // namespace weft::compute
