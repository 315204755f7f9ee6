// stretch: distance constraints C = |p_a - p_b| - L, by XPBD (Macklin, Mueller, Chentanez 2016, eq. 18) and Jacobi in gather
// form: every particle evaluates its own links from the current iterate and writes the next one, so that no two threads
// write to one place. Both ends of a link compute the same multiplier.
//
// Masses are split (Tonge et al. 2012): particle i, in n_i links, shows each of them the inverse mass W_i = n_i w_i and takes
// the mean of what they ask for: dlambda = -(C + a lambda) / ((W_a + W_b) / omega + a), dp_i = (W_i / n_i) sum grad C dlambda.
// With W_i = w_i instead the same lines are plain count-averaging, which does not conserve momentum.
//
// An iterate's w is what the particle takes of the sum: W_i, from which the multipliers follow too, with several iterations a
// substep; with one, in which links come with their gain, W_i / n_i.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER_UINT2(stretch_rows)
GATHER_UINT4(stretch_links)
#ifdef ITERATED
READ_WRITE(vec2, stretch_lambda)
#endif
#ifdef ACCELERATED
READ_WRITE(vec2, stretch_steps)
READ(Acceleration, acceleration)
#endif
WRITE(vec4, relaxed)
READ_WRITE(Counters, counters)

layout(push_constant, scalar) uniform Constants { Push push; };

#ifdef SETTLE
#include "settle.glsl"
#endif

#ifdef ACCELERATED
#include "accelerate.glsl"
#elif defined(ITERATED)
float omega = push.relaxation;
vec2 advanced(vec2 multiplier, float change, bool only_pulls) { return vec2(multiplier.x + change, 0); }
#endif

#ifndef ITERATED
layout(constant_id = WEFT_STRIDE_CONSTANT) const uint stride = 0;
#endif

uint coincident = 0;

// The impulse of one link on the particle at p, per unit of its inverse mass. Its multiplier (x), and with Chebyshev what that last
// changed by (y), are read and renewed.
// Ends at one place have no direction. They take the same one, away from each other, and are counted: left alone they would stay together
// as long as everything else does the same to both. It is askew to all axes, so that what fell into a plane comes out of it.
const vec3 kApart = 1e-10 * vec3(0.36, 0.48, 0.8);

vec3 impulse(vec4 p, uvec2 packed, inout vec2 multiplier) {
  const Link link = unpack_link(packed.x, packed.y);
  const vec4 q = FETCH(predicted, link.other);
  vec3 d = p.xyz - q.xyz;
  const float squared = dot(d, d);
  const bool together = squared < 1e-20 && link.rest > 0;
  coincident += uint(together);
  if (together) d = gl_GlobalInvocationID.x < link.other ? kApart : -kApart;
  const float len = sqrt(squared + 1e-20);   // not max(): its care for NaN costs the software driver 5 %
#ifdef ITERATED
  const float alpha = link.response * push.inverse_h2;
  float change = omega * (link.rest - len - alpha * multiplier.x) / max(p.w + q.w + omega * alpha, 1e-20);
  if (link.only_pulls) change = min(change, -multiplier.x);
  multiplier = advanced(multiplier, change, link.only_pulls);
  return (change / len) * d;
#else
  const float scale = (link.rest - len) * link.response / len;
  return (link.only_pulls && scale > 0 ? 0 : scale) * d;
#endif
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
#ifdef ITERATED
  const uvec2 row = FETCH_UINT2(stretch_rows, i);
  const float share = p.w / max(float(row.y), 1);   // multipliers have been over-relaxed already
#else
  const uvec2 row = stride > 0 ? uvec2(i * stride, 2 * stride) : FETCH_UINT2(stretch_rows, i);
  const float share = push.relaxation * p.w;
#endif
  const uint end = row.x + ((row.y + 1) >> 1);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < end; ++k) {
    const uvec4 pair = FETCH(stretch_links, k);
    vec2 lambda = vec2(0), step = vec2(0);
#ifdef ITERATED
    const bool first = (push.flags & WEFT_FIRST_ITERATION) != 0;
    if (!first) lambda = stretch_lambda[k];
#endif
#ifdef ACCELERATED
    if (!first) step = stretch_steps[k];
#endif
    vec2 a = vec2(lambda.x, step.x), b = vec2(lambda.y, step.y);
    sum += impulse(p, pair.xy, a);
    sum += impulse(p, pair.zw, b);
#ifdef ITERATED
    stretch_lambda[k] = vec2(a.x, b.x);
#endif
#ifdef ACCELERATED
    stretch_steps[k] = vec2(a.y, b.y);
#endif
  }
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
  // A neighbour that is lost must not take this particle along.
  if (!(dot(sum, sum) < 1e20)) sum = vec3(0);
  const vec4 next = vec4(p.xyz + share * sum, p.w);
#ifdef SETTLE
  settle(i, next);
#else
  relaxed[i] = next;
#endif
}
