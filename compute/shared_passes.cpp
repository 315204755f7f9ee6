// Compiled passes by their words. See shared_passes.h.
#include "compute/shared_passes.h"

#include <algorithm>

namespace weft::compute {

std::shared_ptr<const CompiledPass> SharedPasses::find(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto at = passes_.find(key);
  if (at == passes_.end()) return nullptr;
  at->second.used = ++calls_;
  return at->second.pass;
}

std::shared_ptr<const CompiledPass> SharedPasses::keep(Key key, std::shared_ptr<const CompiledPass> pass) {
  const std::lock_guard lock(mutex_);
  while (passes_.size() >= kMostKept) {
    auto oldest = passes_.end();
    for (auto at = passes_.begin(); at != passes_.end(); ++at)
      if (at->second.pass.use_count() == 1 && (oldest == passes_.end() || at->second.used < oldest->second.used)) oldest = at;
    if (oldest == passes_.end()) break;   // all are in use
    passes_.erase(oldest);
  }
  Kept& kept = passes_[std::move(key)];
  if (!kept.pass) kept.pass = std::move(pass);
  kept.used = ++calls_;
  return kept.pass;
}

std::size_t SharedPasses::count() const {
  const std::lock_guard lock(mutex_);
  return passes_.size();
}

void SharedPasses::clear() {
  const std::lock_guard lock(mutex_);
  std::erase_if(passes_, [](const auto& entry) { return entry.second.pass.use_count() == 1; });
}

}  // namespace weft::compute
