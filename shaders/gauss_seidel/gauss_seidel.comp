// gauss_seidel: distance constraints C = |p_a - p_b| - L by XPBD (Macklin, Mueller, Chentanez 2016, eq. 18) and Gauss-Seidel:
//     dlambda = -(C + a lambda) / ((w_a + w_b) / omega + a),   dp = +- w grad C dlambda,   a = alpha / h^2.
// A workgroup takes a patch of particles into its own memory and projects the links among them, colour after colour: no two
// links of a colour share a particle. Patches of a dispatch share none either (engine/effects/gauss_seidel/patches.cpp).
//
// A link moves both of its ends by opposite impulses along itself, so that linear momentum is conserved up to rounding; angular momentum,
// too, by turn.glsl.
// Colouring particles instead, each moved while its neighbours stand still, does not conserve momentum: a free, unevenly stretched sheet
// drifted by 7 cm in a second. Every sweep takes the colours in the same order: with one sweep a substep, alternating the order (symmetric
// Gauss-Seidel) changes the map from substep to substep, and shook a hung sheet to a strain of a quarter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ(Patch, patches)
READ(uint, patch_members)
READ(uint, patch_colour_ends)
GATHER_UINT2(patch_links)
READ_WRITE(float, patch_lambda)
READ_WRITE(Counters, counters)
GATHER_WRITE(supports)
#include "support/support.glsl"

// Of the patch's particles. A place is rounded as a float of its size is; how far a particle has gone is small, and rounded the less. Links add to
// that alone, so that a place is rounded once for all of them: rounded by each, the centre of mass walked.
shared vec4 begins[WEFT_PATCH];   // xyz: where it was when the dispatch began (m), w: inverse mass (1/kg)
shared vec3 gone[WEFT_PATCH];     // how far it has gone since (m)
shared vec4 holds[WEFT_PATCH];    // xyz: what holds it (support.glsl), w: how much of its steps in this substep is held (m)

// The change of a link's multiplier, which is renewed.
float change_of(PatchLink link, float len, float weight, inout float lambda) {
  const float alpha = link.compliance * motion.inverse_h2;
  float change = motion.relaxation * (link.rest - len - alpha * lambda) / max(weight + motion.relaxation * alpha, 1e-20);
  if (link.only_pulls) change = min(change, -lambda);
  lambda += change;
  return change;
}

// What of a step member m goes.
vec3 step_of(uint m, vec3 step) {
  if (!has_supports) return step;
  const vec3 support = holds[m].xyz;
  holds[m].w += held_of(support, step);
  return yields(support, step);
}

uint coincident = 0;   // of the thread; the software driver goes through every branch, and an atomic in each link was 2 % of the pass

void project(uint k) {
  const PatchLink link = unpack_patch_link(FETCH_UINT2(patch_links, k));
  const vec4 p = begins[link.a], q = begins[link.b];
  const vec3 p_gone = gone[link.a], q_gone = gone[link.b];
  vec3 d = (p.xyz - q.xyz) + (p_gone - q_gone);
  const float squared = dot(d, d);
  const bool together = squared < 1e-20;
  float lambda = 0;
  if (is_iterated && (push.flags & WEFT_FIRST_ITERATION) == 0) lambda = patch_lambda[k];
  // Ends at one place have no direction: as in stretch.comp. An end that is not finite must not spoil the other.
  if (together) {
    ++coincident;
    d = 1e-10 * vec3(0.36, 0.48, 0.8);
  }
  if (squared < 1e20) {
    const float len = together ? 1e-10 : sqrt(squared);
    float weight = p.w + q.w;
    if (has_supports) {
      const float taken = p.w * heaviness_along(holds[link.a].xyz, d / len) + q.w * heaviness_along(holds[link.b].xyz, d / len);
      weight -= min(taken, kMostTaken * weight);
    }
    const vec3 impulse = (change_of(link, len, weight, lambda) / len) * d;
    gone[link.a] = p_gone + step_of(link.a, p.w * impulse);
    gone[link.b] = q_gone + step_of(link.b, -q.w * impulse);
  }
  if (is_iterated) patch_lambda[k] = lambda;
}

#include "gauss_seidel/turn.glsl"

// Of its inverse mass, what a support takes of a particle that hands on momentum.
const float kAnchored = 0.1;

uint particle_of(Patch whole, uint m) { return patch_members[whole.first_member + m]; }

void main() {
  const uint here = gl_LocalInvocationID.x;
  const Patch whole = patches[push.first + gl_WorkGroupID.x];
  for (uint m = here; m < whole.members; m += workgroup) {
    begins[m] = FETCH(predicted, particle_of(whole, m));
    const vec4 support = has_supports ? FETCH(supports, particle_of(whole, m)) : vec4(0);
    if (has_supports) holds[m] = vec4(support_from(support.xyz), support.w);
    gone[m] = vec3(0);
  }
  uint begin = patch_colour_ends[whole.first_colour];
  for (uint colour = 1; colour <= whole.colours; ++colour) {
    const uint end = patch_colour_ends[whole.first_colour + colour];
    barrier();
    for (uint k = begin + here; k < end; k += workgroup) project(k);
    begin = end;
  }
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
  barrier();
  TurnSums sums = TurnSums(vec4(0), vec3(0), vec3(0), vec3(0));
  const vec3 origin = FETCH(positions, particle_of(whole, 0)).xyz;   // finite, as predictions may not be
  for (uint m = here; m < whole.members; m += workgroup) {
    const bool is_held = has_supports && dot(holds[m].xyz, holds[m].xyz) > kAnchored;
    add(sums, FETCH(positions, particle_of(whole, m)).xyz - origin, is_held ? 0 : begins[m].w, gone[m]);
  }
  sum_turns(here, sums);
  const Turn turn = turn_of_patch();
  for (uint m = here; m < whole.members; m += workgroup) {
    const uint i = particle_of(whole, m);
    const vec3 turned = cross(turn.angle, FETCH(positions, i).xyz - origin - turn.centre);
    predicted[i].xyz = begins[m].xyz + (gone[m] + turned);
    if (has_supports && holds[m].xyz != vec3(0)) supports[i].w = holds[m].w;
  }
}
