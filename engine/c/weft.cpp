// See engine/c/weft.h.
#include "engine/c/weft.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <span>
#include <string>

#include "engine/metrics.h"
#include "engine/simulation.h"

struct weft_device {
  std::unique_ptr<weft::compute::Device> device;
};

struct weft_simulation {
  std::unique_ptr<weft::Simulation> simulation;
};

namespace {

using weft::Error;
using weft::ErrorKind;
using weft::fail;
using weft::Result;
using weft::Vec3;

static_assert(static_cast<int>(ErrorKind::input) + 1 == WEFT_INPUT && static_cast<int>(ErrorKind::memory) + 1 == WEFT_MEMORY &&
              static_cast<int>(ErrorKind::device_lost) + 1 == WEFT_DEVICE_LOST && static_cast<int>(ErrorKind::other) + 1 == WEFT_OTHER);
static_assert(sizeof(Vec3) == 3 * sizeof(float));

weft_status told(const Error& why, weft_error* error) {
  if (error != nullptr) {
    std::size_t size = std::min(why.message.size(), sizeof error->sentence - 1);
    // A letter of several bytes is not cut in two.
    if (size < why.message.size())
      while (size > 0 && (static_cast<unsigned char>(why.message[size]) & 0xc0) == 0x80) --size;
    std::memcpy(error->sentence, why.message.data(), size);
    error->sentence[size] = '\0';
  }
  return static_cast<weft_status>(static_cast<int>(why.kind) + 1);
}

// What `work`, which gives a Result<void>, has to say. Nothing of C++'s leaves it.
template <class Work>
weft_status done(weft_error* error, const Work& work) noexcept try {
  const Result<void> result = work();
  if (!result) return told({result.error(), result.kind()}, error);
  if (error != nullptr) error->sentence[0] = '\0';
  return WEFT_OK;
} catch (...) {
  return told(weft::caught("weft"), error);
}

Result<void> given(const void* pointer, const char* name) {
  if (pointer == nullptr) return fail(name, " is null");
  return {};
}

Vec3 vector(const float* xyz) { return {xyz[0], xyz[1], xyz[2]}; }

std::vector<Vec3> vectors(const float* xyz, std::size_t count) {
  std::vector<Vec3> all(count);
  for (std::size_t k = 0; k < count; ++k) all[k] = vector(xyz + 3 * k);
  return all;
}

// A list that may be null where it is empty.
Result<void> list(const void* pointer, std::size_t count, const char* name) { return count == 0 ? Result<void>() : given(pointer, name); }

weft_view view_of(const weft::FrameView& view) {
  return {reinterpret_cast<std::uint64_t>(view.buffer), view.offset, view.stride, view.count};
}

// Room for `there` entries must be room for all of them.
Result<void> room(std::size_t given, std::size_t there, const char* what) {
  if (given != there) return fail("there is room for ", given, " ", what, ", and there are ", there);
  return {};
}

}  // namespace

// A sentence where a pointer is null, and out.
#define WEFT_GIVEN(pointer) \
  if (auto good = given(pointer, #pointer); !good) return good
#define WEFT_LIST(pointer, count) \
  if (auto good = list(pointer, count, #pointer); !good) return good

uint32_t weft_abi(void) { return WEFT_ABI; }

weft_status weft_device_create(const char* name, weft_device** device, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    weft::compute::DeviceChoice choice;
    choice.name = name != nullptr ? name : "";
    auto made = weft::compute::Device::create(choice);
    if (!made) return made.take_error();
    *device = new weft_device{std::move(*made)};
    return {};
  });
}

weft_status weft_device_borrow(const weft_borrowed* lent, weft_device** device, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(lent);
    WEFT_GIVEN(device);
    weft::compute::BorrowedDevice all;
    all.get_instance_proc_addr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(lent->get_instance_proc_addr);
    all.instance = static_cast<VkInstance>(lent->instance);
    all.physical = static_cast<VkPhysicalDevice>(lent->physical);
    all.device = static_cast<VkDevice>(lent->device);
    all.queue = static_cast<VkQueue>(lent->queue);
    all.queue_family = lent->queue_family;
    all.created_with = static_cast<const VkDeviceCreateInfo*>(lent->created_with);
    auto made = weft::compute::Device::borrow(all);
    if (!made) return made.take_error();
    *device = new weft_device{std::move(*made)};
    return {};
  });
}

void weft_device_destroy(weft_device* device) { delete device; }

const char* weft_device_name(const weft_device* device) { return device != nullptr ? device->device->name().c_str() : ""; }

namespace {

Result<void> make(weft_device* device, const Result<weft::Scene>& scene, weft_simulation** simulation) {
  if (!scene) return Error{scene.error(), scene.kind()};
  auto made = weft::Simulation::create(*device->device, *scene);
  if (!made) return made.take_error();
  *simulation = new weft_simulation{std::move(*made)};
  return {};
}

}  // namespace

