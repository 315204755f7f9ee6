// What a host sees when Vulkan fails under it: memory that runs out, and a device that is lost, at every call in turn. Each is a
// sentence that names the error; nothing that was made stays; and what comes after works as if nothing had happened.
#include <gtest/gtest.h>

#include <algorithm>

#include "compute/functions.h"
#include "compute/shared_passes.h"
#include "engine/reference/intersections.h"
#include "engine/shading/shading.h"
#include "engine/simulation.h"
#include "engine/snapshot.h"
#include "tests/faulty/vulkan.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/mesh_files.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using compute::Device;
using faulty::faults;

struct Nothing {};

class Faults : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    const Device& own = GpuTest::device();
    faults.get_instance_proc_addr = own.vk().vkGetInstanceProcAddr;
    faults.alive.clear();
    faults.plan(-1, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    lend();
  }
  void TearDown() override {
    faults.most_storage = 0;
    lent_.reset();
    EXPECT_EQ(faults.left(), "");
    GpuTest::TearDown();
  }
  // `made_with`: what the host says it has enabled; null: all that there is.
  void lend(const VkDeviceCreateInfo* made_with = nullptr) {
    const Device& d = GpuTest::device();
    lent_ = must(Device::borrow({faulty::instance_function, d.instance(), d.physical(), d.handle(), d.queue(), d.queue_family(), made_with}));
  }
  // As one of a host that has enabled nothing: barriers and submits of Vulkan 1.0, and fences.
  void lend_without_features() {
    const VkDeviceCreateInfo nothing{};
    lend(&nothing);
  }
  Device& device() { return *lent_; }

  // Works once without a fault, to learn the calls that could fail; then once for each of them, with the fault there, which `work` must
  // report. Of the calls of one function only the first and the last `most` are tried: they are alike, and time is short. Before each,
  // `prepare` makes what `work` gets; `after`, without a fault again, has it last.
  template <class Prepare, class Work, class After>
  void at_every_call(VkResult fault, long most, Prepare&& prepare, Work&& work, After&& after) {
    const std::string before = faults.left();
    // Where the work is to make things, each attempt makes all of them; others share what was compiled.
    const auto left = [&] {
      if (std::is_same_v<decltype(prepare()), Nothing>) device().passes().clear();
      return faults.left();
    };
    const auto attempt = [&](long at) {
      faults.plan(-1, fault);
      auto prepared = prepare();
      faults.plan(at, fault);
      const Result<void> done = work(prepared);
      const std::string failed = faults.failed, where = "call " + std::to_string(at) + ", " + failed + ": ";
      const std::vector<faulty::Call> calls = faults.counted;
      if (at < 0) {
        EXPECT_TRUE(done) << done.error();
      } else {
        EXPECT_NE(failed, "") << where << "was never made";
        // What could not be waited for at first, and then could, has happened.
        const bool happened = fault != VK_ERROR_DEVICE_LOST && failed.starts_with("vkWait");
        EXPECT_EQ(bool(done), happened) << where << (happened ? "was not waited for again" : "failed without a word");
        if (!done) {
          EXPECT_NE(done.error().find(compute::result_name(fault)), std::string::npos) << where << done.error();
          EXPECT_EQ(done.kind(), fault == VK_ERROR_DEVICE_LOST ? ErrorKind::device_lost : ErrorKind::memory) << where << done.error();
        }
      }
      if (fault != VK_ERROR_DEVICE_LOST) faults.plan(-1, fault);
      after(prepared);
      return calls;
    };
    const std::vector<faulty::Call> calls = attempt(-1);
    const std::string shared = left();
    long tried = 0;
    for (std::size_t k = 0; k < calls.size() && !HasFailure(); ++k) {
      const auto same_before = std::count(calls.begin(), calls.begin() + static_cast<std::ptrdiff_t>(k), calls[k]);
      const auto same_after = std::count(calls.begin() + static_cast<std::ptrdiff_t>(k) + 1, calls.end(), calls[k]);
      if (std::min(same_before, same_after) >= most) continue;
      attempt(static_cast<long>(k));
      EXPECT_EQ(left(), shared) << "call " << k << ", " << faulty::name_of(calls[k]);
      ++tried;
    }
    device().passes().clear();
    EXPECT_EQ(faults.left(), before);
    EXPECT_GT(tried, 0);
  }

 private:
  std::unique_ptr<Device> lent_;
};

