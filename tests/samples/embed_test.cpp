// Weft inside a host: what it borrows it leaves alone, and its three ways to run a frame agree.
//
// The host is played by a compute::Device with validation on; Weft works on a second one that borrows everything from it.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/recorder.h"
#include "engine/simulation.h"
#include "tests/support/on_device.h"
#include "tests/support/sheets.h"
#include "tests/support/watched_vulkan.h"

namespace weft {
namespace {

using compute::Device;

constexpr int kFrames = 6;

// Stretch, bending, tethers, an anchor and a ball that move, a floor: every pass and every kind of input.
Scene scene() {
  Scene scene;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 15, 13, Topology::diagonal, true};
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  cloth.anchors[0].keys = {Key{0, {0, 0, 0}, {0, 1, 0}, 0}, Key{1, {0.3f, 0.1f, 0}, {0, 1, 0}, 0}};
  Collider& ball = scene.colliders.emplace_back();
  ball.shape = ColliderShape::sphere;
  ball.centre = {0.1f, -0.1f, -0.4f};
  ball.radius = 0.25;
  ball.keys = {Key{0, {0, 0, 0}, {0, 1, 0}, 0}, Key{1, {0, 0, 1}, {0, 1, 0}, 90}};
  scene.colliders.emplace_back().centre = {0, -0.6f, 0};
  return scene;
}

class Host : public compute::OnDevice {
 protected:
  compute::BorrowedDevice loan() const {
    const Device& d = device();
    return {d.vk().vkGetInstanceProcAddr, d.instance(), d.physical(), d.handle(), d.queue(), d.queue_family()};
  }
  std::unique_ptr<Device> borrow() const {
    auto borrowed = Device::borrow(loan());
    EXPECT_TRUE(borrowed) << borrowed.error();
    return borrowed ? std::move(*borrowed) : nullptr;
  }
  static std::unique_ptr<Simulation> simulate(const Device& device) {
    auto simulation = Simulation::create(device, scene());
    EXPECT_TRUE(simulation) << simulation.error();
    return simulation ? std::move(*simulation) : nullptr;
  }
};

std::vector<Vec3> vertices(const Simulation& simulation) {
  auto read = simulation.read_vertex_positions();
  EXPECT_TRUE(read) << read.error();
  return read ? *read : std::vector<Vec3>();
}

// What `frame` makes of the scene, frame after frame.
template <class Frame>
std::vector<std::vector<Vec3>> film(Simulation& simulation, const Frame& frame) {
  std::vector<std::vector<Vec3>> pictures;
  for (int k = 0; k < kFrames; ++k) {
    frame();
    pictures.push_back(vertices(simulation));
  }
  return pictures;
}

std::vector<std::vector<Vec3>> advanced(Simulation& simulation) {
  return film(simulation, [&] {
    auto done = simulation.advance(kFrame);
    EXPECT_TRUE(done) << done.error();
  });
}

TEST_F(Host, weft_neither_destroys_nor_idles_what_it_borrows) {
  watch.get_instance_proc_addr = device().vk().vkGetInstanceProcAddr;
  watch.get_device_proc_addr = device().vk().vkGetDeviceProcAddr;
  watch.forbidden = 0;
  compute::BorrowedDevice lent = loan();
  lent.get_instance_proc_addr = watched_function;
  {
    auto borrowed = Device::borrow(lent);
    ASSERT_TRUE(borrowed) << borrowed.error();
    auto simulation = simulate(**borrowed);
    ASSERT_TRUE(simulation);
    EXPECT_TRUE(simulation->advance(kFrame));
    EXPECT_TRUE(simulation->submit(kFrame));
    (*borrowed)->wait_idle();
  }
  EXPECT_GT(watch.submits, 0);   // the ear does hear
  EXPECT_EQ(watch.forbidden, 0);
}

// Each feature may be enabled by its own structure or by that of its version.
TEST_F(Host, of_features_that_a_device_was_created_without_no_use_is_made_when_its_host_tells) {
  VkDeviceCreateInfo created{};
  created.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  compute::BorrowedDevice lent = loan();
  lent.created_with = &created;
  const auto features = [&] {
    const auto borrowed = Device::borrow(lent);
    EXPECT_TRUE(borrowed) << borrowed.error();
    return borrowed ? (*borrowed)->features() : compute::Features{};
  };
  EXPECT_FALSE(features().synchronization2 || features().timeline_semaphore || features().dynamic_rendering);
  VkPhysicalDeviceVulkan12Features version{};
  version.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  version.timelineSemaphore = VK_TRUE;
  created.pNext = &version;
  EXPECT_TRUE(features().timeline_semaphore);
  EXPECT_FALSE(features().synchronization2);
  VkPhysicalDeviceSynchronization2Features barriers{};
  barriers.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES;
  barriers.synchronization2 = VK_TRUE;
  version.pNext = &barriers;
  EXPECT_TRUE(features().timeline_semaphore && features().synchronization2);
}

TEST_F(Host, a_command_buffer_that_is_none_is_refused_and_changes_nothing) {
  const auto borrowed = borrow();
  const auto simulation = simulate(*borrowed);
  ASSERT_TRUE(simulation);
  const auto recorded = simulation->record(VK_NULL_HANDLE, kFrame);
  ASSERT_FALSE(recorded);
  EXPECT_EQ(recorded.error(), "record: the command buffer is VK_NULL_HANDLE");
  EXPECT_EQ(simulation->time(), 0);
}

TEST_F(Host, recording_leaves_the_queue_to_the_host) {
  watch.get_instance_proc_addr = device().vk().vkGetInstanceProcAddr;
  watch.get_device_proc_addr = device().vk().vkGetDeviceProcAddr;
  compute::BorrowedDevice lent = loan();
  lent.get_instance_proc_addr = watched_function;
  auto borrowed = Device::borrow(lent);
  ASSERT_TRUE(borrowed) << borrowed.error();
  auto simulation = simulate(**borrowed);
  ASSERT_TRUE(simulation);
  watch.submits = 0;
  auto ran = compute::run_once(device(), "host frame", [&](VkCommandBuffer c) { EXPECT_TRUE(simulation->record(c, kFrame)); });
  EXPECT_TRUE(ran);
  EXPECT_EQ(watch.submits, 0);   // the host's own submit goes past the ear
}

TEST_F(Host, a_device_works_on_when_weft_is_gone) {
  {
    auto borrowed = borrow();
    ASSERT_TRUE(borrowed);
    auto simulation = simulate(*borrowed);
    ASSERT_TRUE(simulation);
    EXPECT_TRUE(simulation->advance(kFrame));
  }
  const compute::BufferRequest request{"host", 64, compute::kStorage};
  auto arena = compute::Arena::create(device(), compute::Memory::device, "host", {&request, 1});
  ASSERT_TRUE(arena) << arena.error();
  const std::vector<std::uint32_t> sent(16, 7);
  std::vector<std::uint32_t> back(16, 0);
  EXPECT_TRUE(compute::upload(device(), (*arena)[0], std::as_bytes(std::span(sent))));
  EXPECT_TRUE(compute::read_back(device(), (*arena)[0], std::as_writable_bytes(std::span(back))));
  EXPECT_EQ(back, sent);
}

TEST_F(Host, weft_destroyed_with_a_frame_under_way_waits_for_it) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto simulation = simulate(*borrowed);
  ASSERT_TRUE(simulation);
  EXPECT_TRUE(simulation->submit(kFrame));
  EXPECT_TRUE(simulation->submit(kFrame));
  simulation.reset();   // validation would hear buffers that are destroyed while in use
}

