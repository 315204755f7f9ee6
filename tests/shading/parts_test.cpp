// What pictures are made with that needs no device: files, mip levels, the sky in closed form.
#include <gtest/gtest.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "engine/image.h"
#include "engine/shading/sky.h"
#include "engine/shading/textures.h"

namespace weft {
namespace {

TEST(Png, a_written_picture_is_read_back_and_nothing_else_is_left) {
  const std::filesystem::path folder = testing::TempDir() + "weft_png";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Image image{3, 2, {}};
  for (std::uint8_t i = 0; i < 24; ++i) image.rgba.push_back(static_cast<std::uint8_t>(10 * i));
  ASSERT_TRUE(write_png(folder / "a.png", image));
  auto read = read_image(folder / "a.png");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->width, 3u);
  EXPECT_EQ(read->height, 2u);
  EXPECT_EQ(read->rgba, image.rgba);
  const std::filesystem::directory_iterator entries(folder);
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
  auto nowhere = write_png(folder / "nowhere" / "a.png", image);
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().find("cannot be written"), std::string::npos) << nowhere.error();
  std::filesystem::remove_all(folder);
}

TEST(Png, a_file_cut_short_is_a_sentence) {
  const std::filesystem::path file = testing::TempDir() + "weft_cut_short.png";
  ASSERT_TRUE(write_png(file, Image{64, 64, std::vector<std::uint8_t>(4 * 64 * 64, 200)}));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  auto read = read_image(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("is not a whole PNG or JPEG"), std::string::npos) << read.error();
  std::filesystem::remove(file);
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<char>(value >> shift));
  return bytes;
}

std::string chunk(const std::string& name_and_data) {
  const auto* data = reinterpret_cast<const Bytef*>(name_and_data.data());
  const auto sum = static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(name_and_data.size())));
  return big_endian(static_cast<std::uint32_t>(name_and_data.size() - 4)) + name_and_data + big_endian(sum);
}

std::string deflated(const std::string& raw) {
  uLongf size = compressBound(raw.size());
  std::string packed(size, '\0');
  EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()), raw.size(), 1), Z_OK);
  packed.resize(size);
  return packed;
}

struct PngKind {
  std::uint32_t width, height;
  std::uint8_t depth, colour, interlaced;
};

std::string png_header(const PngKind& kind) {
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + big_endian(kind.width) + big_endian(kind.height) + static_cast<char>(kind.depth) +
                                     static_cast<char>(kind.colour) + std::string(2, '\0') + static_cast<char>(kind.interlaced));
}

Result<Image> read_bytes(const std::string& bytes) {
  const std::filesystem::path file = testing::TempDir() + "weft_made_" + testing::UnitTest::GetInstance()->current_test_info()->name();
  std::ofstream(file, std::ios::binary) << bytes;
  auto read = read_image(file);
  std::filesystem::remove(file);
  return read;
}

// What the specification says of a picture's data, counted apart from the reader.
std::size_t png_bytes(const PngKind& kind) {
  const std::size_t channels = kind.colour == 2 ? 3 : kind.colour == 4 ? 2 : kind.colour == 6 ? 4 : 1;
  const std::size_t starts[7][2] = {{0, 0}, {4, 0}, {0, 4}, {2, 0}, {0, 2}, {1, 0}, {0, 1}},
                    steps[7][2] = {{8, 8}, {8, 8}, {4, 8}, {4, 4}, {2, 4}, {2, 2}, {1, 2}};
  const auto part = [&](std::size_t w, std::size_t h) { return w == 0 ? 0 : h * (1 + (w * channels * kind.depth + 7) / 8); };
  if (!kind.interlaced) return part(kind.width, kind.height);
  std::size_t sum = 0;
  for (int pass = 0; pass < 7; ++pass) {
    const auto count = [&](std::size_t side, int axis) {
      return side > starts[pass][axis] ? (side - starts[pass][axis] + steps[pass][axis] - 1) / steps[pass][axis] : 0;
    };
    sum += part(count(kind.width, 0), count(kind.height, 1));
  }
  return sum;
}

