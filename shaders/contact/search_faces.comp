// search_faces: broad phase. Every particle searches for the triangles near it (search.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_faces)
WRITE(uvec2, near_faces)
WRITE(uint, tangled_pairs)
GATHER(velocities)

#include "contact/search.glsl"
#include "contact/mask.glsl"

uint vertex;

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  const vec3 stopped = max(abs(own.trajectory), abs(other.trajectory)) * per_substep();
  return all(lessThanEqual(abs(m) * (1 - 4 * rounding), other.half_sides + abs(relative) + stopped + reach));
}

uvec2 members_of(uint cluster) { return uvec2(FETCH(clusters, cluster).x, FETCH(clusters, cluster + 1).x); }
uint outline_number(uint member) { return member; }

bool can_be_pair(uint member, out uvec4 particles) {
  const uvec3 t = FETCH(cluster_faces, member).xyz;
  particles = uvec4(vertex, t);
  bool can = !any(equal(t, uvec3(vertex)));
  if (contact_mask_words > 0) can = can && meets_other(vertex, t.x);
  return can;
}

void put_near(uint place, uint member) { near_faces[place] = uvec2(vertex, member); }

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uvec2 searcher = FETCH_UINT2(cluster_searchers, i);
  vertex = searcher.x;
  if (untangles && detection[0].looks != 0)   // search_edges fills them
    for (uint k = i; k < contact_settings.tangled_room; k += push.count) tangled_pairs[k] = 0;
  const Track track = track_of(vertex);
  const float thickness = FETCH(rest, vertex).w;
  own = Outline(track.at, vec3(0), track.trajectory, reach_of(0, sweep_of(track, thickness), thickness));
  search(of_triangles, searcher.y, true, false);
  end_search(of_triangles, searcher.y, true);
}
