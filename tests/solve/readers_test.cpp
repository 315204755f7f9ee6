// A host whose compute shader and whose copy read every frame's vertices right behind `record`, by a binding and by an address, with no
// barrier of its own before or between, and all frames under way at once.
#include <gtest/gtest.h>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/descriptors.h"
#include "compute/pipeline.h"
#include "compute/recorder.h"
#include "engine/simulation.h"
#include "read_vertices.h"
#include "tests/support/lent_device.h"
#include "tests/support/sheets.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using compute::Device;

constexpr std::uint32_t kReaderFrames = 4;

Scene scene() {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 15, 13, Topology::diagonal, true};
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  return scene;
}

class FrameReaders : public compute::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    VkPhysicalDeviceVulkan12Features wanted{};
    wanted.bufferDeviceAddress = device().description().features.buffer_device_address;
    if (!wanted.bufferDeviceAddress) GTEST_SKIP() << "no buffer device addresses here";
    host_ = std::make_unique<LentDevice>(device(), wanted);
    options_.readers = {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
                        VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT};
    options_.vertex_usage = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  }
  void TearDown() override {
    host_.reset();
    OnDevice::TearDown();
  }
  VkDeviceAddress address_of(VkBuffer buffer) const {
    const Device& lent = **host_;
    const auto address = reinterpret_cast<PFN_vkGetBufferDeviceAddress>(
        lent.vk().vkGetDeviceProcAddr(lent.handle(), "vkGetBufferDeviceAddress"));
    auto info = compute::typed<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
    info.buffer = buffer;
    return address(lent.handle(), &info);
  }

  std::unique_ptr<LentDevice> host_;
  SimulationOptions options_;
};

std::vector<Vec3> picture(const compute::Buffer& mapped, std::uint32_t count, std::uint32_t first, std::uint32_t step) {
  const auto* values = reinterpret_cast<const Vec4*>(mapped.mapped);
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec4& v = values[first + step * i];
    points.push_back({v.x, v.y, v.z});
  }
  return points;
}

TEST_F(FrameReaders, a_dispatch_and_a_copy_right_behind_a_recorded_frame_read_that_frame) {
  const Device& lent = **host_;
  std::vector<std::vector<Vec3>> expected;
  {
    const auto alone = must(Simulation::create(lent, scene()));
    for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
      must(alone->advance(kFrame));
      expected.push_back(must(alone->read_vertex_positions()));
    }
  }
  ASSERT_NE(expected.front(), expected.back());

  const auto simulation = must(Simulation::create(lent, scene(), options_));
  const FrameView view = simulation->positions();
  EXPECT_TRUE(view.usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT);
  const VkDeviceSize bytes = VkDeviceSize{view.stride} * view.count;
  std::vector<compute::BufferRequest> requests;
  for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
    requests.push_back({"copied", bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT});
    requests.push_back({"computed", 2 * bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  }
  const auto pictures = must(compute::Arena::create(lent, compute::Memory::readback, "pictures", requests));
  const compute::DescriptorBinding bindings[] = {{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}};
  const auto layout = must(compute::DescriptorLayout::create(lent, "reader", bindings));
  const VkDescriptorSetLayout handle = layout.handle();
  struct Push {
    VkDeviceAddress vertices;
    std::uint32_t count, unused;
  };
  const Push push{address_of(view.buffer) + view.offset, view.count, 0};
  const auto pipeline_layout = must(compute::create_pipeline_layout(lent, "reader", {&handle, 1}, sizeof push));
  const auto pipeline = must(compute::ComputePipeline::create(lent, nullptr, "reader", read_vertices, {}, pipeline_layout.get()));
  compute::Buffer vertices;   // the simulation's, as the host knows it
  vertices.handle = view.buffer;
  std::vector<compute::DescriptorSet> sets;
  for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
    const compute::BoundBuffer bound[] = {{0, &vertices, view.offset, bytes}, {1, &pictures[2 * k + 1]}};
    sets.push_back(must(compute::DescriptorSet::create(lent, "reader", layout, bound)));
  }

  const auto pool = must(compute::CommandPool::create(lent, "host"));
  const auto done = must(compute::create_timeline(lent, "host done"));
  for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
    const VkCommandBuffer commands = must(pool.allocate("host frame"));
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, 0, nullptr};
    ASSERT_EQ(lent.vk().vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    must(simulation->record(commands, kFrame));
    const VkBufferCopy region{view.offset, 0, bytes};
    lent.vk().vkCmdCopyBuffer(commands, view.buffer, pictures[2 * k].handle, 1, &region);
    const VkDescriptorSet set = sets[k].handle();
    lent.vk().vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
    lent.vk().vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_layout.get(), 0, 1, &set, 0, nullptr);
    lent.vk().vkCmdPushConstants(commands, pipeline_layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    lent.vk().vkCmdDispatch(commands, (view.count + 63) / 64, 1, 1);
    compute::Recorder(lent, commands).barrier(compute::Use::transfer | compute::Use::compute, compute::Use::host);
    ASSERT_EQ(lent.vk().vkEndCommandBuffer(commands), VK_SUCCESS);
    const VkCommandBufferSubmitInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands, 0};
    const VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, done.get(), k + 1,
                                       VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    must(lent.submit({VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, 0, nullptr, 1, &info, 1, &signal}));
  }
  must(compute::wait_for(lent, done.get(), kReaderFrames));
  // The software driver (Mesa 22.3) signals a semaphore before its queue's thread has done with it: destroyed then, it crashes that thread.
  lent.vk().vkQueueWaitIdle(lent.queue());
  for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
    EXPECT_EQ(picture(pictures[2 * k], view.count, 0, 1), expected[k]) << "copied, frame " << k;
    EXPECT_EQ(picture(pictures[2 * k + 1], view.count, 0, 2), expected[k]) << "bound, frame " << k;
    EXPECT_EQ(picture(pictures[2 * k + 1], view.count, 1, 2), expected[k]) << "by address, frame " << k;
  }
}

// Without the memory's flag validation would complain of the address; without the usage, of asking for it.
TEST_F(FrameReaders, both_buffers_have_the_usage_and_an_address) {
  const auto simulation = must(Simulation::create(**host_, scene(), options_));
  for (const FrameView& view : {simulation->positions(), simulation->normals()}) {
    EXPECT_TRUE(view.usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT);
    EXPECT_NE(address_of(view.buffer), 0u);
  }
  EXPECT_NE(address_of(simulation->positions().buffer), address_of(simulation->normals().buffer));
}

TEST_F(FrameReaders, the_readers_change_no_bit_of_the_cloth) {
  const auto plain = must(Simulation::create(**host_, scene())), read = must(Simulation::create(**host_, scene(), options_));
  for (std::uint32_t k = 0; k < kReaderFrames; ++k) {
    must(plain->submit(kFrame));
    must(read->submit(kFrame));
  }
  EXPECT_EQ(must(plain->read_vertex_positions()), must(read->read_vertex_positions()));
  EXPECT_EQ(must(plain->read_vertex_normals()), must(read->read_vertex_normals()));
}

TEST_F(FrameReaders, a_simulation_is_not_created_for_what_the_device_cannot_have) {
  SimulationOptions options;
  options.vertex_usage = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  const auto addressed = Simulation::create(device(), scene(), options);
  ASSERT_FALSE(addressed);
  EXPECT_NE(addressed.error().find("bufferDeviceAddress, which is not enabled on"), std::string::npos) << addressed.error();
  options = {};
  options.readers.emplace();
  const auto nobody = Simulation::create(device(), scene(), options);
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error(), "readers: no stage is named");
}

}  // namespace
}  // namespace weft
