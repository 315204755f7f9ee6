// Pictures: what must hold of any picture, on whatever device there is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "engine/shading/shading.h"
#include "tests/support/on_device.h"

namespace weft {
namespace {

constexpr VkExtent2D kSize{192, 108};
constexpr std::uint32_t kCells = 24;

using Place = std::function<Vec3(float, float)>;  // of a sheet's point with texture coordinates (s, t)

// Upright, two metres square, facing +z, around (0, 1, 0).
Vec3 upright(float s, float t) { return {2 * s - 1, 2 - 2 * t, 0}; }
Vec3 wavy(float s, float t) { return {2 * s - 1, 2 - 2 * t, 0.15f * std::sin(14 * s) * (0.5f + t)}; }

class Pictures : public compute::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    folder_ = testing::TempDir() + "weft_pictures_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    scene_.folder = folder_;
    scene_.cloths.resize(1);
    scene_.camera.eye = {0, 1, 4};
    scene_.camera.target = {0, 1, 0};
    scene_.light.direction = {0, -0.5f, -1};
    look().base_colour = {0.6f, 0.6f, 0.6f};
  }
  void TearDown() override {
    arena_ = {};
    OnDevice::TearDown();
    std::filesystem::remove_all(folder_);
  }

  Appearance& look() { return scene_.cloths[0].appearance; }

  void add_floor() {
    scene_.colliders.emplace_back();
    scene_.colliders.back().colour = {0.4f, 0.4f, 0.4f};
  }

  // One texel repeated: enough for a map that is the same everywhere.
  std::string map_of(const std::string& name, std::array<std::uint8_t, 3> texel) {
    Image image{4, 4, {}};
    for (int i = 0; i < 16; ++i) image.rgba.insert(image.rgba.end(), {texel[0], texel[1], texel[2], 255});
    auto written = write_png(folder_ / name, image);
    EXPECT_TRUE(written) << written.error();
    return name;
  }

  // Puts a sheet on the device: its mesh, and positions and normals as a simulation would leave them.
  void make_sheet(const Place& place) {
    mesh_ = {};
    std::vector<Vec4> positions, normals;
    const auto step = [](std::uint32_t i) { return static_cast<float>(i) / kCells; };
    for (std::uint32_t j = 0; j <= kCells; ++j)
      for (std::uint32_t i = 0; i <= kCells; ++i) {
        const float s = step(i), t = step(j), e = 1e-3f;
        const Vec3 p = place(s, t), down = place(s, t + e) - place(s, t - e), right = place(s + e, t) - place(s - e, t);
        const Vec3 n = cross(down, right), unit = (1 / length(n)) * n;
        mesh_.positions.push_back(p);
        mesh_.uvs.push_back({s, t});
        positions.push_back({p.x, p.y, p.z, 1});
        normals.push_back({unit.x, unit.y, unit.z, 0});
      }
    for (std::uint32_t j = 0; j < kCells; ++j)
      for (std::uint32_t i = 0; i < kCells; ++i) {
        const std::uint32_t a = j * (kCells + 1) + i, b = a + 1, c = a + kCells + 1, d = c + 1;
        mesh_.triangles.push_back({a, c, b});
        mesh_.triangles.push_back({b, c, d});
      }
    const VkDeviceSize bytes = positions.size() * sizeof(Vec4);
    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const std::array requests = {compute::BufferRequest{"positions", bytes, kUsage, VK_FORMAT_UNDEFINED},
                                 compute::BufferRequest{"normals", bytes, kUsage, VK_FORMAT_UNDEFINED}};
    auto arena = compute::Arena::create(*device_, compute::Memory::device, "sheet", requests);
    ASSERT_TRUE(arena) << arena.error();
    arena_ = std::move(*arena);
    const std::array uploads = {compute::Upload{&arena_[0], std::as_bytes(std::span(positions))},
                                compute::Upload{&arena_[1], std::as_bytes(std::span(normals))}};
    auto uploaded = compute::upload_all(*device_, uploads);
    ASSERT_TRUE(uploaded) << uploaded.error();
  }

  Result<std::unique_ptr<Shading>> create() {
    const ShadedCloth cloth{&mesh_, &look(), transmission_};
    return Shading::create(*device_, scene_, {&cloth, 1}, kSize);
  }

