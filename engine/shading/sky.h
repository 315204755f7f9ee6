// The analytic sky that sky.glsl draws, worked out from a scene's light.
#pragma once

#include "engine/scene.h"
#include "shaders/shading/frame.h"

namespace weft::shading {

/// Fills the radiances of the sky, the sun and the ground, the ambient harmonics and the exposure. `floor` is the colour of
/// what lies below: it sends light back up.
void set_sky(Frame& frame, const Light& light, Vec3 floor);

}  // namespace weft::shading
