// settle: what a particle can do alone at the end of an iteration, fused into the last pass that relaxes it because each
// part costs less than reading the particle again: [tethers] [colliders], and after a substep's last iteration the velocity,
// the new position and the next substep's prediction. Built in four variants; a scene without tethers or colliders runs
// code that has none.
//
// A tether (long-range attachment, Kim et al. 2012) says |p - a| <= reach. Anchors do not move in a pass, so a particle can
// satisfy its tethers one after another, exactly, without averaging. The velocity is corrected by what the constraints
// changed, v += (p - prediction) / h, and not recomputed from positions, whose rounding would enter it.

#include "motion.glsl"

GATHER_WRITE(positions)
GATHER_WRITE(velocities)
GATHER(materials)

#ifdef TETHERS
GATHER_UINT4(tethers)

vec3 within_tether(uint anchor, float reach, vec3 p) {
  if (anchor == WEFT_NONE) return p;
  const vec3 a = FETCH(predicted, anchor).xyz;
  const vec3 d = p - a;
  const float squared = dot(d, d);
  return squared > reach * reach ? a + (reach / sqrt(squared)) * d : p;
}

vec3 within_tethers(uint i, vec3 p) {
  for (uint k = 0; k < push.tether_pairs; ++k) {
    const uvec4 pair = FETCH(tethers, i * push.tether_pairs + k);
    p = within_tether(pair.x, uintBitsToFloat(pair.y), p);
    p = within_tether(pair.z, uintBitsToFloat(pair.w), p);
  }
  return p;
}
#endif

#ifdef COLLIDERS
#include "collide.glsl"
READ(Collider, colliders)
layout(constant_id = WEFT_SHAPE_CONSTANT + WEFT_PLANE) const uint planes = 0;
layout(constant_id = WEFT_SHAPE_CONSTANT + WEFT_SPHERE) const uint spheres = 0;
layout(constant_id = WEFT_SHAPE_CONSTANT + WEFT_CAPSULE) const uint capsules = 0;
layout(constant_id = WEFT_SHAPE_CONSTANT + WEFT_BOX) const uint boxes = 0;

vec3 out_of_colliders(vec3 x, vec3 p, vec4 material) {
  const Visit v = Visit(push.fraction_from, push.fraction_to, x, material.z, material.y);
  for (uint k = 0; k < planes; ++k) p = out_of_plane(colliders[k], v, p);
  for (uint k = 0; k < spheres; ++k) p = out_of_sphere(colliders[planes + k], v, p);
  for (uint k = 0; k < capsules; ++k) p = out_of_capsule(colliders[planes + spheres + k], v, p);
  for (uint k = 0; k < boxes; ++k) p = out_of_box(colliders[planes + spheres + capsules + k], v, p);
  return p;
}
#endif

void finish_substep(uint i, vec3 x, vec4 p, vec4 v, float keep) {
  if (dot(p.xyz, p.xyz) < 1e20 && dot(v, v) < 1e20) {
    v.xyz += push.inverse_h * (p.xyz - predicted_position(x, v.xyz, push.h));
  } else {
    atomicAdd(counters[0].non_finite, 1);
    p.xyz = x;
    v.xyz = vec3(0);
  }
  positions[i].xyz = p.xyz;
  if ((push.flags & WEFT_LAST_SUBSTEP) == 0) {
    v.xyz = driven_velocity(v.xyz, push.gravity, keep, push.h);
    p.xyz = predicted_position(p.xyz, v.xyz, push.h);
  }
  velocities[i].xyz = v.xyz;
  relaxed[i] = p;
}

// p is the particle's iterate after the pass that this is part of.
void settle(uint i, vec4 p) {
  const bool last = (push.flags & WEFT_LAST_ITERATION) != 0;
  if (p.w == 0) {
    if (last) positions[i].xyz = p.xyz;
    relaxed[i] = p;
    return;
  }
  const vec4 x = FETCH(positions, i);
  const vec4 v = FETCH(velocities, i);
  const vec4 material = FETCH(materials, floatBitsToUint(v.w));
#ifdef TETHERS
  p.xyz = within_tethers(i, p.xyz);
#endif
#ifdef COLLIDERS
  p.xyz = out_of_colliders(x.xyz, p.xyz, material);
#endif
  if (last) finish_substep(i, x.xyz, p, vec4(v.xyz, 0), material.x);
  else relaxed[i] = p;
}
