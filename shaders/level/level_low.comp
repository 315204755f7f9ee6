// level_low: the levels of few nodes by one workgroup: where they are, finest first, then their steps, coarsest first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(uint, level_ends)
// This dispatch has written what it reads of these.
SHARE_GATHER(level_centres)
SHARE_GATHER(level_middles)
SHARE(vec4, level_supports)
SHARE_GATHER(level_carried)
SHARE_GATHER(level_steps)
const uint kAtOnce = 8, kLinksAtOnce = 4;
#define CENTRE_OF(k) LOAD(level_centres, k)
#define MIDDLE_OF(k) LOAD(level_middles, k)
#define PUT_OUT_OF(k) level_supports[k]
#include "support/support.glsl"
#include "level/centre.glsl"
#define CENTRE(k) LOAD(level_centres, k)
#define MIDDLE(k) LOAD(level_middles, k)
#define STEP(k) LOAD(level_steps, k)
#define CARRIED(k, node) LOAD(level_carried, k)
#define PUT_OUT(k) level_supports[k]
#include "level/level.glsl"
#include "wait.glsl"

void main() {
  const uint here = gl_LocalInvocationID.x;
  // level_centre has the finest level's.
  for (uint level = has_wide_levels ? push.count : push.count - 1; level-- > 0;) {
    for (uint k = (level == 0 ? 0 : level_ends[level - 1]) + here; k < level_ends[level]; k += workgroup) {
      const LevelPlace place = place_of(k);
      STORE(level_centres, k, vec4(place.centre, 0))
      STORE(level_middles, k, vec4(place.middle, 0))
      if (nodes_are_held) level_supports[k].xyz = place.put_out;
    }
    wait();
  }
  uint first = 0;
  for (uint level = 0; level < push.count; ++level) {
    const uint end = level_ends[level];
    for (uint k = first + here; k < end; k += workgroup) {
      const LevelNode node = unpack_level_node(FETCH(level_nodes, k));
      STORE(level_carried, k, vec4(carried_of(k, node), node.inverse_mass * float(node.links)))
    }
    wait();
    for (uint k = first + here; k < end; k += workgroup) STORE(level_steps, k, step_of(k))
    wait();
    first = end;
  }
}
