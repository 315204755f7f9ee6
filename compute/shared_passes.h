// The passes that a device has compiled, so that simulations share them: whoever makes a second one like the first, or the first anew, waits
// for no compiler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compute/descriptors.h"
#include "compute/pipeline.h"

namespace weft::compute {

/// A pass's code, ready to be bound.
struct CompiledPass {
  DescriptorLayout layouts[2];   // by set: not every device can hold all bindings in one
  OwnedPipelineLayout layout;
  ComputePipeline pipeline;
};

/// Any thread may call it.
class SharedPasses {
 public:
  /// Those that nobody uses any more are kept up to this many.
  static constexpr std::size_t kMostKept = 256;

  /// The pass of this label and of exactly these words, or what `make` returns, which is kept. `make`: Result<CompiledPass>().
  template <class Make>
  Result<std::shared_ptr<const CompiledPass>> get(std::string_view label, std::span<const uint32_t> spirv, Make&& make) {
    Key key(std::string(label), {spirv.begin(), spirv.end()});
    if (auto known = find(key)) return known;
    Result<CompiledPass> made = make();
    if (!made) return made.take_error();
    return keep(std::move(key), std::make_shared<const CompiledPass>(std::move(*made)));
  }
  /// How many there are.
  std::size_t count() const;
  /// Of all that nobody uses.
  void clear();

 private:
  using Key = std::pair<std::string, std::vector<uint32_t>>;
  struct Kept {
    std::shared_ptr<const CompiledPass> pass;
    std::uint64_t used = 0;   // when, in calls
  };
  std::shared_ptr<const CompiledPass> find(const Key& key);
  /// What another thread has kept in the meantime goes first.
  std::shared_ptr<const CompiledPass> keep(Key key, std::shared_ptr<const CompiledPass> pass);

  mutable std::mutex mutex_;
  std::map<Key, Kept> passes_;
  std::uint64_t calls_ = 0;
};

}  // namespace weft::compute
