// proximity.glsl against its twin, by itself: on quads of all sizes, far from the origin and degenerate in every way.
#include <gtest/gtest.h>

#include <cmath>

#include "compute/buffer.h"
#include "compute/descriptors.h"
#include "compute/pipeline.h"
#include "proximity.h"
#include "shaders/contact/proximity.ref.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using Kernel = GpuTest;
using reference::Quad;
using reference::Vector;

gpu::vec4 single(const Vector& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0}; }

Vector in_box(Random& random, double size) {
  return {between(random, -size, size), between(random, -size, size), between(random, -size, size)};
}

// Four points: in general, in a plane, on a line, two or three at one place, slivers, nearly parallel edges and crossing ones.
std::vector<gpu::vec4> random_quads(Random& random, std::uint32_t count, double far) {
  std::vector<gpu::vec4> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double size = std::pow(10, between(random, -3, 0)), small = std::pow(10, between(random, -8, -1));
    const Vector middle = in_box(random, far);
    Quad x;
    for (Vector& v : x) v = in_box(random, 1);
    switch (i % 8) {
      case 1: for (Vector& v : x) v.z() = 0; break;
      case 2: for (Vector& v : x) v = v.x() * Vector(1, 0.5, -0.25); break;
      case 3: x[3] = x[2]; break;
      case 4: x[1] = x[2] = x[3]; break;
      case 5: x[3] = x[1] + 0.7 * (x[2] - x[1]) + small * x[3]; break;
      case 6: x[3] = x[2] + between(random, -2, 2) * (x[1] - x[0]) + small * x[3]; break;
      case 7: x[3] = x[2] + 2 * (0.4 * x[0] + 0.6 * x[1] - x[2]) + small * x[3]; break;
      default: break;
    }
    for (const Vector& v : x) points.push_back(single(middle + size * v));
  }
  return points;
}

std::vector<gpu::vec4> weights_of(const compute::Device& device, const std::vector<gpu::vec4>& points) {
  const auto count = static_cast<std::uint32_t>(points.size() / 4);
  constexpr VkBufferUsageFlags kUsage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const compute::BufferRequest requests[] = {{"points", points.size() * sizeof(gpu::vec4), kUsage},
                                             {"weights", 4 * count * sizeof(gpu::vec4), kUsage}};
  const auto arena = must(compute::Arena::create(device, compute::Memory::device, "proximity", requests));
  const compute::DescriptorBinding bindings[] = {{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}};
  const auto layout = must(compute::DescriptorLayout::create(device, "proximity", bindings));
  const VkDescriptorSetLayout layouts[] = {layout.handle()};
  const auto pipeline_layout = must(compute::create_pipeline_layout(device, "proximity", layouts, sizeof(count)));
  const compute::BoundBuffer bound[] = {{0, &arena[0]}, {1, &arena[1]}};
  const auto set = must(compute::DescriptorSet::create(device, "proximity", layout, bound));
  const compute::SpecializationConstant constants[] = {{0, 64}};
  const auto pipeline = must(compute::ComputePipeline::create(device, nullptr, "proximity", ::proximity, constants, pipeline_layout.get()));
  must(compute::upload(device, arena[0], std::as_bytes(std::span(points))));
  must(compute::run_once(device, "proximity", [&](VkCommandBuffer commands) {
    compute::Recorder recorder(device, commands);
    recorder.begin_pass("proximity", {{0}, {1}, {}});
    const VkDescriptorSet sets[] = {set.handle()};
    recorder.bind(pipeline.handle(), pipeline_layout.get(), sets);
    recorder.push(pipeline_layout.get(), std::as_bytes(std::span(&count, 1)));
    recorder.dispatch((count + 63) / 64);
    recorder.finish();
  }));
  std::vector<gpu::vec4> weights(4 * count);
  must(compute::read_back(device, arena[1], std::as_writable_bytes(std::span(weights))));
  return weights;
}

TEST_F(Kernel, proximity_finds_points_as_close_as_its_twin_does) {
  for (const double far : {0.0, 10.0, 1000.0}) {
    Random random(21);
    const auto points = random_quads(random, 4000, far);
    const auto found = weights_of(device(), points);
    double worst = 0;
    for (std::size_t k = 0; k < found.size() / 2; ++k) {
      const std::size_t place = 4 * (k / 2) + k % 2;
      const gpu::vec4 &w = found[place], &of_pair = found[place + 2];
      ASSERT_TRUE(w.x == of_pair.x && w.y == of_pair.y && w.z == of_pair.z && w.w == of_pair.w) << k;
      const int a = k % 2 == 0 ? 1 : 2;
      Quad x;
      double size = 0;
      for (std::size_t j = 0; j < 4; ++j) x[j] = vector(points[4 * (k / 2) + j]);
      for (const Vector& v : x) size = std::max(size, (v - x[0]).norm());
      ASSERT_TRUE(a == 1 ? w.x == 1 && w.y <= 0 : w.x >= 0 && w.y >= 0) << k;
      ASSERT_TRUE(w.z <= 0 && w.w <= 0) << k;
      EXPECT_NEAR(double(w.x) + w.y + w.z + w.w, 0, 4 * kRounding);
      const double distance = reference::offset({w.x, w.y, w.z, w.w}, x).norm(), least = reference::closest(x, a).distance;
      // Differences of the points are exact or nearly so: coordinates themselves are not rounded again.
      worst = std::max(worst, (distance - least) / std::max(size, 1e-30));
    }
    EXPECT_LT(worst, 40 * kRounding) << "relative to the quad's size, " << far << " m from the origin";
  }
}

}  // namespace
}  // namespace weft
