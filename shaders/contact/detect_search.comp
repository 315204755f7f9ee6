// detect_search: search_faces and search_edges in one dispatch, on a GPU or where detections are seldom. Threads do one or the other.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_edges)
WRITE(uvec2, near_faces)
WRITE(uvec2, near_edges)
GATHER(velocities)

#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "untangle/crossing.glsl"   // with cluster_faces
#include "contact/search_faces.glsl"
#include "contact/search_edges.glsl"

bool is_edge;

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  return is_edge ? edge_may_meet(other, m, relative, reach) : face_may_meet(other, m, relative, reach);
}
uvec2 members_of(uint cluster) { return is_edge ? edges_of(cluster) : faces_of(cluster); }
uint outline_number(uint member) { return is_edge ? number_of_edge(member) : member; }
bool can_be_pair(uint member, out uvec4 particles) {
  return is_edge ? can_pair_with_edge(member, particles) : can_pair_with_face(member, particles);
}
void put_near(uint place, uint member) {
  if (is_edge) near_edges[place] = uvec2(edge, member);
  else near_faces[place] = uvec2(vertex, member);
}

// push.count: particles and edges, in this order.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  is_edge = i >= contact_settings.particles;
  uint cluster;
  if (is_edge) {
    searching_edge(i - contact_settings.particles);
    cluster = own_cluster;
  } else {
    cluster = searching_particle(i);
  }
  const uint kind = is_edge ? of_edges : of_triangles;
  search(kind, cluster, !is_edge, false);
  end_search(kind, cluster, !is_edge);
  if (untangles && is_edge && detection[0].looks != 0) search_crossings(edge, ends, own_cluster);
}
