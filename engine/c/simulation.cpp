// See engine/c/weft.h: simulations, made and run.
#include "engine/c/inside.h"

#include <algorithm>
#include <cstring>

#include "engine/cook/given.h"
#include "engine/scene/reader.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

// The caller's, as far as its header had it; the rest is 0. Errors: members that this library does not know, and that say something.
Result<weft_options> known_of(const weft_options* given) {
  weft_options all{};
  if (given == nullptr) return all;
  constexpr std::size_t kFirst = sizeof(weft_options);   // of the first version: nobody's is smaller
  if (given->size < kFirst) return fail("options.size is ", given->size, ", less than ", kFirst, ": sizeof(weft_options)");
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  for (std::size_t k = sizeof all; k < std::min<std::size_t>(given->size, 4096); ++k)
    if (bytes[k] != 0) return fail("options have ", given->size, " bytes, and this library knows ", sizeof all, " of them: it is older");
  std::memcpy(&all, given, sizeof all);
  return all;
}

// By name. Errors: one without a name or a mesh, or two of one name.
Result<weft::GivenMeshes> meshes_of(const weft_options& options) {
  weft::GivenMeshes meshes;
  if (auto good = list(options.meshes, options.mesh_count, "options.meshes"); !good) return good.take_error();
  for (const weft_named_mesh& one : std::span(options.meshes, options.mesh_count)) {
    if (one.name == nullptr || *one.name == '\0') return fail("a mesh among options.meshes has no name");
    if (one.mesh == nullptr) return fail("mesh \"", one.name, "\" is null");
    if (!meshes.emplace(one.name, &one.mesh->mesh).second) return fail("two of options.meshes are called \"", one.name, "\"");
  }
  return meshes;
}

// Nothing that is given is dropped without a word.
Result<void> all_used(const weft::Scene& scene, const weft::GivenMeshes& meshes) {
  const auto names = [&](const auto& one) {
    return std::ranges::any_of(scene.cloths, [&](const weft::Cloth& c) { return c.mesh == one.first || c.render_mesh == one.first; }) ||
           std::ranges::any_of(scene.colliders, [&](const weft::Collider& c) { return c.mesh == one.first; });
  };
  for (const auto& one : meshes)
    if (!names(one)) return fail("no cloth and no collider of the scene has the mesh \"", one.first, "\"");
  return {};
}

weft::SimulationOptions said_by(const weft_options& options) {
  weft::SimulationOptions said;
  said.timings = options.timings != 0;
  if (options.pipeline_cache != nullptr) said.pipeline_cache = options.pipeline_cache;
  if (options.reader_stages != 0 || options.reader_accesses != 0)
    said.readers = weft::compute::Readers{options.reader_stages, options.reader_accesses};
  said.vertex_usage = options.vertex_usage;
  return said;
}

Result<void> keep(Result<std::unique_ptr<weft::Simulation>> made, weft_simulation** simulation) {
  if (!made) return made.take_error();
  *simulation = new weft_simulation{std::move(*made)};
  return {};
}

Result<void> tell(Result<weft::Advance> advance, weft_advanced* done) {
  if (!advance) return advance.take_error();
  if (done != nullptr) *done = {advance->simulated, advance->clamped, advance->substeps, advance->pairs_lost};
  return {};
}

}  // namespace

weft_status weft_simulation_create(weft_device* device, const char* scene, const char* folder, weft_simulation** simulation,
                                   weft_error* error) {
  return weft_simulation_create_with(device, scene, folder, nullptr, simulation, error);
}

weft_status weft_simulation_create_with(weft_device* device, const char* scene, const char* folder, const weft_options* options,
                                        weft_simulation** simulation, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    WEFT_GIVEN(scene);
    WEFT_GIVEN(simulation);
    const auto all = known_of(options);
    if (!all) return all.why();
    const auto given = meshes_of(*all);
    if (!given) return given.why();
    std::vector<std::string> names;
    for (const auto& [name, mesh] : *given) names.push_back(name);
    const std::filesystem::path in = folder != nullptr ? folder : "";
    const auto read = weft::parse_scene_with(scene, {in, names}, {});
    if (!read) return read.why();
    if (names.empty()) return keep(weft::Simulation::create(*device->device, *read, said_by(*all)), simulation);
    if (auto used = all_used(*read, *given); !used) return used;
    auto meshes = weft::make_meshes_with(*read, *given);
    if (!meshes) return meshes.take_error();
    return keep(weft::Simulation::create(*device->device, *read, std::move(*meshes), said_by(*all)), simulation);
  });
}

weft_status weft_simulation_load(weft_device* device, const char* file, weft_simulation** simulation, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(device);
    WEFT_GIVEN(file);
    WEFT_GIVEN(simulation);
    const auto scene = weft::load_scene(file);
    if (!scene) return scene.why();
    return keep(weft::Simulation::create(*device->device, *scene), simulation);
  });
}

void weft_simulation_destroy(weft_simulation* simulation) { delete simulation; }

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

weft_status weft_submit_after(weft_simulation* simulation, double seconds, const weft_wait* waits, uint32_t count, weft_advanced* advanced,
                              weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(waits, count);
    std::vector<VkSemaphoreSubmitInfo> all;
    for (const weft_wait& one : std::span(waits, count)) {
      if (one.semaphore == 0) return fail("a semaphore to wait for is null");
      VkSemaphoreSubmitInfo info{};
      info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
      info.semaphore = reinterpret_cast<VkSemaphore>(one.semaphore);
      info.value = one.value;
      info.stageMask = one.stages;
      all.push_back(info);
    }
    return tell(simulation->simulation->submit(seconds, all), advanced);
  });
}

weft_status weft_record(weft_simulation* simulation, void* commands, double seconds, weft_advanced* advanced, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return tell(simulation->simulation->record(static_cast<VkCommandBuffer>(commands), seconds), advanced);
  });
}

weft_status weft_reserve_contacts(weft_simulation* simulation, uint32_t pairs, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return simulation->simulation->reserve_contacts(pairs);
  });
}

// Those that cannot fail have an answer for null, too.
uint64_t weft_ready_semaphore(const weft_simulation* simulation) {
  return simulation != nullptr ? reinterpret_cast<std::uint64_t>(simulation->simulation->ready_semaphore()) : 0;
}
uint64_t weft_ready_value(const weft_simulation* simulation) { return simulation != nullptr ? simulation->simulation->ready_value() : 0; }
double weft_time(const weft_simulation* simulation) { return simulation != nullptr ? simulation->simulation->time() : 0; }

double weft_gpu_milliseconds(const weft_simulation* simulation) {
  return simulation != nullptr ? simulation->simulation->gpu_milliseconds() : 0;
}
