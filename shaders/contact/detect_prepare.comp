// detect_prepare: detect_search, detect_pair and contact_prepare in one dispatch, where detections are seldom and contacts few: what a thread
// finds it tests at once, and prepares. Threads wait longer for each other than in passes of their own, in a frame in which there is
// something to find; in all others there is one dispatch instead of three. Where no detection is due it is contact_prepare.
//
// Not where something may have gone through cloth: what is tangled must be known before the first pair is tested (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
GATHER_WRITE_UINT(displacement_bounds)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
GATHER(positions)
GATHER(predicted)
GATHER(velocities)
READ_WRITE(uvec4, candidates)
// A thread has written itself what it reads of candidates; of bounds others change the bit alone that is not looked at.
#define LATEST(name, i) name[i]
#define LATEST_UINT(name, i) name[i]

#include "contact/track.glsl"
#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "contact/search_faces.glsl"
#include "contact/search_edges.glsl"
#include "contact/candidate.glsl"
#include "contact/pair.glsl"
#include "contact/pair_faces.glsl"
#include "contact/pair_edges.glsl"
#include "contact/prepare.glsl"

#include "contact/own_search.glsl"
#include "contact/search_either.glsl"

void put_near(uint place, uint member) {
  const uint i = is_edge ? pair_edge(uvec2(edge, member)) : pair_face(uvec2(vertex, member));
  if (i != WEFT_NONE) prepare(i);
}

// push.count: particles and edges, in this order.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (detection[0].searchers.x == 0) {   // no detection is due
    if (i < min(detection[0].candidates, contact_settings.capacity)) prepare(i);
  } else if (i < push.count) {
    search_either(i);
  }
}
