// The host's memory that runs out at every allocation in turn, in all that needs a device. Each is a sentence, no Vulkan object stays, and
// a simulation goes on as if the call had not been, or had been whole.
#include <gtest/gtest.h>

#include <cmath>

#include "compute/commands.h"
#include "engine/shading/shading.h"
#include "engine/simulation.h"
#include "tests/faulty/vulkan.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scarce_memory.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using compute::Device;
using test::at_every_allocation;

template <class T>
Result<void> done_or_why(Result<T> result) {
  return result ? Result<void>() : Result<void>(result.take_error());
}

class ScarceMemoryOnDevice : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    faulty::faults.get_instance_proc_addr = GpuTest::device().vk().vkGetInstanceProcAddr;
    faulty::faults.alive.clear();
    faulty::faults.plan(-1, VK_ERROR_OUT_OF_HOST_MEMORY);
    lent_ = must(Device::borrow(lending()));
  }
  void TearDown() override {
    lent_.reset();
    EXPECT_EQ(faulty::faults.left(), "");
    GpuTest::TearDown();
  }
  compute::BorrowedDevice lending() const {
    const Device& d = GpuTest::device();
    return {faulty::instance_function, d.instance(), d.physical(), d.handle(), d.queue(), d.queue_family()};
  }
  Device& device() { return *lent_; }

  // A scene with all that a frame may do on the host: keys, colliders of every kind, contacts that outgrow their capacity.
  Scene busy_scene() {
    folder_.write("floor.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n");
    Scene scene = sheet(4);
    scene.folder = folder_ / "";
    scene.cloths[0].anchors.push_back(held_at({Corner::low_high}));
    scene.cloths[0].anchors[0].keys = {{0, {}}, {1, {0, 1, 0}}};
    scene.cloths.push_back(scene.cloths[0]);
    scene.cloths[1].transform.translate = {0, 0.004f, 0};
    scene.contacts.enabled = true;
    scene.contacts.capacity = 16;
    scene.solver.substeps = 2;
    Collider& floor = scene.colliders.emplace_back();
    floor.shape = ColliderShape::mesh;
    floor.mesh = "floor.obj";
    floor.centre = {0, -0.5f, 0};
    floor.keys = {{0, {}}, {1, {0, 1, 0}}};
    scene.colliders.push_back(sphere({0, -0.5f, 0}, 0.4));
    return scene;
  }
  // One whose pins and colliders stand still.
  Scene still_scene() {
    Scene scene = busy_scene();
    scene.contacts.capacity = 4096;
    for (Cloth& cloth : scene.cloths) cloth.anchors[0].keys.clear();
    for (Collider& collider : scene.colliders) collider.keys.clear();
    return scene;
  }
  std::unique_ptr<Simulation> busy() { return must(Simulation::create(device(), busy_scene())); }

  // Calls `work` on `simulation`, which is put back before each; then two frames must give what they give with the call or without.
  template <class Work>
  void expect_whole_or_not_at_all(long most, Simulation& simulation, Work&& work) {
    const Snapshot snapshot = must(simulation.save());
    const auto two_frames = [&] {
      for (int frame = 0; frame < 2; ++frame) must(simulation.advance(kFrame));
      return hash_of(simulation);
    };
    const auto start = [&] {
      must(simulation.restore(snapshot));
      return nullptr;
    };
    start();
    const std::uint64_t without = two_frames();
    start();
    must(work(simulation));
    const std::uint64_t with = two_frames();
    at_every_allocation(
        most, start, [&](std::nullptr_t) { return work(simulation); },
        [&](std::nullptr_t, bool done) {
          const std::uint64_t after = two_frames();
          EXPECT_TRUE(after == with || (!done && after == without)) << "a part of it happened";
        });
  }

  test::Folder folder_;

 private:
  std::unique_ptr<Device> lent_;
};

TEST_F(ScarceMemoryOnDevice, is_a_sentence_where_a_device_is_lent) {
  at_every_allocation(
      100, [] { return std::unique_ptr<Device>(); }, [&](auto&) { return done_or_why(Device::borrow(lending())); }, [](auto&, bool) {});
}