TEST(Png, every_kind_is_read_whole_and_interlaced) {
  const PngKind kinds[] = {{1, 1, 1, 0, 0}, {13, 7, 1, 0, 0}, {13, 7, 2, 0, 1}, {9, 1, 4, 0, 1},  {1, 9, 8, 0, 1},  {33, 17, 16, 0, 1},
                           {5, 5, 8, 2, 0}, {31, 3, 8, 2, 1}, {8, 8, 16, 2, 1}, {17, 9, 1, 3, 1}, {17, 9, 8, 3, 0}, {6, 6, 8, 4, 1},
                           {6, 6, 16, 4, 0}, {64, 64, 8, 6, 1}, {7, 64, 16, 6, 1}, {3, 3, 16, 6, 0}};
  for (const PngKind& kind : kinds) {
    const std::string palette = kind.colour == 3 ? chunk("PLTE" + std::string(3 * (std::size_t{1} << kind.depth), '\x40')) : "";
    const std::string data = deflated(std::string(png_bytes(kind), '\0'));
    const std::string front = data.substr(0, data.size() / 2), back = data.substr(front.size());   // in two chunks
    const auto read = read_bytes(png_header(kind) + palette + chunk("IDAT" + front) + chunk("IDAT" + back) + chunk("IEND"));
    ASSERT_TRUE(read) << int(kind.depth) << ' ' << int(kind.colour) << ": " << read.error();
    EXPECT_EQ(read->width, kind.width);
    EXPECT_EQ(read->rgba.size(), std::size_t{4} * kind.width * kind.height);
  }
}

// A picture of some kilobytes that inflates to hundreds of megabytes.
TEST(Png, data_beyond_what_the_picture_takes_are_not_inflated) {
  const std::string bomb = deflated(std::string(std::size_t{256} << 20, '\0'));
  ASSERT_LT(bomb.size(), std::size_t{2} << 20);
  for (const PngKind& kind : {PngKind{1, 1, 8, 6, 0}, PngKind{1000, 1000, 8, 2, 1}, PngKind{16384, 1, 16, 6, 0}}) {
    const auto read = read_bytes(png_header(kind) + chunk("IDAT" + bomb) + chunk("IEND"));
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().find("its data are more than the "), std::string::npos) << read.error();
    const std::string front = chunk("IDAT" + bomb.substr(0, 7)), back = chunk("IDAT" + bomb.substr(7));
    const auto pieces = read_bytes(png_header(kind) + front + chunk("tEXt" + bomb) + back);
    ASSERT_FALSE(pieces);
    EXPECT_NE(pieces.error().find("its data are more than the "), std::string::npos) << pieces.error();
  }
  // Apple's variant has data of another form, behind a chunk that comes first.
  const std::string whole = png_header({1, 1, 8, 6, 0}), signature = whole.substr(0, 8);
  const auto foreign = read_bytes(signature + chunk("CgBI1234") + whole.substr(8) + chunk("IDAT" + bomb.substr(2)) + chunk("IEND"));
  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().find("it does not begin with its header"), std::string::npos) << foreign.error();
}

TEST(Png, a_picture_of_more_pixels_than_are_read_is_refused_by_its_header) {
  const auto vast = read_bytes(png_header({16384, 16384, 8, 6, 0}) + chunk("IDAT" + deflated("none")) + chunk("IEND"));
  ASSERT_FALSE(vast);
  EXPECT_NE(vast.error().find("has 16384 x 16384 pixels; at most 67108864 are read"), std::string::npos) << vast.error();
  const auto wide = read_bytes(png_header({16385, 1, 8, 6, 0}) + chunk("IDAT" + deflated("none")) + chunk("IEND"));
  ASSERT_FALSE(wide);
  const auto empty = read_bytes(png_header({3, 3, 8, 6, 0}) + chunk("IEND"));
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().find("its data are damaged or cut short"), std::string::npos) << empty.error();
}

TEST(Jpeg, a_picture_of_more_pixels_than_are_read_is_refused_by_its_header) {
  const std::filesystem::path file = testing::TempDir() + "weft_vast.jpg";
  const std::vector<std::uint8_t> grey(3 * 16 * 8, 130);
  ASSERT_TRUE(stbi_write_jpg(file.c_str(), 16, 8, 3, grey.data(), 90));
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t frame = bytes.find("\xff\xc0");   // marker, length, depth, then height and width
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, "\x40\x00\x40\x00", 4);
  const auto read = read_bytes(bytes);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("has 16384 x 16384 pixels"), std::string::npos) << read.error();
  std::filesystem::remove(file);
}