  Poses poses() {
    colliders_.clear();
    for (const Collider& collider : scene_.colliders) colliders_.push_back({collider.centre, collider.normal});
    Poses frame;
    frame.positions.buffer = arena_[0].handle;
    frame.normals.buffer = arena_[1].handle;
    frame.positions.count = frame.normals.count = static_cast<std::uint32_t>(mesh_.positions.size());
    frame.colliders = colliders_;
    return frame;
  }

  Image picture() {
    auto shading = create();
    if (!shading) {
      ADD_FAILURE() << shading.error();
      return Image{};
    }
    auto image = (*shading)->draw(poses());
    if (!image) {
      ADD_FAILURE() << image.error();
      return Image{};
    }
    return std::move(*image);
  }

  std::filesystem::path folder_;
  Scene scene_;
  RenderMesh mesh_;
  compute::Arena arena_;
  std::vector<ColliderPose> colliders_;
  double transmission_ = 0;
};

// Mean of one channel over the middle ninth, in linear light up to the tone curve.
double middle(const Image& image, std::size_t channel) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t y = image.height / 3; y < 2 * image.height / 3; ++y)
    for (std::size_t x = image.width / 3; x < 2 * image.width / 3; ++x, ++count)
      sum += std::pow(image.rgba[4 * (y * image.width + x) + channel] / 255.0, 2.2);
  return count == 0 ? 0 : sum / static_cast<double>(count);
}
double brightness(const Image& image) { return 0.2126 * middle(image, 0) + 0.7152 * middle(image, 1) + 0.0722 * middle(image, 2); }

TEST_F(Pictures, a_picture_is_bitwise_the_same_each_time) {
  add_floor();
  make_sheet(wavy);
  auto shading = create();
  ASSERT_TRUE(shading) << shading.error();
  const auto first = (*shading)->draw(poses()), second = (*shading)->draw(poses());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->rgba, second->rgba);
  EXPECT_EQ(first->rgba, picture().rgba);
}

TEST_F(Pictures, a_recorded_picture_has_the_bits_of_a_drawn_one) {
  make_sheet(wavy);
  add_floor();
  auto shading = create();
  ASSERT_TRUE(shading) << shading.error();
  auto drawn = (*shading)->draw(poses());
  ASSERT_TRUE(drawn) << drawn.error();
  const compute::BufferRequest pixels{"pixels", drawn->rgba.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  auto arena = compute::Arena::create(*device_, compute::Memory::readback, "pixels", {&pixels, 1});
  ASSERT_TRUE(arena) << arena.error();
  // The host's own copy, with no barrier but what record leaves.
  auto done = compute::run_once(*device_, "host", [&](VkCommandBuffer commands) {
    auto recorded = (*shading)->record(commands, poses());
    EXPECT_TRUE(recorded) << recorded.error();
    VkBufferImageCopy whole{};
    whole.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    whole.imageExtent = {kSize.width, kSize.height, 1};
    device_->vk().vkCmdCopyImageToBuffer(commands, (*shading)->image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, (*arena)[0].handle, 1, &whole);
  });
  ASSERT_TRUE(done) << done.error();
  EXPECT_EQ(std::memcmp((*arena)[0].mapped, drawn->rgba.data(), drawn->rgba.size()), 0);
  auto again = (*shading)->draw(poses());
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->rgba, drawn->rgba);
  EXPECT_FALSE((*shading)->record(VK_NULL_HANDLE, poses()));
}

TEST_F(Pictures, another_size_has_the_bits_of_a_picture_that_was_made_so_and_reads_no_texture_again) {
  look().albedo = map_of("red.png", {200, 30, 30});
  make_sheet(wavy);
  add_floor();
  const ShadedCloth cloth{&mesh_, &look(), transmission_};
  constexpr VkExtent2D kOther{100, 140};
  auto made_so = Shading::create(*device_, scene_, {&cloth, 1}, kOther);
  auto shading = create();
  ASSERT_TRUE(made_so && shading);
  const auto wanted = (*made_so)->draw(poses()), before = (*shading)->draw(poses());
  ASSERT_TRUE(wanted && before);
  std::filesystem::remove_all(folder_);
  const auto resize = [&](VkExtent2D to) {
    auto done = (*shading)->resize(to);
    EXPECT_TRUE(done) << done.error();
  };
  resize(kOther);
  const auto other = (*shading)->draw(poses());
  ASSERT_TRUE(other) << other.error();
  EXPECT_EQ(other->height, kOther.height);
  EXPECT_EQ(other->rgba, wanted->rgba);
  const auto refused = (*shading)->resize({8193, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "a picture of 8193 x 1 pixels is outside 1 x 1 ... 8192 x 8192");
  EXPECT_EQ((*shading)->draw(poses()).value().rgba, wanted->rgba);
  resize(kSize);
  EXPECT_EQ((*shading)->draw(poses()).value().rgba, before->rgba);
}

TEST_F(Pictures, no_pixel_is_black_and_all_are_opaque) {
  add_floor();
  scene_.colliders.emplace_back();
  scene_.colliders.back().shape = ColliderShape::sphere;
  scene_.colliders.back().centre = {0.6f, 0.5f, 0.7f};
  make_sheet(wavy);
  const Image image = picture();
  ASSERT_EQ(image.rgba.size(), std::size_t{4} * kSize.width * kSize.height);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    // A value that is not a number becomes 0 in an 8-bit target. The darkest that is lit by this sky is well above 3.
    ASSERT_GT(image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2], 3) << "pixel " << i / 4;
    ASSERT_EQ(image.rgba[i + 3], 255);
  }
}

