// search_arm: how many threads it takes to look closely at the pairs that were found near each other. One thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "contact/groups.glsl"

// push.count: particles.
void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const bool searched = detection[0].age == 0;
  const uint room = WEFT_NEAR * contact_settings.capacity, faces = detection[0].near[0], edges = detection[0].near[1];
  detection[0].near_faces = groups_of(searched ? min(faces, room) : 0);
  detection[0].near_edges = groups_of(searched ? min(edges, room) : 0);
  if (searched) counters[0].contacts_lost += faces - min(faces, room) + edges - min(edges, room);
}
