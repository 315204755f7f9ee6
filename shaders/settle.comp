// settle: what a particle can do alone at the end of an iteration, fused into one pass because each part costs less than
// reading the particle: [tethers] [colliders], and after a substep's last iteration the velocity, the new position and the
// next substep's prediction. Built in four variants; a scene without tethers or colliders runs code that has none.
//
// A tether (long-range attachment, Kim et al. 2012) says |p - a| <= reach. Anchors do not move, so a particle can satisfy
// its tethers one after another, exactly, without averaging. The velocity is corrected by what the constraints changed,
// v += (p - prediction) / h, and not recomputed from positions, whose rounding would enter it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion.glsl"

READ_WRITE(vec4, positions)
READ_WRITE(vec4, velocities)
READ_WRITE(vec4, predicted)
READ(Material, materials)
READ_WRITE(Counters, counters)
layout(push_constant, scalar) uniform Constants { Push push; };

#ifdef TETHERS
READ(Tether, tethers)

vec3 within_tethers(uint i, vec3 p) {
  for (uint k = 0; k < push.tethers_per_particle; ++k) {
    const Tether tether = tethers[i * push.tethers_per_particle + k];
    if (tether.anchor == WEFT_NONE) break;
    const vec3 anchor = predicted[tether.anchor].xyz;
    const vec3 d = p - anchor;
    const float squared = dot(d, d);
    if (squared > tether.reach * tether.reach) p = anchor + (tether.reach / sqrt(squared)) * d;
  }
  return p;
}
#endif

#ifdef COLLIDERS
#include "collide.glsl"
READ(Collider, colliders)

vec3 out_of_colliders(vec3 x, vec3 p, Material material) {
  for (uint k = 0; k < push.colliders; ++k) p = out_of_collider(colliders[k], push.fraction_from, push.fraction_to, x, p, material);
  return p;
}
#endif

void finish_substep(uint i, vec3 x, vec3 p, vec3 v, Material material) {
  const bool finite = dot(p, p) < 1e20 && dot(v, v) < 1e20;
  if (finite) {
    v += push.inverse_h * (p - predicted_position(x, v, push.h));
  } else {
    atomicAdd(counters[0].non_finite, 1);
    p = x;
    v = vec3(0);
  }
  positions[i].xyz = p;
  if ((push.flags & WEFT_LAST_SUBSTEP) == 0) {
    v = driven_velocity(v, push.gravity, material.keep, push.h);
    predicted[i].xyz = predicted_position(p, v, push.h);
  } else {
    predicted[i].xyz = p;
  }
  velocities[i].xyz = v;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = positions[i];
  vec3 p = predicted[i].xyz;
  const bool last = (push.flags & WEFT_LAST_ITERATION) != 0;
  if (x.w == 0) {
    if (last) positions[i].xyz = p;
    return;
  }
  const vec4 v = velocities[i];
  const Material material = materials[floatBitsToUint(v.w)];
#ifdef TETHERS
  p = within_tethers(i, p);
#endif
#ifdef COLLIDERS
  p = out_of_colliders(x.xyz, p, material);
#endif
  if (last) finish_substep(i, x.xyz, p, v.xyz, material);
  else predicted[i].xyz = p;
}
