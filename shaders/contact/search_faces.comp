// search_faces: broad phase. Every particle searches for the triangles near it (search.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(triangles)
WRITE(uvec2, near_faces)

#include "contact/search.glsl"

uint vertex;

bool may_meet(vec3 m, vec3 half_sides, float slack) { return all(lessThanEqual(abs(m), half_sides + slack)); }

uvec4 particles_with(uint primitive) {
  const uvec3 t = FETCH(triangles, primitive).xyz;
  return any(equal(t, uvec3(vertex))) ? uvec4(WEFT_NONE) : uvec4(vertex, t);
}

void put_near(uint place, uint primitive) { near_faces[place] = uvec2(vertex, primitive); }

// push.count: particles.
void main() {
  vertex = gl_GlobalInvocationID.x;
  if (vertex >= push.count) return;
  const Track track = track_of(vertex);
  const float thickness = FETCH(rest, vertex).w;
  const Sweep sweep = sweep_of(track, thickness);
  trajectory = vec4(track.trajectory, sweep.step);
  away = sweep.clearance + 0.5 * thickness;
  search(sweep, of_triangles, WEFT_NONE);
}
