// What every shading shader sees of a frame: one uniform block and two push blocks, described once for C++ and GLSL.
// Members are ordered so that std140 and C++ agree: each vec3 is followed by a scalar, everything else is 16 bytes.
#ifndef WEFT_SHADING_FRAME_H
#define WEFT_SHADING_FRAME_H

#ifdef __cplusplus
#include <array>
#include <cstdint>

#include "engine/vector.h"

namespace weft::shading {
using uint = std::uint32_t;
using vec2 = Vec2;
using vec3 = Vec3;
using vec4 = Vec4;
using mat4 = std::array<float, 16>;  // column by column
#endif

// The camera looks along ray_z; a point at distance z along it projects to near_plane / z, so 1 is near and 0 is far away.
// A pixel's ray is ray_z + x ray_x + y ray_y, with x and y in -1 ... 1 and y downward.
struct Frame {
  mat4 camera;     // world to clip
  mat4 sun;        // world to the shadow map's clip space
  vec4 ray_x;
  vec4 ray_y;
  vec4 ray_z;
  vec4 size;       // pixels: width, height, and their reciprocals
  vec3 eye;        // m
  float near_plane;  // m
  vec3 to_sun;     // unit
  float sun_texel;   // m: what one texel of the shadow map covers
  vec3 sun_light;  // what a white surface that faces the sun sends back
  float exposure;
  vec3 zenith;     // radiances of the sky, and of the ground that it shines on
  float fade;        // m: distance over which the floor passes into the horizon
  vec3 horizon;
  float occlusion_radius;  // m
  vec3 ground;
  float sun_depth;   // m: what the shadow map's depth range covers
  vec4 ambient[3];   // zonal harmonics of the sky, folded with a cosine lobe
};

#define WEFT_VIEW_CAMERA 0
#define WEFT_VIEW_SUN 1

// An affine image of a unit shape; the columns are at right angles, their lengths are the half sizes.
struct Solid {
  vec4 axis_x;
  vec4 axis_y;
  vec4 axis_z;
  vec4 centre;     // m
  vec3 colour;     // linear
  float roughness;
  uint shape;      // WEFT_SHAPE_*
  uint view;       // WEFT_VIEW_*
  float cell;      // m: the size of the floor's pattern; 0 for none
  float end;       // capsules: half the length over the radius
  float end_radius;  // capsules: the radius at the end along y, over the other's
};

#define WEFT_SHAPE_PLANE 0
#define WEFT_SHAPE_SPHERE 1
#define WEFT_SHAPE_CAPSULE 2
#define WEFT_SHAPE_BOX 3

#define WEFT_SPHERE_SLICES 96
#define WEFT_SPHERE_STACKS 48

struct Cloth {
  vec3 colour;     // linear, multiplies the albedo map
  float roughness; // multiplies the roughness map
  vec2 repeat;
  float metallic;
  float transmission;
  uint view;       // WEFT_VIEW_*
  float cutoff;    // what has less alpha is not there
};

#ifdef __cplusplus
static_assert(sizeof(Frame) == 2 * 64 + 4 * 16 + 6 * 16 + 3 * 16);
static_assert(sizeof(Solid) == 100);
static_assert(sizeof(Cloth) == 40);
}  // namespace weft::shading
#endif
#endif
