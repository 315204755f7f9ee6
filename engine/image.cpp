#include "engine/image.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_MAX_DIMENSIONS static_cast<int>(weft::kMostPixelsASide)
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "compute/file.h"

namespace weft {
namespace {

void append(void* to, void* bytes, int count) {
  auto& out = *static_cast<std::vector<char>*>(to);
  out.insert(out.end(), static_cast<char*>(bytes), static_cast<char*>(bytes) + count);
}

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;   // of a file: twice what sixteen bits a channel take

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

// Inflates piece by piece and keeps nothing.
class Inflation {
 public:
  Inflation() { inflateInit(&stream_); }
  ~Inflation() { inflateEnd(&stream_); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;

  /// Goes on until `data` is used up, the stream is over, or more than `most` bytes have come out in all.
  void take(std::string_view data, std::uint64_t most) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));   // zlib writes nothing there
    stream_.avail_in = static_cast<uInt>(data.size());
    do {
      stream_.next_out = page_.data();
      stream_.avail_out = static_cast<uInt>(page_.size());
      state_ = inflate(&stream_, Z_NO_FLUSH);
      bytes_ += page_.size() - stream_.avail_out;
    } while (state_ == Z_OK && bytes_ <= most && (stream_.avail_in > 0 || stream_.avail_out == 0));
  }
  bool whole() const { return state_ == Z_STREAM_END; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  z_stream stream_{};
  std::array<Bytef, 65536> page_;
  int state_ = Z_OK;
  std::uint64_t bytes_ = 0;
};

// stb_image inflates all that is there before it looks how much it needs, so whether that is the picture is found out first.
std::string png_fault(std::string_view file) {
  constexpr std::size_t kSignature = 8, kAround = 12;   // a chunk: length, name, data, checksum
  constexpr std::array<std::uint64_t, 7> kChannels = {1, 0, 3, 1, 2, 0, 4};   // by the type of colour
  if (file.size() < kSignature + kAround + 13 || file.substr(kSignature + 4, 4) != "IHDR") return "it does not begin with its header";
  const std::string_view header = file.substr(kSignature + 8, 13);
  const std::uint64_t width = big_endian(header.substr(0, 4)), height = big_endian(header.substr(4, 4));
  const std::size_t colour = static_cast<unsigned char>(header[9]);
  const std::uint64_t bits = static_cast<unsigned char>(header[8]) * (colour < kChannels.size() ? kChannels[colour] : 0);
  // A row takes a byte more, for its filter, and is filled up to a byte. An interlaced picture has less than twice as many rows, and 8.
  const std::uint64_t most = width * height * bits / 8 + 4 * height + 16;
  Inflation inflation;
  for (std::size_t at = kSignature; at < file.size() && !inflation.whole();) {
    const std::uint64_t length = file.size() - at < kAround ? file.size() : big_endian(file.substr(at, 4));
    if (length > file.size() - at - std::min(kAround, file.size() - at)) return "a chunk is cut short";
    if (file.substr(at + 4, 4) == "IDAT") inflation.take(file.substr(at + 8, length), most);
    if (inflation.bytes() > most)
      return fail("its data are more than the ", most, " bytes that its ", width, " x ", height, " pixels take").message;
    at += length + kAround;
  }
  return inflation.whole() ? "" : "its data are damaged or cut short";
}

// A scan goes over the whole picture, and takes ten bytes of the file: some kilobytes could keep a processor busy for minutes.
std::string jpeg_fault(std::string_view file) {
  constexpr std::size_t kMostScans = 100;   // progressive pictures have some ten
  std::size_t scans = 0;
  for (std::size_t at = file.find("\xff\xda"); at != std::string_view::npos; at = file.find("\xff\xda", at + 2)) ++scans;
  return scans <= kMostScans ? "" : fail("it has ", scans, " scans; at most ", kMostScans, " are read").message;
}

// Nothing where the file can be decoded within the memory, and about the time, that its picture takes.
std::string fault_of(std::string_view file) {
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(file.data()), static_cast<int>(file.size()), &width, &height, &channels))
    return fail("is not a whole PNG or JPEG: ", stbi_failure_reason()).message;
  if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > kMostPixels)
    return fail("has ", width, " x ", height, " pixels; at most ", kMostPixels, " are read").message;
  const std::string fault = file.starts_with("\x89PNG") ? png_fault(file) : jpeg_fault(file);
  return fault.empty() ? "" : "is not a whole PNG or JPEG: " + fault;
}

}  // namespace

Result<Image> decode_image(std::string_view bytes, const std::string& name) try {
  if (bytes.size() > kMostBytes) return fail(name, " has ", bytes.size(), " bytes; at most ", kMostBytes, " are read");
  if (const std::string fault = fault_of(bytes); !fault.empty()) return fail(name, " ", fault);

  int width = 0, height = 0, channels = 0;
  const auto* encoded = reinterpret_cast<const stbi_uc*>(bytes.data());
  const std::unique_ptr<stbi_uc, decltype(&std::free)> pixels(
      stbi_load_from_memory(encoded, static_cast<int>(bytes.size()), &width, &height, &channels, 4), &std::free);
  if (!pixels) return fail(name, " is not a whole PNG or JPEG: ", stbi_failure_reason());
  Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * image.width * image.height);
  return image;
} catch (...) {
  return caught("the picture");
}

Result<Image> read_image(const std::filesystem::path& file) try {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return fail("picture \"", file.string(), "\" does not exist");
  if (!std::filesystem::is_regular_file(file, code)) return fail("picture \"", file.string(), "\" is not a file");
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (!code && size > kMostBytes)
    return fail("picture \"", file.string(), "\" has ", size, " bytes; at most ", kMostBytes, " are read");
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(code ? 0 : size, '\0');
  if (code || !stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    return fail("picture \"", file.string(), "\" cannot be read");
  return decode_image(bytes, "picture \"" + file.string() + "\"");
} catch (...) {
  return caught("the picture");
}

Result<void> write_png(const std::filesystem::path& file, const Image& image) try {
  if (image.width == 0 || image.height == 0 || image.rgba.size() != std::size_t{4} * image.width * image.height)
    return fail("picture \"", file.string(), "\" of ", image.width, " x ", image.height, " pixels has ", image.rgba.size(),
                " bytes; needed are 4 a pixel");
  std::vector<char> bytes;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  if (!stbi_write_png_to_func(&append, &bytes, width, height, 4, image.rgba.data(), 4 * width))
    return fail("picture \"", file.string(), "\" could not be encoded");

  return write_file(file, std::as_bytes(std::span(bytes)));
} catch (...) {
  return caught("the picture");
}

}  // namespace weft