TEST_F(ScarceMemoryOnDevice, is_a_sentence_where_a_simulation_is_made) {
  const Scene scene = busy_scene();
  must(Simulation::create(device(), scene));   // passes are specialised once a device
  const std::string before = faulty::faults.left();
  at_every_allocation(
      60, [] { return nullptr; }, [&](std::nullptr_t) { return done_or_why(Simulation::create(device(), scene)); },
      [&](std::nullptr_t, bool) { EXPECT_EQ(faulty::faults.left(), before); });
}

TEST_F(ScarceMemoryOnDevice, is_a_sentence_where_a_device_is_made) {
  at_every_allocation(40, [] { return nullptr; }, [](std::nullptr_t) { return done_or_why(Device::create()); }, [](auto, bool) {});
  at_every_allocation(40, [] { return nullptr; }, [](std::nullptr_t) { return done_or_why(compute::list_devices()); }, [](auto, bool) {});
}

// After an error the clock has moved and the cloth may not have: another frame takes pins and colliders to where they are by then.
TEST_F(ScarceMemoryOnDevice, leaves_a_simulation_that_goes_on_where_a_frame_fails) {
  const auto simulation = busy();
  must(simulation->advance(kFrame));
  const Snapshot snapshot = must(simulation->save());
  const auto start = [&] {
    must(simulation->restore(snapshot));
    return nullptr;
  };
  const auto goes_on = [&](std::nullptr_t, bool) {
    must(simulation->advance(kFrame));
    const auto positions = must(simulation->read_positions());
    const Vec3 target = anchor_targets(simulation->scene(), simulation->fabric(), simulation->time())[0];
    const gpu::vec4& pin = positions[simulation->fabric().anchors[0].particle];
    EXPECT_NEAR(pin.y, target.y - simulation->origin().y, 0.02) << "cloth may hold it back";
    EXPECT_EQ(positions.back().y, simulation->colliders()[0].centre.y - simulation->origin().y);
    EXPECT_LT(top_speed(*simulation), 5) << "something was torn";
    EXPECT_EQ(simulation->counts().non_finite, 0u);
  };
  at_every_allocation(40, start, [&](std::nullptr_t) { return done_or_why(simulation->advance(kFrame)); }, goes_on);
  at_every_allocation(40, start, [&](std::nullptr_t) { return done_or_why(simulation->submit(kFrame)); }, goes_on);
}

TEST_F(ScarceMemoryOnDevice, leaves_a_simulation_whole_where_a_frame_fails) {
  const auto simulation = must(Simulation::create(device(), still_scene()));
  expect_whole_or_not_at_all(40, *simulation, [](Simulation& s) { return done_or_why(s.advance(kFrame)); });
  expect_whole_or_not_at_all(40, *simulation, [](Simulation& s) { return done_or_why(s.submit(kFrame)); });
}

TEST_F(ScarceMemoryOnDevice, leaves_a_simulation_whole_where_passes_are_timed_one_by_one) {
  SimulationOptions one_by_one;
  one_by_one.timings = one_by_one.timings_on_cpu = true;
  const auto simulation = must(Simulation::create(device(), still_scene(), one_by_one));
  expect_whole_or_not_at_all(40, *simulation, [](Simulation& s) { return done_or_why(s.advance(kFrame)); });
  SimulationOptions timed;
  timed.timings = true;
  const auto other = must(Simulation::create(device(), still_scene(), timed));
  expect_whole_or_not_at_all(40, *other, [](Simulation& s) { return done_or_why(s.advance(kFrame)); });
}

// A host cannot take back what is in its command buffer.
TEST_F(ScarceMemoryOnDevice, puts_a_whole_frame_or_nothing_into_a_host_s_command_buffer) {
  const auto simulation = must(Simulation::create(device(), still_scene()));
  const auto host = must(compute::CommandPool::create(device(), "host"));
  expect_whole_or_not_at_all(40, *simulation, [&](Simulation& s) -> Result<void> {
    Result<void> recorded;
    const test::Elsewhere in_the_host;
    must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) {
      const test::Weft weft;
      recorded = done_or_why(s.record(commands, kFrame));
    }));
    return recorded;
  });
}

