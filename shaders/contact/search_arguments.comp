// search_arguments: the dispatch arguments of the narrow phase, a thread a pair that the broad phase found. One thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "contact/groups.glsl"

// push.count: particles.
void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const bool searched = detection[0].steps == 0;
  const uint capacity = WEFT_NEAR * contact_settings.capacity, faces = detection[0].near[0], edges = detection[0].near[1];
  detection[0].near_faces = groups_of(searched ? min(faces, capacity) : 0);
  detection[0].near_edges = groups_of(searched ? min(edges, capacity) : 0);
  if (!searched) return;
  counters[0].contacts_room = max(counters[0].contacts_room, (max(faces, edges) + WEFT_NEAR - 1) / WEFT_NEAR);
  counters[0].contacts_overflowed += faces - min(faces, capacity) + edges - min(edges, capacity);
}
