// search_faces: broad phase. Every particle searches for the triangles near it (search.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
READ_WRITE(uint, displacement_bounds)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_faces)
WRITE(uvec2, near_faces)
GATHER(velocities)

#include "contact/track.glsl"
#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "contact/groups.glsl"
#include "contact/rare.glsl"
#include "contact/ask_to_hold.glsl"

#include "contact/search_faces.glsl"

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) { return face_may_meet(other, m, relative, reach); }
uvec2 members_of(uint cluster) { return faces_of(cluster); }
uint outline_number(uint member) { return member; }
bool can_be_pair(uint member, out uvec4 particles) { return can_pair_with_face(member, particles); }
void put_near(uint place, uint member) { near_faces[place] = uvec2(vertex, member); }

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uint cluster = searching_particle(i);
  const NearList near = list_of(cluster);
  if (!near.every_one) search_listed(of_triangles, cluster, near, true, false);
  end_search(of_triangles);
  if (overflowed != 0) ask_to_hold(uvec2(vertex));
}
