#include "engine/shading/image.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>

#include "compute/file.h"

namespace weft {
namespace {

void append(void* to, void* bytes, int count) {
  auto& out = *static_cast<std::vector<char>*>(to);
  out.insert(out.end(), static_cast<char*>(bytes), static_cast<char*>(bytes) + count);
}

}  // namespace

Result<Image> read_image(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return fail("picture \"", file.string(), "\" does not exist");
  if (!std::filesystem::is_regular_file(file, code)) return fail("picture \"", file.string(), "\" is not a file");
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) return fail("picture \"", file.string(), "\" cannot be read");
  if (bytes.size() > std::size_t{1} << 30)
    return fail("picture \"", file.string(), "\" has ", bytes.size(), " bytes; at most ", std::size_t{1} << 30, " are read");

  int width = 0, height = 0, channels = 0;
  const auto* encoded = reinterpret_cast<const stbi_uc*>(bytes.data());
  const std::unique_ptr<stbi_uc, decltype(&std::free)> pixels(
      stbi_load_from_memory(encoded, static_cast<int>(bytes.size()), &width, &height, &channels, 4), &std::free);
  if (!pixels) return fail("picture \"", file.string(), "\" is not a whole PNG or JPEG: ", stbi_failure_reason());
  Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * image.width * image.height);
  return image;
}

Result<void> write_png(const std::filesystem::path& file, const Image& image) {
  if (image.width == 0 || image.height == 0 || image.rgba.size() != std::size_t{4} * image.width * image.height)
    return fail("picture \"", file.string(), "\" of ", image.width, " x ", image.height, " pixels has ", image.rgba.size(),
                " bytes; needed are 4 a pixel");
  std::vector<char> bytes;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  if (!stbi_write_png_to_func(&append, &bytes, width, height, 4, image.rgba.data(), 4 * width))
    return fail("picture \"", file.string(), "\" could not be encoded");

  return write_file(file, std::as_bytes(std::span(bytes)));
}

}  // namespace weft
