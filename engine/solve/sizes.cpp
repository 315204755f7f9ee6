#include "engine/solve/sizes.h"

#include <algorithm>

namespace weft {
namespace {

// The cloth or mesh collider that most of the particles belong to.
std::string largest_part(const CookedFabric& fabric) {
  std::string name = "the scene";
  std::uint32_t most = 0;
  const auto look = [&](const char* list, std::size_t entry, std::uint32_t particles) {
    if (particles <= most) return;
    most = particles;
    name = list + ('[' + std::to_string(entry)) + ']';
  };
  for (std::size_t k = 0; k < fabric.cloths.size(); ++k) look("cloths", k, fabric.cloths[k].particles);
  for (const ColliderMesh& mesh : fabric.collider_meshes) look("colliders", mesh.collider, mesh.particles);
  return fail(name, ": has ", most, " of the scene's ", fabric.positions.size(), " particles").message;
}

}  // namespace

std::string cause_of_size(bool grows, const Cooked& subject) {
  const std::uint32_t capacity = subject.scene.contacts.capacity;   // 0: chosen by the number of particles
  return grows && capacity > 0 ? fail("contacts.capacity: ", capacity, " candidate pairs").message : largest_part(subject.fabric);
}

std::string beyond(const SizeLimits& limits, std::string_view device, const Plan& plan, const Cooked& subject) {
  const std::uint64_t threads = limits.workgroups * limits.workgroup, capacity = std::max(1u, subject.contacts.capacity);
  std::string fault;
  std::uint64_t room = capacity;   // for candidate pairs
  const auto look = [&](bool grows, std::uint64_t wanted, std::uint64_t limit, const auto&... why) {
    if (wanted <= limit) return;
    const std::uint64_t most = grows ? limit / std::max<std::uint64_t>(1, wanted / capacity) : 0;
    if (!fault.empty() && most >= room) return;   // what leaves the least room tells how much there is
    room = most;
    const bool is_asked_for = grows && subject.scene.contacts.capacity > 0;
    const std::string at_most = is_asked_for ? " (at most " + std::to_string(most) + ')' : "";
    fault = fail(cause_of_size(grows, subject), ", too many for ", device, at_most, ": ", why...).message;
  };
  for (const Plan::PlannedBuffer& planned : plan.buffers) {
    const std::uint64_t bytes = bytes_of(*planned.row, subject);
    if (planned.storage)
      look(planned.row->grows, bytes, limits.storage_bytes, "buffer ", planned.row->name, " takes ", bytes,
           " bytes, above its maxStorageBufferRange of ", limits.storage_bytes);
  }
  for (const PlannedPass& planned : plan.passes)
    for (const Range& range : ranges_of(*planned.pass, subject)) {
      if (planned.pass->a_workgroup_each)
        look(false, range.count, limits.workgroups, "pass ", planned.label, " takes ", range.count, " workgroups of its ", limits.workgroups);
      else
        look(planned.pass->threads.grows, range.count, threads, "pass ", planned.label, " takes ", range.count, " threads, and its ",
             limits.workgroups, " workgroups have ", threads);
    }
  return fault;
}

}  // namespace weft
