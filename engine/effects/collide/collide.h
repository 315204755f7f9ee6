// Colliders that have a signed distance: planes, spheres, capsules and boxes. Meshes are met through contacts.
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

/// Their poses in this frame: all planes, then all spheres, capsules and boxes.
inline constexpr Buffer colliders = buffer<gpu::Collider>(
    "colliders", Lifetime::told, [](const Cooked& s) { return std::uint64_t(s.scene.colliders.size() - s.fabric.collider_meshes.size()); });

}  // namespace weft::buffers
