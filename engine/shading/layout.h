// The places of a scene's solids in a picture, and the extent of everything.
#pragma once

#include <span>
#include <vector>

#include "engine/frame_view.h"
#include "engine/scene.h"
#include "engine/shading/view.h"

namespace weft::shading {

/// Around the cloths' rest places and the colliders that have an end, wherever their keys take them, down to a floor below.
/// `meshes` are the places of the cloths' vertices, then of those of mesh colliders in their own axes.
Extent extent_of(const Scene& scene, std::span<const std::span<const Vec3>> meshes);

/// The size of a floor's tile: a round number of about a quarter of the radius.
float tile_size(float radius);

/// A collider at its pose, as solid.vert wants it.
Solid solid_of(const Collider& collider, const ColliderPose& pose, const ColliderSize& size, const Frame& frame, Vec3 target, float tile);

/// How many vertices solid.vert makes of it.
std::uint32_t vertex_count(const Solid& solid);

}  // namespace weft::shading