weft_status weft_simulation_create(weft_device* device, const char* scene, const char* folder, weft_simulation** simulation,
                                   weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    WEFT_GIVEN(scene);
    WEFT_GIVEN(simulation);
    return make(device, weft::parse_scene(scene, folder != nullptr ? folder : ""), simulation);
  });
}

weft_status weft_simulation_load(weft_device* device, const char* file, weft_simulation** simulation, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    WEFT_GIVEN(file);
    WEFT_GIVEN(simulation);
    return make(device, weft::load_scene(file), simulation);
  });
}

void weft_simulation_destroy(weft_simulation* simulation) { delete simulation; }

namespace {

Result<void> tell(Result<weft::Advance> advance, weft_advanced* done) {
  if (!advance) return advance.take_error();
  if (done != nullptr) *done = {advance->simulated, advance->clamped, advance->substeps, advance->pairs_lost};
  return {};
}

}  // namespace

weft_status weft_advance(weft_simulation* simulation, double seconds, weft_advanced* advanced, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return tell(simulation->simulation->advance(seconds), advanced);
  });
}

weft_status weft_submit(weft_simulation* simulation, double seconds, weft_advanced* advanced, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return tell(simulation->simulation->submit(seconds), advanced);
  });
}

weft_status weft_record(weft_simulation* simulation, void* commands, double seconds, weft_advanced* advanced, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return tell(simulation->simulation->record(static_cast<VkCommandBuffer>(commands), seconds), advanced);
  });
}

// Those that cannot fail have an answer for null, too.
uint64_t weft_ready_semaphore(const weft_simulation* simulation) {
  return simulation != nullptr ? reinterpret_cast<std::uint64_t>(simulation->simulation->ready_semaphore()) : 0;
}
uint64_t weft_ready_value(const weft_simulation* simulation) { return simulation != nullptr ? simulation->simulation->ready_value() : 0; }
double weft_time(const weft_simulation* simulation) { return simulation != nullptr ? simulation->simulation->time() : 0; }

weft_view weft_positions(const weft_simulation* simulation) {
  return simulation != nullptr ? view_of(simulation->simulation->positions()) : weft_view{};
}
weft_view weft_normals(const weft_simulation* simulation) {
  return simulation != nullptr ? view_of(simulation->simulation->normals()) : weft_view{};
}

namespace {

Result<void> copy(Result<std::vector<Vec3>> read, float* xyz, std::size_t vertices) {
  if (!read) return read.take_error();
  if (auto good = room(vertices, read->size(), "vertices"); !good) return good;
  std::memcpy(xyz, read->data(), read->size() * sizeof(Vec3));
  return {};
}

}  // namespace

weft_status weft_read_positions(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyz);
    return copy(simulation->simulation->read_vertex_positions(), xyz, vertices);
  });
}

weft_status weft_read_normals(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyz);
    return copy(simulation->simulation->read_vertex_normals(), xyz, vertices);
  });
}

size_t weft_triangle_count(const weft_simulation* simulation) {
  std::size_t count = 0;
  if (simulation != nullptr)
    for (const weft::Mesh& mesh : simulation->simulation->meshes()) count += mesh.render.triangles.size();
  return count;
}

weft_status weft_triangles(const weft_simulation* simulation, uint32_t* corners, size_t triangles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(corners);
    if (auto good = room(triangles, weft_triangle_count(simulation), "triangles"); !good) return good;
    std::uint32_t first = 0;
    for (const weft::Mesh& mesh : simulation->simulation->meshes()) {
      for (const weft::Triangle& triangle : mesh.render.triangles)
        for (const std::uint32_t corner : triangle) *corners++ = first + corner;
      first += static_cast<std::uint32_t>(mesh.render.positions.size());
    }
    return {};
  });
}

weft_status weft_read_uvs(const weft_simulation* simulation, float* uv, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(uv);
    if (auto good = room(vertices, simulation->simulation->positions().count, "vertices"); !good) return good;
    for (const weft::Mesh& mesh : simulation->simulation->meshes())
      for (std::size_t k = 0; k < mesh.render.positions.size(); ++k) {
        const weft::Vec2 at = k < mesh.render.uvs.size() ? mesh.render.uvs[k] : weft::Vec2();
        *uv++ = at.x;
        *uv++ = at.y;
      }
    return {};
  });
}

uint32_t weft_cloth_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->fabric().cloths.size()) : 0;
}

