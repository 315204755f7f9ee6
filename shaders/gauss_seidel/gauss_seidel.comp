// gauss_seidel: distance constraints C = |p_a - p_b| - L by XPBD (Macklin, Mueller, Chentanez 2016, eq. 18) and Gauss-Seidel:
//     dlambda = -(C + a lambda) / ((w_a + w_b) / omega + a),   dp = +- w grad C dlambda,   a = alpha / h^2.
// A workgroup takes a patch of particles into its own memory and projects the links among them, colour after colour: no two
// links of a colour share a particle. Patches of a dispatch share none either (engine/effects/gauss_seidel/patches.cpp).
//
// A link moves both of its ends by opposite impulses along itself, so that linear and angular momentum are conserved up to rounding.
// Colouring particles instead, each moved while its neighbours stand still, does not conserve momentum: a free, unevenly stretched sheet
// drifted by 7 cm in a second. Every sweep takes the colours in the same order: with one sweep a substep, alternating the order (symmetric
// Gauss-Seidel) changes the map from substep to substep, and shook a hung sheet to a strain of a quarter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
READ(Patch, patches)
READ(uint, patch_members)
READ(uint, patch_colour_ends)
GATHER_UINT2(patch_links)
READ_WRITE(float, patch_lambda)
READ_WRITE(Counters, counters)

shared vec4 members[WEFT_PATCH];   // xyz: where they are now (m), w: inverse mass (1/kg)

// The change of a link's multiplier, which is renewed.
float change_of(PatchLink link, float len, float weight, inout float lambda) {
  const float alpha = link.compliance * motion.inverse_h2;
  float change = motion.relaxation * (link.rest - len - alpha * lambda) / max(weight + motion.relaxation * alpha, 1e-20);
  if (link.only_pulls) change = min(change, -lambda);
  lambda += change;
  return change;
}

void project(uint k) {
  const PatchLink link = unpack_patch_link(FETCH_UINT2(patch_links, k));
  vec4 p = members[link.a], q = members[link.b];
  vec3 d = p.xyz - q.xyz;
  const float squared = dot(d, d);
  const bool together = squared < 1e-20;
  float lambda = 0;
  if (is_iterated && (push.flags & WEFT_FIRST_ITERATION) == 0) lambda = patch_lambda[k];
  // Ends at one place have no direction: as in stretch.comp. An end that is not finite must not spoil the other.
  if (together) {
    atomicAdd(counters[0].coincident, 1);
    d = 1e-10 * vec3(0.36, 0.48, 0.8);
  }
  if (squared < 1e20) {
    const float len = together ? 1e-10 : sqrt(squared);
    const vec3 impulse = (change_of(link, len, p.w + q.w, lambda) / len) * d;
    members[link.a].xyz = p.xyz + p.w * impulse;
    members[link.b].xyz = q.xyz - q.w * impulse;
  }
  if (is_iterated) patch_lambda[k] = lambda;
}

void main() {
  const Patch whole = patches[push.first + gl_WorkGroupID.x];
  for (uint m = gl_LocalInvocationID.x; m < whole.members; m += workgroup)
    members[m] = FETCH(predicted, patch_members[whole.first_member + m]);
  uint begin = patch_colour_ends[whole.first_colour];
  for (uint colour = 1; colour <= whole.colours; ++colour) {
    const uint end = patch_colour_ends[whole.first_colour + colour];
    barrier();
    for (uint k = begin + gl_LocalInvocationID.x; k < end; k += workgroup) project(k);
    begin = end;
  }
  barrier();
  for (uint m = gl_LocalInvocationID.x; m < whole.members; m += workgroup)
    predicted[patch_members[whole.first_member + m]] = members[m];
}