TEST_F(Pictures, a_back_face_in_the_sun_is_as_bright_as_a_front_face) {
  make_sheet(wavy);
  const double front = brightness(picture());
  scene_.camera.eye.z = -scene_.camera.eye.z;
  scene_.light.direction.z = -scene_.light.direction.z;
  const double back = brightness(picture());
  // The waves are seen from their other side, so they shade a little differently.
  EXPECT_NEAR(back / front, 1, 0.03);
}

TEST_F(Pictures, light_along_a_sheet_lights_both_sides_alike) {
  make_sheet(upright);
  scene_.light.direction = {-0.3f, -1, 0};
  const double front = brightness(picture());
  scene_.camera.eye.z = -scene_.camera.eye.z;
  EXPECT_NEAR(brightness(picture()) / front, 1, 0.01);
}

TEST_F(Pictures, a_sheet_turned_from_the_sun_is_dark_unless_light_shines_through) {
  make_sheet(upright);
  const double lit = brightness(picture());
  scene_.light.direction.z = 1;
  const double turned = brightness(picture());
  transmission_ = 0.3;
  const double through = brightness(picture());
  EXPECT_LT(turned, 0.5 * lit);
  EXPECT_GT(through, 1.2 * turned);
  EXPECT_LT(through, lit);
}

TEST_F(Pictures, a_sheet_shades_the_floor_below_it) {
  add_floor();
  make_sheet([](float s, float t) { return Vec3{2 * s - 1, 1.2f, 2 * t - 1}; });
  scene_.light.direction = {0, -1, 0};
  scene_.camera.eye = {0, 0.5f, 2};
  scene_.camera.target = {0, 0, 0};
  scene_.camera.fov_degrees = 20;
  const double shaded = brightness(picture());
  scene_.camera.eye.x = scene_.camera.target.x = 2.5f;
  EXPECT_LT(shaded, 0.5 * brightness(picture()));
}

TEST_F(Pictures, a_sheet_in_the_sun_does_not_shade_itself) {
  make_sheet(upright);
  double brightest = 0, darkest = 1;
  for (const Vec3 direction : {Vec3{0, -0.1f, -1}, Vec3{0.3f, -0.7f, -1}, Vec3{-2, -1, -1}}) {
    scene_.light.direction = direction;
    const Image image = picture();
    brightest = 0, darkest = 1;
    for (std::size_t y = kSize.height / 3; y < 2 * kSize.height / 3; ++y)
      for (std::size_t x = kSize.width / 3; x < 2 * kSize.width / 3; ++x) {
        const double value = image.rgba[4 * (y * kSize.width + x) + 1];
        brightest = std::max(brightest, value / 255);
        darkest = std::min(darkest, value / 255);
      }
    // Highlights vary slowly; a spot of false shadow would be a fifth darker at least.
    EXPECT_GT(darkest, 0.88 * brightest);
  }
}

TEST_F(Pictures, a_red_picture_makes_the_cloth_red) {
  look().albedo = map_of("red.png", {200, 10, 10});
  look().base_colour = {1, 1, 1};
  make_sheet(wavy);
  const Image image = picture();
  EXPECT_GT(middle(image, 0), 5 * middle(image, 1));
  EXPECT_GT(middle(image, 0), 5 * middle(image, 2));
}

