// A single walk over the words of a module, then questions to what was found. See reflect.h.
#include "compute/reflect.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "compute/spirv.h"
#include "compute/spirv_uses.h"

namespace weft::compute {
namespace {

using namespace spirv;
using Words = std::span<const uint32_t>;

constexpr uint32_t kMaxBound = 0x3fffff;       // universal limit of the specification, section 2.17
constexpr uint32_t kMaxDepth = 16;             // of nested types; the shaders here need 4
constexpr uint32_t kMaxSizeSteps = 4096;       // struct members visited for a push block
constexpr uint64_t kMaxPushBytes = 1u << 16;   // no device offers more than 4 KiB

/// A string is packed four bytes to a word, first byte lowest, and ends with a zero byte.
std::string read_string(Words words) {
  std::string text;
  for (const uint32_t word : words) {
    for (int shift = 0; shift < 32; shift += 8) {
      const char c = static_cast<char>((word >> shift) & 0xff);
      if (c == 0) return text;
      text.push_back(c);
    }
  }
  return text;
}

class Module {
 public:
  Result<void> parse(Words words);
  Result<Reflection> ask() const;

 private:
  using MemberKey = std::pair<uint32_t, uint32_t>;
  struct SizeBudget {
    uint32_t steps = kMaxSizeSteps;
  };

  /// The instruction that defines an id; empty when none that matters here does.
  Words definition(uint32_t id) const {
    const auto found = defined_.find(id);
    return found == defined_.end() ? Words{} : found->second;
  }
  /// The same when it is `op` with at least `count` words, else empty.
  Words definition(uint32_t id, uint32_t op, size_t count) const {
    const Words found = definition(id);
    return !found.empty() && (found[0] & 0xffff) == op && found.size() >= count ? found : Words{};
  }
  std::optional<uint32_t> decoration(uint32_t id, uint32_t kind) const;
  std::optional<uint32_t> member_decoration(uint32_t id, uint32_t member, uint32_t kind) const;
  bool decorated_everywhere(uint32_t variable, uint32_t block, uint32_t kind) const;
  std::string name_of(uint32_t id) const;
  Error damaged(const char* what, uint32_t id) const { return fail("SPIR-V is damaged: ", what, " (id ", id, ")"); }

  Result<void> note(Words instruction);
  Result<Binding> binding_of(uint32_t variable, uint32_t storage, uint32_t type) const;
  Result<uint64_t> size_of(uint32_t type, uint32_t depth, std::optional<uint32_t> matrix_stride,
                           SizeBudget& budget) const;
  Result<void> ask_local_size(Reflection& out) const;
  Result<void> ask_variables(Reflection& out) const;
  void ask_spec_constants(Reflection& out) const;

