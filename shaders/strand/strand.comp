// strand: distance constraints by XPBD (stretch.comp) and Gauss-Seidel, one thread a strand: it goes along a line of links and projects one
// after another, each with the result of the one before. Strands of a dispatch share no particle (engine/effects/strand/strands.cpp). A link
// moves both of its ends by opposite impulses along itself, so that momentum is conserved.
//
// With coarse levels the first round of the first sweep also carries its particles along with them, as level_spread would.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
GATHER_UINT(strand_starts)
GATHER_UINT2(strand_links)
READ_WRITE(float, strand_lambda)
READ_WRITE(Counters, counters)
GATHER_WRITE(supports)
#include "support/support.glsl"
#include "level/spread.glsl"

// A particle on its way: where it was, how far it has gone in this round, and its inverse mass (1/kg). Kept apart, so that a place is rounded
// once a round, and lengths not at all as places are. What holds it (support.glsl), and how much of its steps in this substep (m).
struct Walker {
  vec3 was, gone;
  float w;
  vec3 support;
  float held;
};

Walker taken(uint i) {
  const vec4 p = FETCH(predicted, i);
  Walker walker = Walker(p.xyz, vec3(0), is_iterated ? FETCH(positions, i).w : p.w, vec3(0), 0);
  const vec4 support = has_supports ? FETCH(supports, i) : vec4(0);
  walker.support = support_from(support.xyz);
  walker.held = support.w;
  const bool is_swept_again = !is_iterated && (push.flags & WEFT_FIRST_ITERATION) == 0;   // levels have been asked once
  if (has_levels && push.first == 0 && !is_swept_again) walker.gone = spread(i, support.xyz, walker.support, walker.held);
  return walker;
}

void move(inout Walker walker, vec3 impulse) {
  const vec3 step = walker.w * impulse;
  walker.gone += yields(walker.support, step);
  walker.held += held_of(walker.support, step);
}

// Puts a particle where it has gone, and hands on what rounding leaves of its momentum (kg m): a line rounds it once, not at every particle.
vec3 put(uint i, Walker walker) {
  precise const vec3 place = walker.was + walker.gone, rounded_off = walker.gone - (place - walker.was);
  predicted[i].xyz = place;
  if (has_supports && walker.support != vec3(0)) supports[i].w = walker.held;
  return walker.w > 0 && dot(rounded_off, rounded_off) < 1 ? rounded_off / walker.w : vec3(0);   // not if it is not finite
}

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint s = push.first + gl_GlobalInvocationID.x;
  uint i = FETCH_UINT(strand_starts, s);
  Walker here = taken(i);
  uint k = WEFT_STRAND_LINKS * push.first + gl_GlobalInvocationID.x, coincident = 0;
  for (uint passed = 0; passed < WEFT_STRAND_LINKS; ++passed, k += push.count) {
    const uvec2 packed = FETCH_UINT2(strand_links, k);
    const Link link = unpack_link(packed.x, packed.y);
    if (link.rest == 0) break;
    Walker there = taken(link.other);
    vec3 d = (here.was - there.was) + (here.gone - there.gone);
    const float squared = dot(d, d);
    // Ends at one place have no direction: as in stretch.comp. An end that is not finite must not spoil the other.
    if (squared < 1e-20) {
      ++coincident;
      d = 1e-10 * vec3(0.36, 0.48, 0.8);
    }
    const float len = sqrt(max(squared, 1e-20));
    float taken = 0;   // of the link's inverse mass
    if (has_supports)
      taken = min(here.w * heaviness_along(here.support, d / len) + there.w * heaviness_along(there.support, d / len),
                  kMostTaken * (here.w + there.w));
    float change = (link.rest - len) * (has_supports ? link.response / (1 - link.response * taken) : link.response);
    if (is_iterated) {
      const float alpha = link.response * motion.inverse_h2, lambda = (push.flags & WEFT_FIRST_ITERATION) != 0 ? 0 : strand_lambda[k];
      change = (link.rest - len - alpha * lambda) / max(here.w + there.w - taken + alpha, 1e-20);
      strand_lambda[k] = lambda + change;
    }
    const vec3 impulse = squared < 1e20 ? (change / len) * d : vec3(0);
    if (has_supports) {
      move(here, impulse);
      there.gone += there.w * put(i, here);
      move(there, -impulse);
    } else {
      here.gone += here.w * impulse;
      there.gone += there.w * (put(i, here) - impulse);
    }
    here = there;
    i = link.other;
  }
  put(i, here);
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
}
