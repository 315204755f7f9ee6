// See samples/view/carry.h.
#include "samples/view/carry.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "shaders/shared.h"

namespace weft::view {
namespace {

const std::vector<std::byte>* find(const Snapshot& snapshot, std::string_view name) {
  for (const Snapshot::Content& content : snapshot.contents)
    if (content.name == name) return &content.bytes;
  return nullptr;
}

std::vector<std::byte>* find(Snapshot& snapshot, std::string_view name) {
  return const_cast<std::vector<std::byte>*>(find(static_cast<const Snapshot&>(snapshot), name));
}

// The first three of every four floats; w is the new scene's.
void carry_places(const State& was, State& fresh, std::string_view name) {
  const std::vector<std::byte>* from = find(was.snapshot, name);
  std::vector<std::byte>* to = find(fresh.snapshot, name);
  if (from == nullptr || to == nullptr) return;
  for (std::size_t r = 0; r < was.rooms.size(); ++r)
    for (std::uint32_t k = 0; k < was.rooms[r].particles; ++k)
      std::memcpy(to->data() + (fresh.rooms[r].first + k) * sizeof(gpu::vec4), from->data() + (was.rooms[r].first + k) * sizeof(gpu::vec4),
                  3 * sizeof(float));
}

// The number that a particle of `was` has in `fresh`.
std::uint32_t moved(std::uint32_t particle, const State& was, const State& fresh) {
  if (particle == WEFT_NONE) return particle;
  constexpr std::uint32_t kFlags = WEFT_STAYS | WEFT_FROM_HERE;
  const std::uint32_t own = particle & ~kFlags;
  for (std::size_t r = 0; r < was.rooms.size(); ++r)
    if (own - was.rooms[r].first < was.rooms[r].particles) return (own - was.rooms[r].first + fresh.rooms[r].first) | (particle & kFlags);
  return particle;
}

// Targets of those who are the same particles in both.
void carry_anchors(const State& was, State& fresh) {
  const std::vector<std::byte>* from = find(was.snapshot, "anchors");
  std::vector<std::byte>* to = find(fresh.snapshot, "anchors");
  if (from == nullptr || to == nullptr || from->size() != to->size()) return;
  for (std::size_t at = 0; at + sizeof(gpu::Anchor) <= to->size(); at += sizeof(gpu::Anchor)) {
    gpu::Anchor old{}, own{};
    std::memcpy(&old, from->data() + at, sizeof old);
    std::memcpy(&own, to->data() + at, sizeof own);
    old.particle = moved(old.particle, was, fresh);
    if (old.particle == own.particle) std::memcpy(to->data() + at, &old, sizeof old);
  }
}

}  // namespace

std::vector<Room> rooms_of(const Simulation& simulation) {
  const CookedFabric& fabric = simulation.fabric();
  std::vector<Room> rooms;
  for (std::size_t c = 0; c < fabric.cloths.size(); ++c)
    rooms.push_back({fabric.cloths[c].first_particle, static_cast<std::uint32_t>(simulation.meshes()[c].points.size()),
                     fabric.cloths[c].first_vertex, fabric.cloths[c].vertices});
  for (const ColliderMesh& mesh : fabric.collider_meshes) rooms.push_back({mesh.first_particle, mesh.particles, mesh.first_vertex, mesh.vertices});
  return rooms;
}

bool are_alike(std::span<const Room> a, std::span<const Room> b) {
  return std::ranges::equal(a, b, {}, &Room::particles, &Room::particles);
}

Snapshot carried(const State& was, State fresh) {
  if (!are_alike(was.rooms, fresh.rooms)) return std::move(fresh.snapshot);
  for (const char* name : {"positions", "velocities"}) carry_places(was, fresh, name);
  carry_anchors(was, fresh);
  Snapshot& to = fresh.snapshot;
  const Snapshot& from = was.snapshot;
  to.substeps = static_cast<std::uint64_t>(std::llround(static_cast<double>(from.substeps) * was.h / fresh.h));
  to.wind_travelled = from.wind_travelled;
  for (std::size_t k = 0; k < std::min(from.colliders.size(), to.colliders.size()); ++k) {
    to.colliders[k].pose = from.colliders[k].pose;
    to.colliders[k].is_host_driven = from.colliders[k].is_host_driven;
  }
  if (from.skins.size() == to.skins.size()) {
    for (std::size_t k = 0; k < to.skins.size(); ++k)
      if (from.skins[k].pose.size() == to.skins[k].pose.size() && from.skins[k].weights.size() == to.skins[k].weights.size() &&
          !from.skins[k].is_kept)
        to.skins[k] = from.skins[k];
  }
  if (from.frames.size() == to.frames.size()) to.frames = from.frames;
  return std::move(to);
}

}  // namespace weft::view
