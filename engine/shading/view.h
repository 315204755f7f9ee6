// Where the camera and the sun look.
#pragma once

#include "engine/scene.h"
#include "shaders/shading/frame.h"

namespace weft::shading {

/// A ball around everything that casts shadows.
struct Extent {
  Vec3 centre;       // m
  float radius = 1;  // m, > 0
};

/// Fills what depends on the camera. Depth is near / distance: 1 near, 0 at infinity.
void set_camera(Frame& frame, const Camera& camera, std::uint32_t width, std::uint32_t height);

/// Fills the shadow map's view: along the sun, over the whole extent. `frame.to_sun` is set already.
void set_sun(Frame& frame, const Extent& extent, std::uint32_t texels);

}  // namespace weft::shading
