// contact_unsafe: lists the unsafe candidates, those that could cross at the substep's end, for contact_limit. All others, nearly all, keep
// to their own sides of the plane in the middle of their gap, whatever step fractions their particles take.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
READ_WRITE(Detection, detection)

#include "contact/contact.glsl"
#include "contact/contact_list.glsl"

// Whether every particle ends on its own side of the middle. Then it does so with any step fraction, because steps are straight. `height`:
// of the first particle over the middle, at the substep's start (m).
bool keep_to_their_sides(Candidate pair, vec3 n, float height) {
  const vec3 p[4] = vec3[4](FETCH(predicted, pair.particle[0]).xyz, FETCH(predicted, pair.particle[1]).xyz,
                            FETCH(predicted, pair.particle[2]).xyz, FETCH(predicted, pair.particle[3]).xyz);
  const float squared = dot(p[0], p[0]) + dot(p[1], p[1]) + dot(p[2], p[2]) + dot(p[3], p[3]);
  if (!(squared < 1e18)) return false;   // not finite
  const float margin = max(kMargin * pair.separation, kFloor * sqrt(squared));   // no less than contact_limit's
  const float first = height + dot(n, p[0] - FETCH(positions, pair.particle[0]).xyz);
  const vec4 heights = signs(pair.edges) * (first + n * mat4x3(vec3(0), p[1] - p[0], p[2] - p[0], p[3] - p[0]));
  return all(greaterThanEqual(heights, vec4(0.5 * margin)));
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= min(detection[0].candidates, contact_settings.capacity)) return;
  const vec4 normal = FETCH(contact_normals, i);
  const float height = -normal.w;   // not above 0 where the pair is active (contact_prepare)
  const bool safe = normal.xyz != vec3(0) && height > 0 && keep_to_their_sides(unpack_candidate(FETCH(candidates, i)), normal.xyz, height);
  if (!safe) list(WEFT_UNSAFE, i);
}