TEST_F(ScarceMemoryOnDevice, leaves_a_simulation_whole_where_it_is_written_moved_saved_or_restored) {
  const auto simulation = must(Simulation::create(device(), still_scene()));
  must(simulation->advance(kFrame));
  const Snapshot before = must(simulation->save());
  must(simulation->advance(kFrame));
  auto positions = must(simulation->read_positions());
  for (gpu::vec4& p : positions) p.y += 1;
  positions[3].x = NAN;
  ColliderPose pose;
  pose.centre = {0, -2, 0};
  const Vec3 target{0, 3, 0};
  int call = 0;
  const auto whole = [&](auto work) {
    SCOPED_TRACE("call " + std::to_string(call++));
    expect_whole_or_not_at_all(40, *simulation, work);
  };
  whole([&](Simulation& s) { return s.write_positions(positions); });
  whole([&](Simulation& s) { return s.write_velocities(positions); });
  whole([&](Simulation& s) { return s.place_collider(0, pose); });
  whole([&](Simulation& s) { return s.move_collider(0, pose); });
  whole([&](Simulation& s) { return s.move_anchors(0, {&target, 1}); });
  whole([&](Simulation& s) { return s.set_gravity({0, -1, 0}); });
  whole([&](Simulation& s) { return s.set_gravity({NAN, -1, 0}) ? Result<void>() : Result<void>(); });
  whole([&](Simulation& s) { return s.restore(before); });
  whole([&](Simulation& s) { return s.fits(before); });
  whole([&](Simulation& s) { return done_or_why(s.save()); });
  whole([&](Simulation& s) { return done_or_why(s.read_velocities()); });
  whole([&](Simulation& s) { return done_or_why(s.read_vertex_normals()); });
}

TEST_F(ScarceMemoryOnDevice, is_no_exception_where_a_simulation_tells_of_itself) {
  SimulationOptions timed;
  timed.timings = true;
  const auto simulation = must(Simulation::create(device(), still_scene(), timed));
  must(simulation->submit(kFrame));
  const auto tell = [&](std::nullptr_t) -> Result<void> {
    (void)simulation->counts();
    (void)simulation->passes();
    (void)simulation->buffers();
    (void)simulation->timings();
    (void)simulation->dispatch_times();
    (void)simulation->gpu_milliseconds();
    (void)simulation->colliders();
    return {};
  };
  at_every_allocation(100, [] { return nullptr; }, tell, [](auto, bool) {});
}

TEST_F(ScarceMemoryOnDevice, is_a_sentence_where_a_picture_is_drawn) {
  const auto simulation = must(Simulation::create(device(), still_scene()));
  const ShadedCloth cloth{&simulation->meshes()[0].render, &simulation->scene().cloths[0].appearance};
  const auto create = [&] { return Shading::create(device(), simulation->scene(), {&cloth, 1}, {32, 32}); };
  const std::string before = faulty::faults.left();
  at_every_allocation(
      100, [] { return nullptr; }, [&](std::nullptr_t) { return done_or_why(create()); },
      [&](std::nullptr_t, bool) { EXPECT_EQ(faulty::faults.left(), before); });
  const auto shading = must(create());
  const auto draw = [&] { return shading->draw({simulation->positions(), simulation->normals(), simulation->colliders()}); };
  const Image expected = must(draw());
  const auto file = folder_ / "picture.png";
  at_every_allocation(100, [] { return nullptr; }, [&](std::nullptr_t) { return write_png(file, expected); }, [](auto, bool) {});
  must(write_png(file, expected));
  at_every_allocation(100, [] { return nullptr; }, [&](std::nullptr_t) { return done_or_why(read_image(file)); }, [](auto, bool) {});
  at_every_allocation(
      100, [] { return nullptr; }, [&](std::nullptr_t) { return done_or_why(draw()); },
      [&](std::nullptr_t, bool) { EXPECT_EQ(must(draw()).rgba, expected.rgba); });
  // Another size has few allocations of ours, and a picture after each takes long: some of them.
  int refused = 0;
  for (const long at : {1L, 2L, 4L, 8L}) {
    Result<void> done;
    {
      const test::ScarceMemory scarce(at, test::ScarceMemory::Lasts::once);
      done = shading->resize({48, 20});
    }
    if (!done) {
      ++refused;
      EXPECT_EQ(done.kind(), ErrorKind::memory) << done.error();
      EXPECT_EQ(must(draw()).rgba, expected.rgba);
    }
    must(shading->resize({32, 32}));
  }
  EXPECT_GT(refused, 1);
  EXPECT_EQ(must(draw()).rgba, expected.rgba);
}

}  // namespace
}  // namespace weft
