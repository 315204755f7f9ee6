// stretch: distance constraints C = |p_a - p_b| - L, by XPBD (Macklin, Mueller, Chentanez 2016, eq. 18) and Jacobi in gather form: every
// particle evaluates its own links at the current iterate and writes its next one, so that no two threads write to one place. Both ends of
// a link compute the same multiplier.
//
// Masses are split (Tonge et al. 2012): particle i, in n_i links, shows each of them the inverse mass W_i = n_i w_i and takes
// the mean of their corrections: dlambda = -(C + a lambda) / ((W_a + W_b) / omega + a), dp_i = (W_i / n_i) sum grad C dlambda.
// With W_i = w_i instead the same lines are plain count-averaging, which does not conserve momentum.
//
// An iterate's w is the factor of the particle's sum: with several iterations a substep W_i, which the multipliers need too; with one,
// where links come with their gain, W_i / n_i.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER_UINT2(stretch_rows)
GATHER_UINT4(stretch_links)
READ_WRITE(vec2, stretch_lambda)
READ_WRITE(vec2, stretch_steps)
READ(Acceleration, acceleration)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"
#include "chebyshev/chebyshev.glsl"

uint coincident = 0;

// Ends at one place have no direction. They are parted along a fixed one and counted: otherwise they would stay together as long as all
// other forces on both are the same. It is oblique to all axes, so that a sheet that fell into a plane comes out of it.
const vec3 kApart = 1e-10 * vec3(0.36, 0.48, 0.8);

// The vector from particle q to particle p, and its length.
vec4 offset_between(vec3 p, vec3 q, Link link) {
  vec3 d = p - q;
  const float squared = dot(d, d);
  const bool together = squared < 1e-20 && link.rest > 0;
  coincident += uint(together);
  if (together) d = gl_GlobalInvocationID.x < link.other ? kApart : -kApart;
  return vec4(d, sqrt(squared + 1e-20));   // not max(): its handling of NaN costs the software driver 5 %
}

// The impulse of one link on the particle at p, per unit of its inverse mass, where multipliers begin at zero.
vec3 impulse(vec4 p, uvec2 packed) {
  const Link link = unpack_link(packed.x, packed.y);
  const vec4 apart = offset_between(p.xyz, FETCH(predicted, link.other).xyz, link);
  const float scale = (link.rest - apart.w) * link.response / apart.w;
  return (link.only_pulls && scale > 0 ? 0 : scale) * apart.xyz;
}

// The same with several iterations. Reads and renews the link's multiplier (x) and, with Chebyshev, its last change (y).
vec3 iterated_impulse(vec4 p, uvec2 packed, inout vec2 multiplier) {
  const Link link = unpack_link(packed.x, packed.y);
  const vec4 q = FETCH(predicted, link.other);
  const vec4 apart = offset_between(p.xyz, q.xyz, link);
  const float alpha = link.response * motion.inverse_h2;
  float change = relaxation * (link.rest - apart.w - alpha * multiplier.x) / max(p.w + q.w + relaxation * alpha, 1e-20);
  if (link.only_pulls) change = min(change, -multiplier.x);
  multiplier = advanced(multiplier, change, link.only_pulls);
  return (change / apart.w) * apart.xyz;
}

// Adds the impulses of the k-th pair of links.
void add_iterated(vec4 p, uint k, inout vec3 sum) {
  const uvec4 pair = FETCH(stretch_links, k);
  const bool first = (push.flags & WEFT_FIRST_ITERATION) != 0;
  vec2 lambda = vec2(0), step = vec2(0);
  if (!first) lambda = stretch_lambda[k];
  if (is_accelerated && !first) step = stretch_steps[k];
  vec2 a = vec2(lambda.x, step.x), b = vec2(lambda.y, step.y);
  sum += iterated_impulse(p, pair.xy, a);
  sum += iterated_impulse(p, pair.zw, b);
  stretch_lambda[k] = vec2(a.x, b.x);
  if (is_accelerated) stretch_steps[k] = vec2(a.y, b.y);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
  const uvec2 row = stretch_stride > 0 ? uvec2(i * stretch_stride, 2 * stretch_stride) : FETCH_UINT2(stretch_rows, i);
  const uint end = row.x + ((row.y + 1) >> 1);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < end; ++k) {
    if (is_iterated) {
      add_iterated(p, k, sum);
    } else {
      const uvec4 pair = FETCH(stretch_links, k);
      sum += impulse(p, pair.xy);
      sum += impulse(p, pair.zw);
    }
  }
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
  // A neighbour that is not finite must not spoil this particle.
  if (!(dot(sum, sum) < 1e20)) sum = vec3(0);
  // With several iterations multipliers have been over-relaxed already.
  const float share = is_iterated ? p.w / max(float(row.y), 1) : motion.relaxation * p.w;
  vec3 step = share * sum;
  if (has_supports) {
    const vec4 support = supports[i];
    const vec3 s = support_from(support.xyz);
    if (s != vec3(0)) supports[i].w = support.w + held_of(s, step);
    step = yields(s, step);
  }
  leave(i, vec4(p.xyz + step, p.w));
}
