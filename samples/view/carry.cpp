// See samples/view/carry.h.
#include "samples/view/carry.h"

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
void carry_places(const Snapshot& was, Snapshot& fresh, std::string_view name) {
  const std::vector<std::byte>* from = find(was, name);
  std::vector<std::byte>* to = find(fresh, name);
  if (from == nullptr || to == nullptr || from->size() != to->size()) return;
  for (std::size_t at = 0; at + sizeof(gpu::vec4) <= to->size(); at += sizeof(gpu::vec4))
    std::memcpy(to->data() + at, from->data() + at, 3 * sizeof(float));
}

// Targets of those who are the same particles in both.
void carry_anchors(const Snapshot& was, Snapshot& fresh) {
  const std::vector<std::byte>* from = find(was, "anchors");
  std::vector<std::byte>* to = find(fresh, "anchors");
  if (from == nullptr || to == nullptr || from->size() != to->size()) return;
  for (std::size_t at = 0; at + sizeof(gpu::Anchor) <= to->size(); at += sizeof(gpu::Anchor)) {
    gpu::Anchor old{}, own{};
    std::memcpy(&old, from->data() + at, sizeof old);
    std::memcpy(&own, to->data() + at, sizeof own);
    if (old.particle == own.particle) std::memcpy(to->data() + at, from->data() + at, sizeof own);
  }
}

}  // namespace

Snapshot carried(const Snapshot& was, double h_was, Snapshot fresh, double h) {
  const auto *had = find(was, "positions"), *has = find(fresh, "positions");
  if (had == nullptr || has == nullptr || had->size() != has->size()) return fresh;
  fresh.substeps = static_cast<std::uint64_t>(std::llround(static_cast<double>(was.substeps) * h_was / h));
  fresh.wind_travelled = was.wind_travelled;
  for (const char* name : {"positions", "velocities"}) carry_places(was, fresh, name);
  carry_anchors(was, fresh);
  for (std::size_t k = 0; k < std::min(was.colliders.size(), fresh.colliders.size()); ++k) {
    Snapshot::ColliderState& to = fresh.colliders[k];
    to.pose = was.colliders[k].pose;
    to.is_host_driven = was.colliders[k].is_host_driven;
  }
  if (was.skins.size() == fresh.skins.size()) {
    for (std::size_t k = 0; k < fresh.skins.size(); ++k)
      if (was.skins[k].pose.size() == fresh.skins[k].pose.size() && was.skins[k].weights.size() == fresh.skins[k].weights.size() &&
          !was.skins[k].is_kept)
        fresh.skins[k] = was.skins[k];
  }
  if (was.frames.size() == fresh.frames.size()) fresh.frames = was.frames;
  return fresh;
}

}  // namespace weft::view