weft_status weft_cloth_vertices(const weft_simulation* simulation, uint32_t cloth, uint32_t* first, uint32_t* count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(first);
    WEFT_GIVEN(count);
    const auto& cloths = simulation->simulation->fabric().cloths;
    if (cloth >= cloths.size()) return fail("there is no cloth ", cloth, ", but ", cloths.size());
    *first = cloths[cloth].first_vertex;
    *count = cloths[cloth].vertices;
    return {};
  });
}

weft_status weft_set_gravity(weft_simulation* simulation, const float gravity[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(gravity);
    return simulation->simulation->set_gravity(vector(gravity));
  });
}

weft_status weft_set_wind(weft_simulation* simulation, const float wind[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(wind);
    return simulation->simulation->set_wind(vector(wind));
  });
}

uint32_t weft_anchor_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->fabric().anchors.size()) : 0;
}

weft_status weft_move_anchors(weft_simulation* simulation, uint32_t first, const float* xyz, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(xyz, count);
    return simulation->simulation->move_anchors(first, vectors(xyz, count));
  });
}

weft_status weft_pin(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    return simulation->simulation->pin({vertices, count});
  });
}

weft_status weft_release(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    return simulation->simulation->release({vertices, count});
  });
}

weft_status weft_move_pins(weft_simulation* simulation, const uint32_t* vertices, const float* xyz, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    WEFT_LIST(xyz, count);
    return simulation->simulation->move_pins({vertices, count}, vectors(xyz, count));
  });
}

weft_status weft_grab(weft_simulation* simulation, const float origin[3], const float direction[3], const weft_grip* grip,
                      weft_grabbed* grabbed, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(origin);
    WEFT_GIVEN(direction);
    WEFT_GIVEN(grabbed);
    const weft::Grip by = grip != nullptr ? weft::Grip{grip->stiffness, grip->damping, grip->force} : weft::Grip();
    auto found = simulation->simulation->grab(vector(origin), vector(direction), by);
    if (!found) return found.take_error();
    *grabbed = {0, WEFT_NOTHING, WEFT_NOTHING, {}};
    if (const auto& held = *found) *grabbed = {held->distance, held->grab, held->cloth, {held->point.x, held->point.y, held->point.z}};
    return {};
  });
}

weft_status weft_move_grab(weft_simulation* simulation, uint32_t grab, const float target[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(target);
    return simulation->simulation->move_grab(grab, vector(target));
  });
}

weft_status weft_let_go(weft_simulation* simulation, uint32_t grab, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return simulation->simulation->let_go(grab);
  });
}

uint32_t weft_collider_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->scene().colliders.size()) : 0;
}

weft_status weft_move_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(pose);
    const float* r = pose->rotation;
    return simulation->simulation->move_collider(collider, {vector(pose->centre), vector(pose->normal), {r[0], r[1], r[2], r[3]}});
  });
}

weft_status weft_collider_pose(weft_simulation* simulation, uint32_t collider, weft_pose* pose, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(pose);
    const auto poses = simulation->simulation->colliders();
    if (collider >= poses.size()) return fail("there is no collider ", collider, ", but ", poses.size());
    const auto& [centre, normal, r] = poses[collider];
    *pose = {{centre.x, centre.y, centre.z}, {normal.x, normal.y, normal.z}, {r.x, r.y, r.z, r.w}};
    return {};
  });
}

weft_counts weft_get_counts(const weft_simulation* simulation) {
  if (simulation == nullptr) return {};
  const weft::Counts c = simulation->simulation->counts();
  return {c.non_finite, c.coincident, c.contacts_overflowed, c.crossings, c.contacts_most, c.contacts_room, c.truncated, c.detections};
}

weft_status weft_hash(const weft_simulation* simulation, uint64_t* hash, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(hash);
    auto particles = simulation->simulation->read_positions();
    if (!particles) return particles.take_error();
    *hash = weft::position_hash(*particles);
    return {};
  });
}

weft_status weft_save(const weft_simulation* simulation, void** bytes, size_t* size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(bytes);
    WEFT_GIVEN(size);
    auto snapshot = simulation->simulation->save();
    if (!snapshot) return snapshot.take_error();
    const std::vector<std::byte> all = weft::snapshot_bytes(*snapshot);
    void* copied = std::malloc(all.size());
    if (copied == nullptr) return fail(ErrorKind::memory, "there is not enough memory for a snapshot of ", all.size(), " bytes");
    std::memcpy(copied, all.data(), all.size());
    *bytes = copied;
    *size = all.size();
    return {};
  });
}

weft_status weft_restore(weft_simulation* simulation, const void* bytes, size_t size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(bytes, size);
    auto snapshot = weft::parse_snapshot({static_cast<const std::byte*>(bytes), size});
    if (!snapshot) return snapshot.take_error();
    return simulation->simulation->restore(*snapshot);
  });
}

void weft_free(void* bytes) { std::free(bytes); }
