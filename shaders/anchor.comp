// anchor: puts every held particle where it belongs at the substep's end, on the straight way from where it was at the
// frame's start to where the scene or the host wants it at the frame's end. Recorded only in frames in which targets move.
// At the frame's end the target is taken as it is, so that it is exact to the bit; an anchor that does not move stays so.
// With contacts it also watches whether a target strays (leash.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(Anchor, anchors)
WRITE(vec4, predicted)

layout(push_constant, scalar) uniform Constants { Push push; };

#ifdef WATCH
READ_WRITE(Detection, detection)
#include "leash.glsl"
#endif

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Anchor anchor = anchors[i];
  const bool arrived = push.fraction_to == 1;
  const vec3 target = arrived ? anchor.to : anchor.from + push.fraction_to * (anchor.to - anchor.from);
  predicted[anchor.particle].xyz = target;
#ifdef WATCH
  if (strays(target, expected_at(anchor.particle, detection[0].age + 2), detection[0].reach)) detection[0].due = 1;
#endif
}
