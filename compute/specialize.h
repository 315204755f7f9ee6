// From a module with specialisation constants to the code of one specialisation.
//
// A driver is told the values of specialisation constants when it compiles a pipeline, too late for descriptor layouts and
// barriers: a branch that is never taken still names its buffers. So the values are put in before: constants are frozen,
// folded and propagated, and dead code and the variables that only it used are removed. Modules were optimised when they were built.
// Reflection then sees what really runs. No Vulkan needed.
//
// The work is done by SPIRV-Tools' optimizer (Khronos): sparse conditional constant propagation (Wegman and Zadeck 1991),
// elimination of dead branches, aggressive dead-code elimination, merging of blocks.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "compute/result.h"

namespace weft::compute {

/// A specialisation constant's value as 32 bits: std::bit_cast<uint32_t>(0.5f); 0 or 1 for false and true.
struct SpecializationConstant {
  uint32_t id = 0;
  uint32_t value = 0;
};

/// Constants that the module does not have are ignored; those that are not named keep their defaults. The result has none, and its bindings
/// are numbered anew: no two of them have one number.
/// Errors: words that are no valid SPIR-V for Vulkan 1.2.
Result<std::vector<uint32_t>> specialize(std::span<const uint32_t> spirv, std::span<const SpecializationConstant> constants);

/// The same, remembering: where nothing has changed that a module knows of, it is not specialised again. What it remembers can be kept
/// between runs (PipelineCache does). Any thread may call it.
class Specializer {
 public:
  /// The words are valid as long as the specializer lives.
  Result<std::span<const uint32_t>> specialize(std::span<const uint32_t> spirv, std::span<const SpecializationConstant> constants);
  /// How many it remembers.
  size_t modules() const;

  /// All that it remembers.
  std::vector<uint32_t> remembered() const;
  /// Of how many words that is.
  size_t remembered_words() const;
  /// Remembers that too. Words of another version of Weft, and words that are damaged, are left out; the rest is taken.
  void remember(std::span<const uint32_t> remembered);

 private:
  mutable std::mutex mutex_;
  /// From a hash of the module, and the numbers and values of the constants that it uses, to the words of its specialisation.
  std::map<std::vector<uint32_t>, std::vector<uint32_t>> made_;
};

}  // namespace weft::compute
