// Where everything lies in a cache of one file. Internal.
//
// The places of all frames are known before the first: a frame is written where it belongs, and what follows the frames in the file is
// written before them. So nothing has to be remembered, and a run that goes on needs to know only how many frames there are.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "engine/cache.h"

namespace weft::caching {

/// Takes bytes at their offset: to write them, or to compare them with what is there.
using Put = std::function<Result<void>(std::uint64_t offset, std::span<const std::byte> bytes)>;

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

class Layout {
 public:
  virtual ~Layout() = default;
  /// Of the whole file.
  virtual std::uint64_t bytes() const = 0;
  /// Everything but frames.
  virtual Result<void> put_frameless(const Put& put) const = 0;
  /// A frame, counted from 0, that check_frame has found good.
  virtual Result<void> put_frame(std::uint32_t frame, const CacheFrame& content, const Put& put) const = 0;
};

/// Each refuses, with a sentence that begins with the file's name, what its format does not hold. `mesh` is read in the call only.
using LayoutResult = Result<std::unique_ptr<Layout>>;
LayoutResult pc2_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options);
LayoutResult mdd_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options);
LayoutResult glb_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options);
LayoutResult usda_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options);

}  // namespace weft::caching