constexpr VkResult kNoMemory = VK_ERROR_OUT_OF_DEVICE_MEMORY, kNoHostMemory = VK_ERROR_OUT_OF_HOST_MEMORY;
using Made = std::unique_ptr<Simulation>;
constexpr auto nothing = [] { return Nothing(); };
constexpr auto no_more = [](auto&) {};
constexpr long kAll = 1'000'000;

template <class T>
Result<void> plain(Result<T> result) {
  return result ? Result<void>() : Result<void>(result.take_error());
}

Scene hung_sheet() {
  Scene scene = sheet(4);
  scene.cloths[0].anchors.push_back(held_at({Corner::low_high}));
  return scene;
}

// With colliders and contacts: more buffers, three times the passes, and a capacity that grows.
Scene folding_sheet() {
  Scene scene = hung_sheet();
  scene.colliders.push_back(sphere({0, -0.5f, 0}, 0.4));
  scene.contacts.enabled = true;
  return scene;
}

// So close that the first search finds more pairs than the capacity.
Scene close_sheets() {
  Scene scene = sheet(4);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0, 0.0025f, 0};   // half a millimetre more than they keep
  scene.contacts.enabled = true;
  scene.contacts.capacity = 16;
  return scene;
}

Result<void> draw(Device& device, const Simulation& simulation, std::unique_ptr<Shading>& shading) {
  const ShadedCloth cloth{&simulation.meshes()[0].render, &simulation.scene().cloths[0].appearance};
  auto made = Shading::create(device, simulation.scene(), {&cloth, 1}, {32, 32});
  if (!made) return made.take_error();
  shading = std::move(*made);
  return plain(shading->draw({simulation.positions(), simulation.normals(), simulation.colliders()}));
}

TEST_F(Faults, memory_that_runs_out_while_a_simulation_is_made_is_a_sentence_and_leaves_nothing) {
  at_every_call(kNoMemory, kAll, nothing, [&](Nothing) { return plain(Simulation::create(device(), hung_sheet())); }, no_more);
}

TEST_F(Faults, memory_that_runs_out_while_contacts_are_made_is_a_sentence_and_leaves_nothing) {
  at_every_call(kNoMemory, 1, nothing, [&](Nothing) { return plain(Simulation::create(device(), folding_sheet())); }, no_more);
}

TEST_F(Faults, memory_that_runs_out_while_a_picture_is_drawn_is_a_sentence_and_leaves_nothing) {
  const auto simulation = must(Simulation::create(device(), hung_sheet()));
  const auto work = [&](std::unique_ptr<Shading>& shading) { return draw(device(), *simulation, shading); };
  at_every_call(kNoMemory, 2, [] { return std::unique_ptr<Shading>(); }, work, no_more);
}

// Frames of every kind: the third of those that are submitted waits for the first.
Result<void> frames(Simulation& simulation) {
  for (int frame = 0; frame < 2; ++frame)
    if (auto done = plain(simulation.advance(1.0 / 60)); !done) return done;
  for (int frame = 0; frame < 3; ++frame)
    if (auto done = plain(simulation.submit(1.0 / 60)); !done) return done;
  auto positions = simulation.read_positions();
  return positions ? simulation.write_positions(*positions) : positions.take_error();
}

TEST_F(Faults, memory_that_runs_out_in_a_frame_is_a_sentence_and_the_next_frame_works) {
  for (const bool features : {true, false}) {
    if (!features) lend_without_features();
    at_every_call(
        kNoHostMemory, 2, [&] { return must(Simulation::create(device(), hung_sheet())); },
        [](const Made& simulation) { return frames(*simulation); },
        [](const Made& simulation) {
          must(simulation->advance(1.0 / 60));
          EXPECT_EQ(simulation->counts().non_finite, 0u);
        });
  }
}

