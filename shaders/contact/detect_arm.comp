// detect_arm: decides whether pairs are searched for in this substep, and how far particles may stray until the next search.
// One thread; the group counts that it leaves behind dispatch the passes of the detection, or nothing.
//
// A long leash finds more pairs, a short one asks for detections more often. The leash grows while detections follow each
// other closely, or while there are so few pairs that they cost next to nothing, and shrinks while the paths hold to their end.
//
// Particles that moved had long paths, which let many pairs meet. When nobody has left his path by its end, and the pairs are
// many, one more search with paths as short as the particles now move leaves only those that matter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

const uint too_soon = 3;   // substeps
const float grow = 1.5, shrink = 0.9, cheaply = 2;

#include "contact/groups.glsl"

// `old`: substeps since the last detection.
float reach_after(float reach, uint old) {
  if (reach <= 0) return contact_settings.reach_low;
  const bool cheap = detection[0].candidates < push.count / 4;
  if (cheap) return min(grow * reach, cheaply * contact_settings.reach_high);
  if (old < too_soon) return min(grow * reach, contact_settings.reach_high);
  if (old >= WEFT_HORIZON) return min(max(shrink * reach, contact_settings.reach_low), contact_settings.reach_high);
  return min(reach, contact_settings.reach_high);
}

// Paths lead twice as far as the last ones held: where particles are jerked about and every other substep asks for a detection, ten
// substeps' way would let half as many pairs again meet.
uint horizon_after(uint old) { return detection[0].horizon == 0 ? WEFT_HORIZON : min(2 * old, WEFT_HORIZON); }

void begin_detection(bool calm) {
  detection[0].horizon = horizon_after(detection[0].age + 1);
  detection[0].reach = reach_after(detection[0].reach, detection[0].age + 1);
  detection[0].due = 0;
  detection[0].calm = uint(calm);
  detection[0].age = 0;
  detection[0].candidates = 0;
  for (uint kind = 0; kind < 2; ++kind) detection[0].near[kind] = detection[0].levels[kind] = 0;
  for (uint k = 0; k < 2 * WEFT_LEVELS; ++k) detection[0].extents[k] = 0;
  detection[0].particles = groups_of(push.count);
  detection[0].primitives = groups_of(contact_settings.triangles + contact_settings.edges);
  detection[0].blocks = groups_of((contact_settings.slots + 7) / 8);   // eight slots a thread
  ++counters[0].detections;
}

void skip_detection() {
  detection[0].age = min(detection[0].age + 1, WEFT_HORIZON);
  const Groups none = Groups(0, 1, 1);
  detection[0].particles = none;
  detection[0].primitives = none;
  detection[0].blocks = none;
}

// push.count: particles.
void main() {
  if (gl_GlobalInvocationID.x != 0) return;
  const bool due = detection[0].due != 0;
  const bool calm = !due && detection[0].age >= WEFT_HORIZON && detection[0].calm == 0 && detection[0].candidates > push.count;
  if (due || calm) begin_detection(calm);
  else skip_detection();
}
