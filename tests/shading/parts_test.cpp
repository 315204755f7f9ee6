// What pictures are made with that needs no device: files, mip levels, the sky in closed form.
#include <gtest/gtest.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/shading/image.h"
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
