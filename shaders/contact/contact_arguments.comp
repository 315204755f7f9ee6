// contact_arguments: writes the dispatch arguments of the substep's contact passes, and counts what the last detection found. One thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "contact/groups.glsl"

// push.count: particles.
void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const uint found = detection[0].candidates, stored = min(found, contact_settings.capacity);
  detection[0].contacts = groups_of(stored);
  detection[0].touched = groups_of(stored > 0 ? push.count : 0);
  for (uint pass = 0; pass < WEFT_LIMIT_PASSES - 1; ++pass) detection[0].changed[pass] = 0;
  detection[0].falls_back = 0;
  for (uint kind = 0; kind < 2; ++kind) {
    detection[0].listings[kind] = 0;
    detection[0].listed[kind] = Groups(0, 1, 1);
  }
  if (detection[0].steps > 0) return;
  counters[0].contacts_most = max(counters[0].contacts_most, found);
  // Of pairs that the broad phase found there is room for WEFT_NEAR times as many, of either kind.
  const uint most = WEFT_NEAR * contact_settings.capacity, faces = detection[0].near[0], edges = detection[0].near[1];
  const uint near = (max(faces, edges) + WEFT_NEAR - 1) / WEFT_NEAR;
  counters[0].contacts_room = max(counters[0].contacts_room, max(found, near));
  counters[0].contacts_overflowed += found - stored + faces - min(faces, most) + edges - min(edges, most);
}