TEST_F(Faults, a_frame_whose_passes_are_timed_one_by_one_happens_whole_or_not_at_all) {
  SimulationOptions one_by_one;
  one_by_one.timings = one_by_one.timings_on_cpu = true;
  const auto create = [&] { return must(Simulation::create(device(), hung_sheet(), one_by_one)); };
  const auto unharmed = create();
  const std::uint64_t before = hash_of(*unharmed);
  must(unharmed->advance(1.0 / 60));
  const std::uint64_t after = hash_of(*unharmed);
  at_every_call(
      kNoHostMemory, 3, create, [](const Made& simulation) { return plain(simulation->advance(1.0 / 60)); },
      [&](const Made& simulation) {
        if (hash_of(*simulation) == after) return;
        EXPECT_EQ(hash_of(*simulation), before) << "a part of a frame's substeps";
        must(simulation->advance(1.0 / 60));
        EXPECT_EQ(hash_of(*simulation), after);
      });
}

// A pass leaves its successors sums, counts and lists; those of a frame that was broken off must reach no other.
TEST_F(Faults, a_frame_with_contacts_that_is_broken_off_between_two_passes_leaves_nothing_behind) {
  SimulationOptions one_by_one;
  one_by_one.timings = one_by_one.timings_on_cpu = true;
  Scene scene = folding_sheet();
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0.02f, 0.004f, 0};
  scene.cloths[1].anchors.clear();
  scene.solver.substeps = 2;
  const auto simulation = must(Simulation::create(device(), scene, one_by_one));
  for (int frame = 0; frame < 3; ++frame) must(simulation->advance(1.0 / 60));
  const Snapshot snapshot = must(simulation->save());
  faults.plan(-1, kNoHostMemory);
  must(simulation->advance(1.0 / 60));
  const auto calls = static_cast<long>(faults.counted.size());
  const std::uint64_t expected = hash_of(*simulation);
  EXPECT_GT(simulation->counts().contacts_most, 100u);
  for (long call = 1; call < calls; call += std::max(1L, calls / 60)) {
    must(simulation->restore(snapshot));
    faults.plan(call, kNoHostMemory);
    const auto done = simulation->advance(1.0 / 60);
    const std::string failed = faults.failed;
    faults.plan(-1, kNoHostMemory);
    EXPECT_EQ(bool(done), failed.starts_with("vkWait")) << "call " << call << " of " << calls << ", " << failed;
    must(simulation->restore(snapshot));
    must(simulation->advance(1.0 / 60));
    ASSERT_EQ(hash_of(*simulation), expected) << "call " << call << " of " << calls << ", " << failed;
  }
}

// Half a pose on the trajectories of another would be torn back.
TEST_F(Faults, a_pose_is_written_whole_or_not_at_all) {
  Scene scene = close_sheets();
  scene.cloths[0].anchors.push_back(held_at({Corner::low_high}));
  std::vector<gpu::vec4> before, wanted;
  at_every_call(
      kNoMemory, 1,
      [&] {
        auto simulation = must(Simulation::create(device(), scene));
        must(simulation->advance(1.0 / 60));
        wanted = before = must(simulation->read_positions());
        for (gpu::vec4& p : wanted) p.y += 3;
        return simulation;
      },
      [&](const Made& simulation) { return simulation->write_positions(wanted); },
      [&](const Made& simulation) {
        const auto after = must(simulation->read_positions());
        const bool whole = after[0].y == wanted[0].y;
        for (std::size_t i = 0; i < after.size(); ++i) ASSERT_EQ(after[i].y, (whole ? wanted : before)[i].y) << i;
        must(simulation->advance(1.0 / 60));
        EXPECT_LT(top_speed(*simulation), 5) << "something was torn";
        const std::uint32_t pin = simulation->fabric().anchors[0].particle;
        EXPECT_EQ(must(simulation->read_positions())[pin].y, after[pin].y);
      });
}