TEST_F(Host, record_submit_and_advance_end_in_the_same_bits) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto by_advance = simulate(*borrowed), by_submit = simulate(*borrowed), by_record = simulate(*borrowed);
  ASSERT_TRUE(by_advance && by_submit && by_record);
  const auto expected = advanced(*by_advance);
  EXPECT_EQ(film(*by_submit, [&] { EXPECT_TRUE(by_submit->submit(kFrame)); }), expected);
  const auto record = [&] {
    auto ran = compute::run_once(device(), "host frame", [&](VkCommandBuffer c) { EXPECT_TRUE(by_record->record(c, kFrame)); });
    EXPECT_TRUE(ran) << ran.error();
  };
  EXPECT_EQ(film(*by_record, record), expected);
  EXPECT_NE(expected.front(), expected.back());
}

TEST_F(Host, the_three_ways_can_take_turns) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto alone = simulate(*borrowed), mixed = simulate(*borrowed);
  ASSERT_TRUE(alone && mixed);
  const auto expected = advanced(*alone);
  int frame = 0;
  const auto next = [&] {
    switch (frame++ % 3) {
      case 0: EXPECT_TRUE(mixed->submit(kFrame)); break;
      case 1:
        EXPECT_TRUE(compute::run_once(device(), "host frame", [&](VkCommandBuffer c) { EXPECT_TRUE(mixed->record(c, kFrame)); }));
        break;
      default: EXPECT_TRUE(mixed->advance(kFrame));
    }
  };
  EXPECT_EQ(film(*mixed, next), expected);
}