TEST_F(Pictures, a_normal_map_turns_with_the_cloth) {
  // Leans to where u grows: to the right on the upright sheet, to the left once that stands on its head.
  look().normal = map_of("leaning.png", {218, 128, 218});
  const Place on_its_head = [](float s, float t) { return Vec3{1 - 2 * s, 2 * t, 0}; };
  const auto right_over_left = [&](const Place& place) {
    make_sheet(place);
    scene_.light.direction = {-1, -0.5f, -1};
    const double from_right = brightness(picture());
    scene_.light.direction.x = 1;
    return from_right / brightness(picture());
  };
  EXPECT_GT(right_over_left(upright), 1.5);
  EXPECT_LT(right_over_left(on_its_head), 1 / 1.5);
}

TEST_F(Pictures, a_normal_map_leans_up_where_it_is_green) {
  look().normal = map_of("leaning.png", {128, 218, 218});
  make_sheet(upright);
  scene_.light.direction = {0, -1, -1};
  const double from_above = brightness(picture());
  scene_.light.direction.y = 1;
  EXPECT_GT(from_above, 1.5 * brightness(picture()));
}

TEST_F(Pictures, occlusion_and_roughness_maps_are_read) {
  make_sheet(upright);
  look().roughness_factor = 1;
  scene_.light.direction = {0, 0, -1};
  const double plain = brightness(picture());
  look().roughness = map_of("smooth.png", {70, 70, 70});
  EXPECT_GT(brightness(picture()), 1.1 * plain);
  look().roughness.clear();
  look().occlusion = map_of("closed.png", {0, 0, 0});
  EXPECT_LT(brightness(picture()), 0.95 * plain);
}

TEST_F(Pictures, the_camera_can_be_moved_between_pictures) {
  make_sheet(upright);
  auto shading = create();
  ASSERT_TRUE(shading) << shading.error();
  const auto before = (*shading)->draw(poses());
  scene_.camera.eye = {2, 1, 3};
  (*shading)->look_from(scene_.camera);
  const auto after = (*shading)->draw(poses());
  ASSERT_TRUE(before && after);
  EXPECT_NE(before->rgba, after->rgba);
}

TEST_F(Pictures, a_frame_is_waited_for) {
  make_sheet(upright);
  auto shading = create();
  ASSERT_TRUE(shading) << shading.error();
  auto timeline = compute::create_timeline(*device_, "frame", 7);
  ASSERT_TRUE(timeline) << timeline.error();
  Poses frame = poses();
  frame.ready = timeline->get();
  frame.ready_value = 7;
  const auto image = (*shading)->draw(frame);
  EXPECT_TRUE(image) << image.error();
}

TEST_F(Pictures, a_missing_or_foreign_texture_is_a_sentence) {
  make_sheet(upright);
  look().albedo = "nowhere.png";
  auto missing = create();
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().find("nowhere.png\" does not exist"), std::string::npos) << missing.error();
  std::ofstream(folder_ / "text.png") << "this is not a picture";
  look().albedo = "text.png";
  auto foreign = create();
  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().find("text.png\" is not a whole PNG or JPEG"), std::string::npos) << foreign.error();
}

TEST_F(Pictures, frames_that_do_not_fit_are_sentences) {
  make_sheet(upright);
  add_floor();
  auto shading = create();
  ASSERT_TRUE(shading) << shading.error();
  const auto refuses = [&](const char* what, const Poses& frame) {
    auto image = (*shading)->draw(frame);
    ASSERT_FALSE(image);
    EXPECT_NE(image.error().find(what), std::string::npos) << image.error();
  };
  Poses frame = poses();
  frame.positions.count = 7;
  refuses("has 7 positions, but the cloths have 625", frame);
  frame = poses();
  frame.normals.stride = 12;
  refuses("normals have format 109 and a stride of 12 bytes", frame);
  frame = poses();
  frame.positions.buffer = VK_NULL_HANDLE;
  refuses("positions have no buffer", frame);
  frame = poses();
  frame.colliders = {};
  refuses("0 collider poses, but the scene has 1", frame);
}

TEST_F(Pictures, a_size_of_nothing_is_a_sentence) {
  make_sheet(upright);
  const ShadedCloth cloth{&mesh_, &look(), 0};
  auto none = Shading::create(*device_, scene_, {&cloth, 1}, {0, 10});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "a picture of 0 x 10 pixels is outside 1 x 1 ... 8192 x 8192");
}

}  // namespace
}  // namespace weft
