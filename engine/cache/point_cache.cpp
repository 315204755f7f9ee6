// PC2 and MDD: a header and positions. Sources: the exporters of Blender, io_export_pc2 and io_shape_mdd.
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "engine/cache/layout.h"

namespace weft::caching {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Vec3) == 12);

class Points : public Layout {
 public:
  Points(bool big_endian, std::uint64_t points, const CacheOptions& options)
      : big_endian_(big_endian), points_(points), frames_(options.frames), rate_(options.rate) {}

  std::uint64_t bytes() const override { return head_bytes() + frames_ * points_ * sizeof(Vec3); }

  Result<void> put_frameless(const Put& put) const override {
    std::string head;
    const auto add = [&](auto value) {
      std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
      if (big_endian_) bits = turned(bits);
      head.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    };
    const auto points = static_cast<std::uint32_t>(points_), frames = static_cast<std::uint32_t>(frames_);
    if (big_endian_) {
      add(frames);
      add(points);
      for (std::uint32_t k = 1; k <= frames; ++k) add(static_cast<float>(k / rate_));   // s
      return put(0, bytes_of(head));
    }
    head.append("POINTCACHE2\0", 12);
    add(std::uint32_t{1});   // version
    add(points);
    add(1.0f);   // the frame of the first sample
    add(1.0f);   // frames a sample
    add(frames);
    return put(0, bytes_of(head));
  }

  Result<void> put_frame(std::uint32_t frame, const CacheFrame& content, const Put& put) const override {
    const std::uint64_t at = head_bytes() + frame * points_ * sizeof(Vec3);
    if (!big_endian_) return put(at, std::as_bytes(content.positions));
    std::vector<std::uint32_t> words(3 * points_);
    std::memcpy(words.data(), content.positions.data(), content.positions.size_bytes());
    for (std::uint32_t& word : words) word = turned(word);
    return put(at, std::as_bytes(std::span(words)));
  }

 private:
  static std::uint32_t turned(std::uint32_t w) { return w >> 24 | (w >> 8 & 0xff00u) | (w << 8 & 0xff0000u) | w << 24; }
  std::uint64_t head_bytes() const { return big_endian_ ? 8 + 4 * frames_ : 32; }

  bool big_endian_;
  std::uint64_t points_, frames_;
  double rate_;
};

LayoutResult layout_of(bool big_endian, const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
  if (const std::uint64_t points = mesh.positions.size(); points > most || options.frames > most)
    return fail(file.string(), " is not written: ", options.frames, " frames of ", points, " points, and the format has at most ", most,
                " of each");
  return std::unique_ptr<Layout>(new Points(big_endian, mesh.positions.size(), options));
}

}  // namespace

LayoutResult pc2_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  return layout_of(false, file, mesh, options);
}

LayoutResult mdd_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  return layout_of(true, file, mesh, options);
}

}  // namespace weft::caching
