#include "compute/specialize.h"

#include <algorithm>
#include <set>
#include <spirv-tools/optimizer.hpp>
#include <string>
#include <unordered_map>

#include "compute/digest.h"
#include "compute/reflect.h"
#include "compute/spirv.h"

namespace weft::compute {
namespace {
// Of what `specialize` does: to be raised with each change of its passes, so that no file's words are taken for today's.
constexpr uint32_t kVersion = 1;

// glslang's own numbers repeat where a resource is used by the initialiser of a global alone.
void number_bindings(std::span<uint32_t> spirv) {
  uint32_t next = 0;
  for (size_t at = spirv::kHeaderWords; at < spirv.size() && spirv[at] >> 16 != 0; at += spirv[at] >> 16)
    if ((spirv[at] & 0xffff) == spirv::OpDecorate && spirv[at] >> 16 == 4 && spirv[at + 2] == spirv::kBinding) spirv[at + 3] = next++;
}

}  // namespace

Result<std::vector<uint32_t>> specialize(std::span<const uint32_t> spirv, std::span<const SpecializationConstant> constants) {
  if (spirv.size() < spirv::kHeaderWords)
    return fail("SPIR-V of ", spirv.size(), " words is shorter than its header of ", spirv::kHeaderWords);
  std::unordered_map<uint32_t, std::vector<uint32_t>> values;
  for (const SpecializationConstant& constant : constants) values[constant.id] = {constant.value};
  spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
  std::string complaint;
  optimizer.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* message) {
    if (level <= SPV_MSG_ERROR && complaint.empty()) complaint = message;
  });
  optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values))
      .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
      .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
      .RegisterPass(spvtools::CreateCCPPass())
      .RegisterPass(spvtools::CreateDeadBranchElimPass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass())
      .RegisterPass(spvtools::CreateBlockMergePass());
  // Weft's own modules were validated when they were built.
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);
  std::vector<uint32_t> specialized;
  if (!optimizer.Run(spirv.data(), spirv.size(), &specialized, options))
    return fail("SPIR-V could not be specialised: ", complaint.empty() ? "the optimizer gave no reason" : complaint);
  number_bindings(specialized);
  return specialized;
}

namespace {

// Constants that some instruction uses: the others change nothing. A literal that happens to have a constant's id counts as a use, which
// only shares less.
std::vector<uint32_t> used_constants(std::span<const uint32_t> spirv) {
  using namespace spirv;
  constexpr uint32_t kMostIds = 1u << 22, kNone = ~0u;   // SPIR-V's own limit (2.17, universal limits)
  if (spirv.size() < kHeaderWords) return {};
  std::vector<uint32_t> specs(std::min(spirv[kBound], kMostIds), kNone);   // result -> number
  std::set<uint32_t> used;
  for (size_t at = spirv::kHeaderWords; at < spirv.size() && spirv[at] >> 16 != 0; at += spirv[at] >> 16) {
    const auto words = spirv.subspan(at, std::min<size_t>(spirv[at] >> 16, spirv.size() - at));
    const uint32_t op = words[0] & 0xffff;
    if (op == OpDecorate && words.size() > 3 && words[2] == kSpecId && words[1] < specs.size()) specs[words[1]] = words[3];
    const bool names = op == OpName || op == OpDecorate || op == OpSpecConstantTrue || op == OpSpecConstantFalse || op == OpSpecConstant;
    for (size_t k = 1; k < words.size() && !names; ++k)
      if (words[k] < specs.size() && specs[words[k]] != kNone) used.insert(specs[words[k]]);
  }
  return {used.begin(), used.end()};
}

std::vector<uint32_t> key_of(std::span<const uint32_t> spirv, std::span<const SpecializationConstant> constants) {
  Digest digest;
  digest.add(std::as_bytes(spirv));
  std::vector<uint32_t> key = {kVersion, static_cast<uint32_t>(digest.value()), static_cast<uint32_t>(digest.value() >> 32)};
  for (const uint32_t id : used_constants(spirv))
    for (const SpecializationConstant& constant : constants)
      if (constant.id == id) key.insert(key.end(), {id, constant.value});
  return key;
}

}  // namespace

Result<std::span<const uint32_t>> Specializer::specialize(std::span<const uint32_t> spirv,
                                                          std::span<const SpecializationConstant> constants) {
  std::vector<uint32_t> key = key_of(spirv, constants);
  const std::lock_guard lock(mutex_);
  auto made = made_.find(key);
  if (made == made_.end()) {
    auto words = compute::specialize(spirv, constants);
    if (!words) return words.take_error();
    made = made_.emplace(std::move(key), std::move(*words)).first;
  }
  return std::span<const uint32_t>(made->second);
}

size_t Specializer::modules() const {
  const std::lock_guard lock(mutex_);
  return made_.size();
}

namespace {

// Of each: the lengths of its key and of its words, its key, its words.
size_t words_of(const std::map<std::vector<uint32_t>, std::vector<uint32_t>>& made) {
  size_t count = 0;
  for (const auto& [key, words] : made) count += 2 + key.size() + words.size();
  return count;
}

}  // namespace

size_t Specializer::remembered_words() const {
  const std::lock_guard lock(mutex_);
  return words_of(made_);
}

std::vector<uint32_t> Specializer::remembered() const {
  const std::lock_guard lock(mutex_);
  std::vector<uint32_t> all;
  all.reserve(words_of(made_));
  for (const auto& [key, words] : made_) {
    all.insert(all.end(), {static_cast<uint32_t>(key.size()), static_cast<uint32_t>(words.size())});
    all.insert(all.end(), key.begin(), key.end());
    all.insert(all.end(), words.begin(), words.end());
  }
  return all;
}

void Specializer::remember(std::span<const uint32_t> remembered) {
  const std::lock_guard lock(mutex_);
  while (remembered.size() >= 2) {
    const size_t key = remembered[0], words = remembered[1];
    remembered = remembered.subspan(2);
    if (key > remembered.size() || words > remembered.size() - key) return;
    std::vector<uint32_t> name(remembered.begin(), remembered.begin() + static_cast<std::ptrdiff_t>(key));
    const auto one = remembered.subspan(key, words);
    if (key > 0 && name[0] == kVersion && !made_.contains(name) && reflect(one))
      made_.try_emplace(std::move(name), one.begin(), one.end());
    remembered = remembered.subspan(key + words);
  }
}

}  // namespace weft::compute