// A collider that is placed is there with its vertices, or both are where they were.
TEST_F(Faults, a_mesh_collider_is_placed_whole_or_not_at_all) {
  const test::Folder folder;
  folder.write("floor.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n");
  Scene scene = sheet(4);
  scene.folder = folder / "";
  scene.contacts.enabled = true;
  Collider& floor = scene.colliders.emplace_back();
  floor.shape = ColliderShape::mesh;
  floor.mesh = "floor.obj";
  floor.centre = {0, -0.5f, 0};
  ColliderPose pose;
  pose.centre = {0, -2, 0};
  at_every_call(
      kNoMemory, 1, [&] { return must(Simulation::create(device(), scene)); },
      [&](const Made& simulation) { return simulation->place_collider(0, pose); },
      [](const Made& simulation) {
        EXPECT_EQ(must(simulation->read_positions()).back().y, simulation->colliders()[0].centre.y);
        must(simulation->advance(1.0 / 60));
        EXPECT_EQ(must(simulation->read_positions()).back().y, simulation->colliders()[0].centre.y);
      });
}

// A pin that stands at its target stays there, or where the snapshot has it, when another is moved.
TEST_F(Faults, a_state_that_could_not_be_put_back_has_its_own_pins) {
  Scene scene = close_sheets();
  scene.cloths[0].anchors = {held_at({Corner::low_high}), held_at({Corner::high_high})};
  Snapshot snapshot;
  at_every_call(
      kNoMemory, 1,
      [&] {
        auto simulation = must(Simulation::create(device(), scene));
        snapshot = must(simulation->save());
        const Vec3 there = simulation->fabric().anchors[0].rest - Vec3{0, 0.05f, 0};
        must(simulation->move_anchors(0, {&there, 1}));
        must(simulation->advance(1.0 / 60));
        must(simulation->advance(1.0 / 60));
        return simulation;
      },
      [&](const Made& simulation) { return simulation->restore(snapshot); },
      [](const Made& simulation) {
        const std::uint32_t pin = simulation->fabric().anchors[0].particle;
        const float height = must(simulation->read_positions())[pin].y;
        const Vec3 there = simulation->fabric().anchors[1].rest + Vec3{0, 0.01f, 0};
        must(simulation->move_anchors(1, {&there, 1}));
        must(simulation->advance(1.0 / 60));
        EXPECT_EQ(must(simulation->read_positions())[pin].y, height);
      });
}

TEST_F(Faults, pins_that_a_failed_frame_was_to_move_get_there_with_the_next) {
  Vec3 target;
  at_every_call(
      kNoHostMemory, 2,
      [&] {
        auto simulation = must(Simulation::create(device(), hung_sheet()));
        target = simulation->fabric().anchors[0].rest + Vec3{0, 0.25f, 0};
        must(simulation->move_anchors(0, {&target, 1}));
        return simulation;
      },
      [](const Made& simulation) { return plain(simulation->submit(1.0 / 60)); },
      [&](const Made& simulation) {
        must(simulation->advance(0));   // no substep fits
        must(simulation->advance(1.0 / 60));
        const gpu::vec4 p = must(simulation->read_positions())[simulation->fabric().anchors[0].particle];
        EXPECT_EQ((Vec3{p.x, p.y, p.z}), target);
      });
}

TEST_F(Faults, memory_that_runs_out_while_contacts_get_more_capacity_is_told_and_nothing_crosses) {
  at_every_call(
      kNoMemory, 1, [&] { return must(Simulation::create(device(), close_sheets())); },
      [](const Made& simulation) -> Result<void> {
        if (auto done = plain(simulation->advance(1.0 / 60)); !done) return done;
        // A capacity that is too small is no end: less is asked for, pairs that overflow hold their particles still, and a note says why.
        const auto& notes = simulation->fabric().notes;
        if (notes.empty()) return {};
        EXPECT_EQ(simulation->counts().contacts_overflowed, 0u) << "there was memory for less";
        return fail(ErrorKind::memory, notes.back());
      },
      [](const Made& simulation) {
        must(simulation->advance(1.0 / 60));
        EXPECT_GT(simulation->counts().contacts_most, 16u);
        // An overflow that was undone must not count as one of the frame that follows.
        for (const BufferUse& buffer : simulation->buffers())
          if (buffer.name == "candidates") { EXPECT_LE(buffer.bytes, 4 * sizeof(gpu::uvec4) * simulation->counts().contacts_most); }
        const auto particles = must(simulation->read_positions());
        std::vector<Vec3> positions;
        for (const gpu::vec4& p : particles) positions.push_back({p.x, p.y, p.z});
        EXPECT_EQ(count_crossings(positions, simulation->fabric().triangles, simulation->fabric().cloth_triangles), 0u);
      });
}