  uint32_t bound_ = 0;
  std::unordered_map<uint32_t, Words> defined_;   // types, constants and variables
  std::vector<uint32_t> variables_;
  std::map<uint32_t, std::string> names_;
  std::map<MemberKey, uint32_t> decorations_;                      // (id, decoration) -> first operand
  std::map<std::pair<MemberKey, uint32_t>, uint32_t> member_decorations_;  // ((id, member), decoration) -> operand
  std::string entry_point_;
  uint32_t entry_points_ = 0;
  VariableUses uses_;
  Words local_size_;     // operands of LocalSize
  Words local_size_id_;  // operands of LocalSizeId
};

std::optional<uint32_t> Module::decoration(uint32_t id, uint32_t kind) const {
  const auto found = decorations_.find({id, kind});
  return found == decorations_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<uint32_t> Module::member_decoration(uint32_t id, uint32_t member, uint32_t kind) const {
  const auto found = member_decorations_.find({{id, member}, kind});
  return found == member_decorations_.end() ? std::nullopt : std::optional(found->second);
}

/// On the variable, or on every member of its block: compilers write `readonly buffer` either way.
bool Module::decorated_everywhere(uint32_t variable, uint32_t block, uint32_t kind) const {
  if (decoration(variable, kind)) return true;
  const Words type = definition(block, OpTypeStruct, 3);
  if (type.empty()) return false;
  for (uint32_t member = 0; member < type.size() - 2; ++member) {
    if (!member_decoration(block, member, kind)) return false;
  }
  return true;
}

std::string Module::name_of(uint32_t id) const {
  const auto found = names_.find(id);
  return found == names_.end() ? std::string() : found->second;
}

Result<void> Module::parse(Words words) {
  if (words.size() < kHeaderWords) return fail("SPIR-V of ", words.size(), " words is shorter than its header of 5");
  if (words[0] == kSwappedMagic) return fail("SPIR-V is stored in the byte order of another machine");
  if (words[0] != kMagic) return fail("this is not SPIR-V: the first word is ", words[0], ", not ", kMagic);
  const uint32_t bound = words[3];
  if (bound == 0 || bound > kMaxBound) {
    return fail("SPIR-V is damaged: its bound of ids is ", bound, ", not between 1 and ", kMaxBound);
  }
  bound_ = bound;
  for (size_t at = kHeaderWords; at < words.size();) {
    const size_t count = words[at] >> 16;
    if (count == 0 || count > words.size() - at) {
      return fail("SPIR-V is damaged: the instruction at word ", at, " is ", count, " words long, and ",
                  words.size() - at, " are left");
    }
    if (Result<void> noted = note(words.subspan(at, count)); !noted) return noted;
    at += count;
  }
  if (entry_points_ != 1) return fail("SPIR-V has ", entry_points_, " entry points; Weft needs exactly 1");
  return {};
}

Result<void> Module::note(Words words) {
  const auto define = [&](size_t result_at) -> Result<void> {
    if (words.size() <= result_at) return fail("SPIR-V is damaged: instruction ", words[0] & 0xffff, " has no result");
    const uint32_t id = words[result_at];
    if (id == 0 || id >= bound_) return damaged("an id is outside of the bound", id);
    if (!defined_.emplace(id, words).second) return damaged("an id is defined twice", id);
    return {};
  };
  switch (words[0] & 0xffff) {
    case OpName:
      if (words.size() > 2) names_[words[1]] = read_string(words.subspan(2));
      return {};
    case OpEntryPoint:
      ++entry_points_;
      if (words.size() > 3) entry_point_ = read_string(words.subspan(3));
      return {};
    case OpExecutionMode:
      if (words.size() >= 6 && words[2] == kLocalSize) local_size_ = words.subspan(3, 3);
      return {};
    case OpExecutionModeId:
      if (words.size() >= 6 && words[2] == kLocalSizeId) local_size_id_ = words.subspan(3, 3);
      return {};
    case OpDecorate:
      if (words.size() > 2 && words[2] != kNoContraction) decorations_[{words[1], words[2]}] = words.size() > 3 ? words[3] : 0;
      return {};
    case OpMemberDecorate:
      if (words.size() > 3) {
        member_decorations_[{{words[1], words[2]}, words[3]}] = words.size() > 4 ? words[4] : 0;
      }
      return {};
    case OpTypeInt:
    case OpTypeFloat:
    case OpTypeVector:
    case OpTypeMatrix:
    case OpTypeImage:
    case OpTypeSampler:
    case OpTypeSampledImage:
    case OpTypeArray:
    case OpTypeRuntimeArray:
    case OpTypeStruct:
    case OpTypePointer: return define(1);
    case OpConstant:
    case OpConstantComposite:
    case OpSpecConstantTrue:
    case OpSpecConstantFalse:
    case OpSpecConstant:
    case OpSpecConstantComposite: return define(2);
    case OpVariable:
      if (words.size() > 2) variables_.push_back(words[2]);
      return define(2);
    default: uses_.note(words); return {};
  }
}

Result<Binding> Module::binding_of(uint32_t variable, uint32_t storage, uint32_t type) const {
  Binding binding;
  const std::optional<uint32_t> set = decoration(variable, kDescriptorSet);
  const std::optional<uint32_t> number = decoration(variable, kBinding);
  if (!set || !number) return fail("variable \"", name_of(variable), "\" (id ", variable, ") has no set or no binding");
  binding.set = *set;
  binding.binding = *number;
  for (uint32_t depth = 0; depth < kMaxDepth; ++depth) {
    const Words element = definition(type);
    if (element.size() < 3) break;
    const uint32_t op = element[0] & 0xffff;
    if (op != OpTypeArray && op != OpTypeRuntimeArray) break;
    type = element[2];
  }
  binding.name = name_of(variable).empty() ? name_of(type) : name_of(variable);
  const Words words = definition(type);
  if (words.empty()) return damaged("a variable's type is not defined", variable);
  const uint32_t op = words[0] & 0xffff;
  const bool storage_block = storage == kStorageBuffer || (storage == kUniform && decoration(type, kBufferBlock));
  bool writable = false;
  if (op == OpTypeStruct && storage != kUniformConstant) {
    binding.kind = storage_block ? Binding::Kind::storage_buffer : Binding::Kind::uniform_buffer;
    writable = storage_block;
  } else if (op == OpTypeSampler) {
    binding.kind = Binding::Kind::sampler;
  } else {
    const bool combined = op == OpTypeSampledImage && words.size() >= 3;
    const Words image = combined ? definition(words[2], OpTypeImage, 9) : definition(type, OpTypeImage, 9);
    if (image.empty()) return damaged("a variable is neither a block nor an image", variable);
    const bool stored = image[7] == 2;
    if (image[3] == kDimBuffer) {
      binding.kind = stored ? Binding::Kind::storage_texel_buffer : Binding::Kind::uniform_texel_buffer;
    } else if (image[3] != kDimSubpass) {
      binding.kind = combined ? Binding::Kind::combined_image
                              : stored ? Binding::Kind::storage_image : Binding::Kind::sampled_image;
    }
    writable = stored && !combined;
  }
  binding.read = !(writable && decorated_everywhere(variable, type, kNonReadable));
  binding.written = writable && !decorated_everywhere(variable, type, kNonWritable);
  // Images are written through what is loaded from their variable: only blocks tell by their uses.
  if (const VariableUses::Use used = uses_.of(variable); storage_block && !used.unknown) {
    binding.read = binding.read && used.read;
    binding.written = binding.written && used.written;
  }
  if (storage_block && op == OpTypeStruct && words.size() > 2) {
    const Words last = definition(words.back(), OpTypeRuntimeArray, 3);
    if (!last.empty()) binding.element_bytes = decoration(words.back(), kArrayStride).value_or(0);
  }
  return binding;
}

Result<uint64_t> Module::size_of(uint32_t type, uint32_t depth, std::optional<uint32_t> matrix_stride,
                                 SizeBudget& budget) const {
  if (depth > kMaxDepth || budget.steps == 0) return damaged("a push constant block is nested too deeply", type);
  --budget.steps;
  const Words words = definition(type);
  if (words.size() < 3) return damaged("a type in a push constant block is not defined", type);
  switch (words[0] & 0xffff) {
    case OpTypeInt:
    case OpTypeFloat: return uint64_t{words[2]} / 8;
    case OpTypeVector: {
      if (words.size() < 4) break;
      Result<uint64_t> component = size_of(words[2], depth + 1, std::nullopt, budget);
      if (!component) return component;
      return std::min(*component * words[3], kMaxPushBytes + 1);
    }
    case OpTypeMatrix:
      if (words.size() < 4 || !matrix_stride) break;
      return std::min(uint64_t{words[3]} * *matrix_stride, kMaxPushBytes + 1);
    case OpTypeArray: {
      if (words.size() < 4) break;
      const Words length = definition(words[3], OpConstant, 4);
      const std::optional<uint32_t> stride = decoration(type, kArrayStride);
      if (length.empty() || !stride) break;
      return std::min(uint64_t{length[3]} * *stride, kMaxPushBytes + 1);
    }
    case OpTypeStruct: {
      uint64_t end = 0;
      for (uint32_t member = 0; member < words.size() - 2; ++member) {
        const std::optional<uint32_t> offset = member_decoration(type, member, kOffset);
        if (!offset) return damaged("a member of a push constant block has no offset", type);
        Result<uint64_t> size =
            size_of(words[member + 2], depth + 1, member_decoration(type, member, kMatrixStride), budget);
        if (!size) return size;
        end = std::max(end, *offset + *size);
      }
      return end;
    }
    default: break;
  }
  return damaged("a type in a push constant block has no size", type);
}

/// In falling order of precedence: the WorkgroupSize built-in (GLSL up to SPIR-V 1.5), LocalSizeId, LocalSize.
Result<void> Module::ask_local_size(Reflection& out) const {
  if (local_size_.size() == 3) std::copy(local_size_.begin(), local_size_.end(), out.local_size.begin());
  Words ids = local_size_id_;
  for (const auto& [key, operand] : decorations_) {
    if (key.second != kBuiltIn || operand != kBuiltInWorkgroupSize) continue;
    Words composite = definition(key.first, OpSpecConstantComposite, 6);
    if (composite.empty()) composite = definition(key.first, OpConstantComposite, 6);
    if (composite.empty()) return damaged("the workgroup size is not a constant of three parts", key.first);
    ids = composite.subspan(3, 3);
  }
  for (size_t axis = 0; axis < ids.size(); ++axis) {
    const Words fixed = definition(ids[axis], OpConstant, 4);
    const Words special = definition(ids[axis], OpSpecConstant, 4);
    if (fixed.empty() && special.empty()) return damaged("the workgroup size is computed, not a constant", ids[axis]);
    out.local_size[axis] = fixed.empty() ? special[3] : fixed[3];
    if (!special.empty()) out.local_size_id[axis] = decoration(ids[axis], kSpecId);
  }
  return {};
}

Result<void> Module::ask_variables(Reflection& out) const {
  for (const uint32_t variable : variables_) {
    const Words words = definition(variable, OpVariable, 4);
    if (words.empty()) return damaged("a variable has no storage class", variable);
    const uint32_t storage = words[3];
    const bool is_push = storage == kPushConstant;
    if (!is_push && storage != kUniformConstant && storage != kUniform && storage != kStorageBuffer) continue;
    const Words pointer = definition(words[1], OpTypePointer, 4);
    if (pointer.empty()) return damaged("a variable's type is not a pointer", variable);
    if (is_push) {
      SizeBudget budget;
      Result<uint64_t> size = size_of(pointer[3], 0, std::nullopt, budget);
      if (!size) return size.take_error();
      if (*size > kMaxPushBytes) return fail("SPIR-V has ", *size, " bytes of push constants, above ", kMaxPushBytes);
      out.push_constant_bytes = std::max(out.push_constant_bytes, static_cast<uint32_t>(*size));
      continue;
    }
    Result<Binding> binding = binding_of(variable, storage, pointer[3]);
    if (!binding) return binding.take_error();
    // Two variables may alias one binding, to view the same memory as different types.
    const auto alias = std::find_if(out.bindings.begin(), out.bindings.end(), [&](const Binding& other) {
      return other.set == binding->set && other.binding == binding->binding;
    });
    if (alias == out.bindings.end()) {
      out.bindings.push_back(std::move(*binding));
    } else if (alias->kind != binding->kind) {
      return fail("set ", binding->set, " binding ", binding->binding, " is both a ", kind_name(alias->kind), " and a ",
                  kind_name(binding->kind));
    } else {
      alias->read = alias->read || binding->read;
      alias->written = alias->written || binding->written;
    }
  }
  std::sort(out.bindings.begin(), out.bindings.end(), [](const Binding& a, const Binding& b) {
    return std::pair(a.set, a.binding) < std::pair(b.set, b.binding);
  });
  return {};
}

void Module::ask_spec_constants(Reflection& out) const {
  for (const auto& [key, operand] : decorations_) {
    if (key.second != kSpecId) continue;
    const Words words = definition(key.first);
    if (words.empty()) continue;
    const uint32_t op = words[0] & 0xffff;
    uint32_t value = 0;
    if (op == OpSpecConstantTrue) value = 1;
    if (op == OpSpecConstant && words.size() >= 4) value = words[3];
    out.spec_constants.push_back({operand, value, name_of(key.first)});
  }
  std::sort(out.spec_constants.begin(), out.spec_constants.end(),
            [](const SpecConstant& a, const SpecConstant& b) { return a.id < b.id; });
}

Result<Reflection> Module::ask() const {
  Reflection out;
  out.entry_point = entry_point_;
  if (Result<void> asked = ask_local_size(out); !asked) return asked.take_error();
  if (Result<void> asked = ask_variables(out); !asked) return asked.take_error();
  ask_spec_constants(out);
  return out;
}

}  // namespace

const char* kind_name(Binding::Kind kind) {
  switch (kind) {
    case Binding::Kind::storage_buffer: return "storage buffer";
    case Binding::Kind::uniform_buffer: return "uniform buffer";
    case Binding::Kind::uniform_texel_buffer: return "uniform texel buffer";
    case Binding::Kind::storage_texel_buffer: return "storage texel buffer";
    case Binding::Kind::combined_image: return "combined image and sampler";
    case Binding::Kind::sampled_image: return "sampled image";
    case Binding::Kind::storage_image: return "storage image";
    case Binding::Kind::sampler: return "sampler";
    case Binding::Kind::other: break;
  }
  return "resource of another kind";
}

Result<Reflection> reflect(std::span<const uint32_t> spirv) {
  Module module;
  if (Result<void> parsed = module.parse(spirv); !parsed) return parsed.take_error();
  return module.ask();
}

size_t instructions_of(std::span<const uint32_t> spirv) {
  size_t count = 0;
  bool inside = false;
  for (size_t at = spirv::kHeaderWords; at < spirv.size() && spirv[at] >> 16 != 0; at += spirv[at] >> 16) {
    const uint32_t op = spirv[at] & 0xffff;
    if (op == spirv::OpFunction) inside = true;
    count += inside;
    if (op == spirv::OpFunctionEnd) inside = false;
  }
  return count;
}

}  // namespace weft::compute