// The host copies every frame's vertices on the GPU, with nothing but semaphores between: a frame that began too early
// would show up in the copy before it.
TEST_F(Host, semaphores_alone_keep_a_frame_and_its_reader_apart) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto alone = simulate(*borrowed), simulation = simulate(*borrowed);
  ASSERT_TRUE(alone && simulation);
  const auto expected = advanced(*alone);

  const FrameView view = simulation->positions();
  const VkDeviceSize bytes = VkDeviceSize{view.stride} * view.count;
  std::vector<compute::BufferRequest> requests;
  for (int k = 0; k < kFrames; ++k) requests.push_back({"picture " + std::to_string(k), bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  auto arena = compute::Arena::create(device(), compute::Memory::readback, "pictures", requests);
  ASSERT_TRUE(arena) << arena.error();
  auto pool = compute::CommandPool::create(device(), "host");
  auto copied = compute::create_timeline(device(), "copied");
  ASSERT_TRUE(pool && copied);
  for (std::uint32_t k = 0; k < kFrames; ++k) {
    const VkSemaphoreSubmitInfo earlier{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, copied->get(), k,
                                        VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    ASSERT_TRUE(simulation->submit(kFrame, {&earlier, 1}));
    auto commands = pool->allocate("host frame");
    ASSERT_TRUE(commands);
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, 0, nullptr};
    device().vk().vkBeginCommandBuffer(*commands, &begin);
    const VkBufferCopy region{view.offset, 0, bytes};
    device().vk().vkCmdCopyBuffer(*commands, view.buffer, (*arena)[k].handle, 1, &region);
    {
      compute::Recorder recorder(device(), *commands);
      recorder.barrier(compute::Use::transfer, compute::Use::host);
      recorder.finish();
    }
    device().vk().vkEndCommandBuffer(*commands);
    const VkSemaphoreSubmitInfo ready{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, simulation->ready_semaphore(),
                                      simulation->ready_value(), VK_PIPELINE_STAGE_2_COPY_BIT, 0};
    const VkSemaphoreSubmitInfo done{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, copied->get(), k + 1,
                                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    const VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, *commands, 0};
    const VkSubmitInfo2 work{VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, 1, &ready, 1, &buffer, 1, &done};
    ASSERT_TRUE(borrowed->submit(work));
  }
  ASSERT_TRUE(compute::wait_for(device(), copied->get(), kFrames));
  // The software driver (Mesa 22.3) signals a semaphore before its queue's thread has done with it: destroyed then, it crashes that thread.
  device().wait_idle();
  for (int k = 0; k < kFrames; ++k) {
    const auto* copy = reinterpret_cast<const Vec4*>((*arena)[static_cast<std::size_t>(k)].mapped);
    std::vector<Vec3> picture;
    for (std::uint32_t i = 0; i < view.count; ++i) picture.push_back({copy[i].x, copy[i].y, copy[i].z});
    EXPECT_EQ(picture, expected[static_cast<std::size_t>(k)]) << "frame " << k;
  }
}

TEST_F(Host, a_submitted_frame_waits_for_what_the_host_names) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto simulation = simulate(*borrowed);
  auto drawn = compute::create_timeline(device(), "drawn");
  ASSERT_TRUE(simulation && drawn);
  const VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, drawn->get(), 1,
                                   VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
  ASSERT_TRUE(simulation->submit(kFrame, {&wait, 1}));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));   // far longer than the frame would take
  std::uint64_t reached = 0;
  device().vk().vkGetSemaphoreCounterValue(device().handle(), simulation->ready_semaphore(), &reached);
  EXPECT_LT(reached, simulation->ready_value());
  const VkSemaphoreSignalInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, nullptr, drawn->get(), 1};
  device().vk().vkSignalSemaphore(device().handle(), &signal);
  EXPECT_TRUE(compute::wait_for(device(), simulation->ready_semaphore(), simulation->ready_value()));
  device().wait_idle();   // as above
}

