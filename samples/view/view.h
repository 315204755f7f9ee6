// What the viewer's shaders are told by C++, described once for both.
#ifndef WEFT_VIEW_H
#define WEFT_VIEW_H

#ifdef __cplusplus
#include <cstdint>

#include "engine/vector.h"

namespace weft::view {
using uint = std::uint32_t;
using vec2 = Vec2;
using vec3 = Vec3;
using vec4 = Vec4;
#define VIEW_INLINE inline
#else
#define VIEW_INLINE
#endif

// What a surface's colour tells.
#define VIEW_LIT 0
#define VIEW_STRAIN 1
#define VIEW_NORMALS 2
#define VIEW_ALBEDO 3
#define VIEW_NORMAL_MAP 4
#define VIEW_ROUGHNESS 5
#define VIEW_OCCLUSION 6

// One cloth, mesh collider or render mesh. Members as std430 and C++ have them alike.
struct Surface {
  vec3 colour;          // linear
  float strain;         // relative: where the colours of strain end
  vec2 repeat;
  uint first_triangle;
  uint colouring;       // VIEW_*
  uint wires;           // 1: its triangles' edges are drawn too
  uint by_index;        // 1: drawn by index, each vertex once: what belongs to a triangle is not known
};

// What lines are made of.
#define VIEW_SEGMENTS 0   // places in the world, two a line
#define VIEW_SPIKES 1     // a vertex's normal
#define VIEW_MARKS 2      // a square about a vertex

struct Lines {
  vec3 colour;          // sRGB
  float reach;          // m: of spikes
  vec2 pixel;           // of the picture: 2 over its width and height
  float width;          // pixels: of lines, half a square's side
  uint kind;            // VIEW_*
};

// Blue where a triangle is squeezed, red where it is stretched, light grey where it is as it rests. `s` from -1 to 1; sRGB.
VIEW_INLINE vec3 strain_colour(float s) {
  const float stretched = s > 0.0f ? (s < 1.0f ? s : 1.0f) : 0.0f, squeezed = s < 0.0f ? (s > -1.0f ? -s : 1.0f) : 0.0f;
#ifdef __cplusplus
  return {
#else
  return vec3(
#endif
    0.85f - 0.75f * squeezed + 0.1f * stretched, 0.85f - 0.45f * squeezed - 0.75f * stretched, 0.82f + 0.13f * squeezed - 0.72f * stretched
#ifdef __cplusplus
  };
#else
  );
#endif
}

#ifdef __cplusplus
static_assert(sizeof(Surface) == 40 && sizeof(Lines) == 32);
}  // namespace weft::view
#endif
#endif
