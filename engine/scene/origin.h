// Floats have a millimetre at 10 km and lose it in every substep. What is simulated is therefore told from an origin near the cloth:
// positions, anchors and colliders are a few metres from it, wherever in the world it lies. Internal.
#pragma once

#include <span>
#include <vector>

#include "engine/mesh.h"
#include "engine/scene.h"

namespace weft {

/// A point near the middle of the meshes, in steps so coarse that whole floats of a far scene can be told from it without rounding, and
/// that it is the world's own origin for everything that hangs within kOriginStep / 2 of that.
inline constexpr float kOriginStep = 16;   // m; floats up to 8 m have 5e-7 m
Vec3 origin_near(std::span<const Mesh> meshes);

/// The scene as it is told from there. Keys are relative to what they move and stay; so do the camera and the light, which are the
/// renderer's.
Scene told_from(Scene scene, Vec3 origin);

/// make_meshes, with scene and meshes told from an origin near the cloths. Far away meshes are made twice: they have been rounded there.
struct Near {
  Scene scene;
  std::vector<Mesh> meshes;
  Vec3 origin;
};
Result<Near> told_near(const Scene& scene);

}  // namespace weft