// Contacts need 1.5 times their capacity, and twice as much is more than a storage buffer may hold.
TEST_F(Faults, contacts_get_as_much_capacity_as_the_device_allows_where_it_does_not_allow_twice_as_much) {
  Scene scene = close_sheets();
  for (Cloth& cloth : scene.cloths) cloth.grid->cells_x = cloth.grid->cells_y = 24;
  scene.contacts.capacity = 1 << 16;
  auto ample = must(Simulation::create(device(), scene));
  must(ample->advance(1.0 / 60));
  const std::uint32_t found = ample->counts().contacts_most;
  const std::uint64_t hash = hash_of(*ample);
  ample.reset();

  scene.contacts.capacity = found * 2 / 3;
  for (const std::uint32_t spare : {found / 8, found / 64}) {
    faults.most_storage = static_cast<std::uint32_t>((found + spare) * sizeof(gpu::uvec4));
    lend();
    const auto simulation = must(Simulation::create(device(), scene));
    must(simulation->advance(1.0 / 60));
    EXPECT_EQ(simulation->counts().contacts_overflowed, 0u) << "capacity for " << spare << " more";
    EXPECT_EQ(hash_of(*simulation), hash);
    ASSERT_FALSE(simulation->fabric().notes.empty());
    EXPECT_NE(simulation->fabric().notes.back().find("maxStorageBufferRange"), std::string::npos) << simulation->fabric().notes.back();
  }
}

TEST_F(Faults, memory_that_runs_out_while_a_state_is_put_back_is_a_sentence_and_it_can_be_put_back_again) {
  const auto first = must(Simulation::create(device(), close_sheets()));
  must(first->advance(1.0 / 60));
  const Snapshot snapshot = must(first->save());
  must(first->advance(1.0 / 60));
  const std::uint64_t expected = hash_of(*first);
  at_every_call(
      kNoMemory, 1, [&] { return must(Simulation::create(device(), close_sheets())); },
      [&](const Made& simulation) -> Result<void> {
        if (auto done = simulation->restore(snapshot); !done) return done;
        return plain(simulation->save());
      },
      [&](const Made& simulation) {
        must(simulation->restore(snapshot));
        must(simulation->advance(1.0 / 60));
        EXPECT_EQ(hash_of(*simulation), expected);
      });
}

TEST_F(Faults, a_device_that_is_lost_is_a_sentence_wherever_it_happens_and_nothing_hangs) {
  for (const bool features : {true, false}) {
    if (!features) lend_without_features();
    at_every_call(
        VK_ERROR_DEVICE_LOST, 3, [] { return Made(); },
        [&](Made& owner) -> Result<void> {
          auto made = Simulation::create(device(), features ? folding_sheet() : hung_sheet());
          if (!made) return made.take_error();
          owner = std::move(*made);   // its destructor, which waits too, cannot report
          return frames(*owner);
        },
        no_more);
  }
}

TEST_F(Faults, a_device_that_is_lost_while_a_picture_is_drawn_is_a_sentence) {
  const auto simulation = must(Simulation::create(device(), hung_sheet()));
  const auto work = [&](std::unique_ptr<Shading>& shading) { return draw(device(), *simulation, shading); };
  at_every_call(VK_ERROR_DEVICE_LOST, kAll, [] { return std::unique_ptr<Shading>(); }, work, no_more);
}

}  // namespace
}  // namespace weft