TEST_F(Host, anchors_and_colliders_go_where_the_host_says) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto simulation = simulate(*borrowed);
  ASSERT_TRUE(simulation);
  const auto& anchors = simulation->fabric().anchors;
  ASSERT_EQ(anchors.size(), 2u);
  const Vec3 target = anchors[1].rest + Vec3{0, 0.02f, 0.03f};
  EXPECT_TRUE(simulation->move_anchors(1, {&target, 1}));
  EXPECT_TRUE(simulation->move_collider(0, {.centre = {5, 6, 7}}));
  ASSERT_TRUE(simulation->advance(kFrame));
  EXPECT_EQ(vertices(*simulation)[anchors[1].vertex], target);
  EXPECT_EQ(simulation->colliders()[0].centre, (Vec3{5, 6, 7}));
  const ColliderPose both[] = {{.centre = {5, 5, 5}}, {.centre = {0, -2, 0}}};
  EXPECT_TRUE(simulation->move_colliders(0, both));
  ASSERT_TRUE(simulation->advance(kFrame));
  EXPECT_EQ(simulation->colliders()[0].centre, (Vec3{5, 5, 5}));
  EXPECT_EQ(simulation->colliders()[1].centre, (Vec3{0, -2, 0}));
}

TEST_F(Host, views_say_what_their_buffers_were_created_for) {
  const auto borrowed = borrow();
  const auto simulation = simulate(*borrowed);
  ASSERT_TRUE(simulation);
  constexpr VkBufferUsageFlags kPromised = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                           VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  for (const FrameView& view : {simulation->positions(), simulation->normals()}) EXPECT_EQ(view.usage & kPromised, kPromised);
}

TEST_F(Host, a_sphere_may_be_moved_without_a_normal_and_a_plane_may_not) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto simulation = simulate(*borrowed);
  ASSERT_TRUE(simulation);
  EXPECT_TRUE(simulation->move_collider(0, {{1, 2, 3}, {0, 0, 0}}));
  auto refused = simulation->move_collider(1, {{0, 0, 0}, {0, 0, 0}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "the normal of collider 1 has a length of 0, not above 1e-6");
}

TEST_F(Host, two_simulations_on_one_device_run_in_two_threads) {
  auto borrowed = borrow();
  ASSERT_TRUE(borrowed);
  auto alone = simulate(*borrowed);
  ASSERT_TRUE(alone);
  const auto expected = advanced(*alone);
  std::vector<std::vector<Vec3>> films[2];
  const auto play = [&](int k) {
    auto simulation = simulate(*borrowed);
    if (simulation) films[k] = advanced(*simulation);
  };
  std::thread first(play, 0), second(play, 1);
  first.join();
  second.join();
  EXPECT_EQ(films[0], expected);
  EXPECT_EQ(films[1], expected);
}

// What is left over, the object tracker names when the fixture destroys the host's device.
TEST_F(Host, twenty_simulations_come_and_go_and_leave_nothing) {
  for (int k = 0; k < 20; ++k) {
    auto borrowed = borrow();
    ASSERT_TRUE(borrowed);
    auto simulation = simulate(*borrowed);
    ASSERT_TRUE(simulation);
    ASSERT_TRUE(simulation->submit(kFrame));
  }
}

}  // namespace
}  // namespace weft
