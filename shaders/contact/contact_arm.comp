// contact_arm: how many threads the substep's contacts take, and what the last detection came to. One thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "contact/groups.glsl"

// push.count: particles.
void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const uint found = detection[0].candidates, kept = min(found, contact_settings.capacity);
  detection[0].contacts = groups_of(kept);
  detection[0].touched = groups_of(kept > 0 ? push.count : 0);
  for (uint round = 0; round < WEFT_ROUNDS - 1; ++round) detection[0].lowered[round] = 0;
  detection[0].unsafe = 0;
  for (uint kind = 0; kind < 2; ++kind) {
    detection[0].listings[kind] = 0;
    detection[0].listed[kind] = Groups(0, 1, 1);
  }
  if (detection[0].age > 0) return;
  counters[0].contacts_most = max(counters[0].contacts_most, found);
  counters[0].contacts_lost += found - kept;
}
