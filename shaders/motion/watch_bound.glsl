// watch_bound: asks for a detection where a particle ends a substep off its predicted trajectory, or its prediction is about to leave it
// (displacement_bound.glsl). The predictions of anchors are known to the anchor pass alone, which watches them. Needs detection.

#include "motion/displacement_bound.glsl"

bool is_off(vec3 end, vec3 expected, float bound) {
  const vec3 off = end - expected;
  return !(dot(off, off) <= bound * bound);
}

// A displacement bound of 0, of a particle with an overflowed candidate, asks for the next detection at once. At a frame's end there is no
// prediction yet: the next frame's is watched by predict.comp.
void watch_bound(float bound, Expected expected, vec3 end, vec3 prediction) {
  const bool predicts = (push.flags & WEFT_LAST_SUBSTEP) == 0;
  if (bound == 0 || is_off(end, expected.now, bound) || (predicts && strays(prediction, expected.next, bound)))
    detection[0].needs_detection = 1;
}
