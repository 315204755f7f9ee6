// pressure_volume: the volume of closed cloth, and by how much each particle changes it. A workgroup a part of a cloth.
//
// The volume within triangles (a, b, c) is that of the tetrahedra between them and any point, the sum of a . (b x c) / 6 (the divergence
// theorem). Its gradient by a particle is the sum of b x c / 6 over the triangles about it, and since it is of the third degree, the
// volume is a third of the sum of x . grad. So each particle gathers its ring once, and all is there: the sums of x . grad / 3, now and
// where the substep would end, and of w |grad|^2. Places are relative to the cloth's first particle, and the ring's to the particle
// itself: what is far from the origin is no less precise.
//
// Sums are made in a fixed order: a thread's particles, a workgroup's threads, and in the pass `pressure` the parts.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT2(gas_rows)
GATHER_UINT4(gas_rings)
READ(Gas, gases)
READ(GasPart, gas_parts)
READ(GasState, gas_states)
WRITE(vec4, gas_gradients)
WRITE(GasSum, gas_sums)

#include "pressure/sum.glsl"

// Sums over a particle's ring: gradients, times 6, of the volume now and of the predicted one.
vec3 x, p, now, next, x_before, p_before;

void go_on_to(uint particle) {
  const vec3 x_there = FETCH(positions, particle).xyz - x, p_there = FETCH(predicted, particle).xyz - p;
  now += cross(x_before, x_there);
  next += cross(p_before, p_there);
  x_before = x_there;
  p_before = p_there;
}

void go_round(uint row) {
  now = next = x_before = p_before = vec3(0);
  const uvec2 ring = FETCH_UINT2(gas_rows, row);
  for (uint k = ring.x; k < ring.x + ring.y; ++k) {
    const uvec4 four = FETCH(gas_rings, k);
    go_on_to(four.x);
    go_on_to(four.y);
    go_on_to(four.z);
    go_on_to(four.w);
  }
}

void main() {
  const GasPart part = gas_parts[gl_WorkGroupID.x];
  const uint origin = gases[part.gas].particle;
  const vec3 x_origin = FETCH(positions, origin).xyz, p_origin = FETCH(predicted, origin).xyz;
  vec4 sum = vec4(0);
  for (uint k = gl_LocalInvocationID.x; k < part.count; k += gl_WorkGroupSize.x) {
    const vec4 place = FETCH(positions, part.particle + k);
    x = place.xyz;
    p = FETCH(predicted, part.particle + k).xyz;
    go_round(part.first + k);
    const vec3 gradient = next / 6;
    const float squared = dot(gradient, gradient);
    gas_gradients[part.first + k] = vec4(gradient, 0);
    sum = joined(sum, vec4(dot(now, x - x_origin) / 18, dot(next, p - p_origin) / 18, place.w * squared, place.w * sqrt(squared)));
  }
  sum = sum_of_group(sum);
  if (gl_LocalInvocationID.x == 0) gas_sums[gl_WorkGroupID.x] = GasSum(sum.x, sum.y, sum.z, sum.w, gas_states[part.gas]);
}
