// Colliders given by a signed distance: planes, spheres, capsules and boxes. Mesh colliders belong to the effect contact.
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

/// Poses at the frame's start and end: all planes, then all spheres, capsules and boxes.
inline constexpr Buffer colliders = buffer<gpu::Collider>(
    "colliders", Lifetime::uploaded,
    [](const Cooked& s) { return std::uint64_t(s.scene.colliders.size() - s.fabric.collider_meshes.size()); });

}  // namespace weft::buffers
