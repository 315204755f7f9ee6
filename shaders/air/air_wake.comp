// air_wake: how large a cloth or a mesh collider is to the wind, and where: the disc that wake.glsl takes it for. A workgroup a body, once a
// frame, where the body is when the frame begins.
//
// Let a be the area that a triangle shows to the wind, above 0 on one side of the surface and below on the other. The body shows the larger of
// the two sums of either sign, (sum |a| + |sum a|) / 2. Of a closed surface both are the same, and what faces the wind (exactly, where it is
// convex); of a sheet it is what it shows, and of one that is folded in two a single layer. The disc's middle is the mean of the triangles'
// middles, by |a|.
//
// Sums are made in a fixed order, whatever the size of a workgroup is: WEFT_WAKE_LANES lanes have every so many-th triangle each.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_UINT4(triangles)
GATHER_UINT4(wake_bodies)
WRITE(vec4, wakes)

// xyz sum of |a| times the middle (m^3), w of |a| (m^2); of a.
shared vec4 shown[WEFT_WAKE_LANES];
shared float sides[WEFT_WAKE_LANES];

void add_triangle(uint lane, uvec3 corners, vec3 way) {
  const vec3 x = FETCH(positions, corners.x).xyz, y = FETCH(positions, corners.y).xyz, z = FETCH(positions, corners.z).xyz;
  if (!(dot(x, x) + dot(y, y) + dot(z, z) < 1e12)) return;   // not finite, or so far away that its square would not be
  const float a = 0.5 * dot(cross(y - x, z - x), way);
  shown[lane] += vec4(abs(a) / 3 * (x + y + z), abs(a));
  sides[lane] += a;
}

vec4 disc_of_all() {
  vec4 all = shown[0];
  float side = sides[0];
  for (uint lane = 1; lane < WEFT_WAKE_LANES; ++lane) {
    all += shown[lane];
    side += sides[lane];
  }
  return all.w > 0 ? vec4(all.xyz / all.w, sqrt(0.5 * (all.w + abs(side)) / 3.1415927)) : vec4(0);
}

void main() {
  const uint body = gl_WorkGroupID.x;
  const uvec2 range = FETCH(wake_bodies, body).xy;
  const float speed = length(air.wind);
  const vec3 way = air.wind / max(speed, 1e-30);
  for (uint lane = gl_LocalInvocationID.x; lane < WEFT_WAKE_LANES; lane += gl_WorkGroupSize.x) {
    shown[lane] = vec4(0);
    sides[lane] = 0;
    for (uint k = lane; k < range.y; k += WEFT_WAKE_LANES) add_triangle(lane, FETCH(triangles, range.x + k).xyz, way);
  }
  barrier();
  if (gl_LocalInvocationID.x == 0) wakes[body] = disc_of_all();
}
