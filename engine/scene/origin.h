// A local origin: floats are a millimetre apart at 10 km, and every substep rounds to that. What is simulated is therefore
// relative to an origin near the cloth: positions, anchors and colliders are a few metres from it. Internal.
#pragma once

#include <span>
#include <vector>

#include "engine/mesh.h"
#include "engine/scene.h"

namespace weft {

/// The middle of the meshes, rounded to multiples of kOriginStep: coarse enough that subtracting it from positions far away does
/// not round, and that it is the world's own origin for cloth within kOriginStep / 2 of that.
inline constexpr float kOriginStep = 16;   // m; floats up to 8 m have 5e-7 m
Vec3 origin_near(std::span<const Mesh> meshes);

/// The scene relative to `origin`. Keys stay as they are: they are relative to what they move. So do the camera and the light,
/// which are the renderer's.
Scene relative_to(Scene scene, Vec3 origin);

/// make_meshes, with scene and meshes relative to an origin near the cloths. Meshes far away are made twice: the first ones are
/// rounded.
struct Near {
  Scene scene;
  std::vector<Mesh> meshes;
  Vec3 origin;
};
Result<Near> recentred(const Scene& scene);

}  // namespace weft