// Each scan is over 64 million pixels, and has no data.
TEST(Jpeg, a_file_of_more_scans_than_a_picture_has_is_refused) {
  const std::string header = "\xff\xd8\xff\xc2" + std::string("\x00\x0b\x08\x20\x00\x20\x00\x01\x01\x11\x00", 11);
  std::string scans;
  for (int k = 0; k < 101; ++k) scans += std::string("\xff\xda\x00\x08\x01\x01\x00\x00\x00\x00", 10);
  const auto read = read_bytes(header + scans + "\xff\xd9");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("it has 101 scans; at most 100 are read"), std::string::npos) << read.error();
}

TEST(Jpeg, a_picture_is_read) {
  const std::filesystem::path file = testing::TempDir() + "weft_grey.jpg";
  const std::vector<std::uint8_t> grey(3 * 16 * 8, 130);
  ASSERT_TRUE(stbi_write_jpg(file.c_str(), 16, 8, 3, grey.data(), 90));
  auto read = read_image(file);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->width, 16u);
  EXPECT_EQ(read->height, 8u);
  EXPECT_NEAR(read->rgba[4 * 37], 130, 2);
  std::filesystem::remove(file);
}

TEST(Png, a_folder_is_not_a_picture) {
  auto read = read_image(testing::TempDir());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("is not a file"), std::string::npos) << read.error();
}

TEST(MipLevels, average_colours_in_linear_light_and_data_as_it_is) {
  const Image board{2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255}};
  const auto colour = shading::mip_levels(board, shading::Content::colour);
  const auto data = shading::mip_levels(board, shading::Content::data);
  ASSERT_EQ(colour.size(), 2u);
  EXPECT_EQ(std::to_integer<int>(colour[1][0]), 188);  // half the light, encoded as sRGB
  EXPECT_EQ(std::to_integer<int>(data[1][0]), 128);
  const Image greys{2, 1, {100, 100, 100, 255, 200, 200, 200, 255}};
  const auto grey = shading::mip_levels(greys, shading::Content::colour);
  EXPECT_EQ(std::to_integer<int>(grey[1][0]), 160);  // 0.127 and 0.578 of white: 0.352
}

TEST(MipLevels, go_down_to_one_texel_for_any_shape) {
  const Image strip{13, 3, std::vector<std::uint8_t>(4 * 13 * 3, 77)};
  const auto levels = shading::mip_levels(strip, shading::Content::data);
  ASSERT_EQ(levels.size(), 4u);  // 13x3 6x1 3x1 1x1
  EXPECT_EQ(levels[1].size(), 4u * 6);
  EXPECT_EQ(levels[2].size(), 4u * 3);
  EXPECT_EQ(levels[3].size(), 4u);
  EXPECT_EQ(std::to_integer<int>(levels[3][0]), 77);
}

TEST(Sky, ambient_light_agrees_with_the_integral_over_the_sky) {
  shading::Frame frame{};
  shading::set_sky(frame, Light{}, {0.3f, 0.3f, 0.3f});
  const double zenith = frame.zenith.y, horizon = frame.horizon.y, ground = frame.ground.y;
  for (double n_y : {-1.0, -0.4, 0.0, 0.3, 0.8, 1.0}) {
    const double n_x = std::sqrt(1 - n_y * n_y);
    // The mean over the sphere's cosine lobe, by the midpoint rule in height and longitude.
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double y = 2 * (i + 0.5) / kSteps - 1, x = std::sqrt(1 - y * y) * std::cos(2 * std::numbers::pi * (j + 0.5) / kSteps);
        const double sky = y > 0 ? zenith + (horizon - zenith) * std::pow(1 - y, 4) : ground;
        sum += sky * std::max(n_x * x + n_y * y, 0.0);
      }
    const double exact = 4 * sum / (double{kSteps} * kSteps);
    const double harmonics = frame.ambient[0].y + frame.ambient[1].y * n_y + frame.ambient[2].y * (1.5 * n_y * n_y - 0.5);
    // Three harmonics of a lobe are known to be within a few per cent (Ramamoorthi and Hanrahan 2001).
    EXPECT_NEAR(harmonics / exact, 1, 0.05) << "n_y = " << n_y;
  }
}

}  // namespace
}  // namespace weft
