// spring: mass-spring cloth (Provot 1995) by symplectic Euler, forces gathered:
//     v' = v + h (g + w f(x, v)),   x' = x + h v'.
// The prediction has v + h g in it already, so that forces add h^2 w f to it; the velocity follows from where the particle ends
// (update_velocity.glsl), as with constraints. Verlet's x(t + h) = 2 x(t) - x(t - h) + h^2 w f is the same with
// v = (x(t) - x(t - h)) / h: one shader.
//
// Forces are taken at the substep's start, so h has a limit, which is computed when cooking (engine/effects/spring/longest_step.cpp).
// Damping acts along the spring, on velocities that include this substep's gravity and drag; an anchor's counts as 0, unless
// the scene has pins.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER(predicted)
GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(springs)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

uint coincident = 0;

// Ends at one place are parted along a line that is oblique to all axes, as in stretch.comp.
const vec3 kApart = 1e-10 * vec3(0.36, 0.48, 0.8);

// The force (N) of a spring on the particle at x with velocity v.
vec3 force(vec3 x, vec3 v, uint other, vec4 spring) {
  vec3 d = x - FETCH(positions, other).xyz;
  const float squared = dot(d, d);
  const bool together = squared < 1e-20 && spring.x > 0;
  coincident += uint(together);
  if (together) d = gl_GlobalInvocationID.x < other ? kApart : -kApart;
  const float len = sqrt(squared + 1e-20);
  float pull = spring.y * (len - spring.x);
  if (has_damping && !together) pull += spring.z * dot(v - FETCH(velocities, other).xyz, d) / len;
  if (spring.w != 0 && len < spring.x) pull = 0;
  return (-pull / len) * d;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i), x = FETCH(positions, i);
  const vec3 v = has_damping ? FETCH(velocities, i).xyz : vec3(0);
  const uvec2 row = FETCH_UINT2(spring_rows, i);
  vec3 sum = vec3(0);
  for (uint q = row.x; q < row.x + row.y; ++q) {
    const uvec4 ends = FETCH(spring_ends, q);
    sum += force(x.xyz, v, ends.x, FETCH(springs, 4 * q));
    sum += force(x.xyz, v, ends.y, FETCH(springs, 4 * q + 1));
    sum += force(x.xyz, v, ends.z, FETCH(springs, 4 * q + 2));
    sum += force(x.xyz, v, ends.w, FETCH(springs, 4 * q + 3));
  }
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
  // A neighbour that is not finite must not spoil this particle.
  if (!(dot(sum, sum) < 1e20)) sum = vec3(0);
  next_iterate[i] = vec4(p.xyz + (motion.h * motion.h * p.w) * sum, p.w);   // w: heavier where a hand pulls
}
