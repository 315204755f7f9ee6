// What the instructions of a module do with its variables: each load, store and atomic counts for the variable that its pointer leads into.
//
// Based on: SPIR-V Specification 1.6, section 3.52 (memory and atomic instructions).
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "compute/spirv.h"

namespace weft::compute {

class VariableUses {
 public:
  struct Use {
    bool read = false, written = false;
    bool unknown = false;   // its pointer goes where no instruction tells: into a function, a phi, a selection
  };

  /// Instructions in their order: a pointer is made before it is used.
  void note(std::span<const uint32_t> words) {
    using namespace spirv;
    const uint32_t op = words[0] & 0xffff;
    const auto at = [&](size_t k) -> Use& { return k < words.size() ? uses_[root_of(words[k])] : nowhere_; };
    switch (op) {
      case OpAccessChain:
      case OpInBoundsAccessChain:
      case OpPtrAccessChain:
      case OpCopyObject:
        if (words.size() > 3) root_[words[2]] = root_of(words[3]);
        return;
      case OpLoad:
      case OpAtomicLoad: at(3).read = true; return;
      case OpStore:
      case OpAtomicStore: at(1).written = true; return;
      case OpCopyMemory: at(1).written = at(2).read = true; return;
      case OpImageTexelPointer:
      case OpFunctionCall:
      case OpSelect:
      case OpPhi:
        for (size_t k = 3; k < words.size(); ++k) at(k).unknown = true;
        return;
      default:
        if (op > OpAtomicStore && op <= OpAtomicXor) at(3).read = at(3).written = true;
    }
  }

  /// Nothing of a variable that no instruction uses.
  Use of(uint32_t variable) const {
    const auto found = uses_.find(variable);
    return found == uses_.end() ? Use{} : found->second;
  }

 private:
  uint32_t root_of(uint32_t pointer) const {
    const auto found = root_.find(pointer);
    return found == root_.end() ? pointer : found->second;
  }

  std::map<uint32_t, uint32_t> root_;   // pointer -> the variable that it leads into
  std::map<uint32_t, Use> uses_;
  Use nowhere_;                         // of words that a damaged instruction does not have
};

}  // namespace weft::compute
