// settle: what a particle can do alone at the end of an iteration, fused into the last pass that relaxes it because each
// part costs less than reading the particle again: [tethers] [colliders] and, after a substep's last iteration, its end
// [finish.glsl]. Built in variants; a scene without tethers or colliders runs code that has none. A scene with contacts
// finishes its substeps after them, in the pass settle.
//
// A tether (long-range attachment, Kim et al. 2012) says |p - a| <= reach. Anchors do not move in a pass, so a particle can
// satisfy its tethers one after another, exactly, without averaging.

#ifdef FINISH
#include "finish.glsl"
#elif defined(COLLIDERS)
GATHER(positions)
GATHER(velocities)
GATHER(materials)
#endif

#ifdef COLLIDERS
#include "colliders.glsl"
#endif

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

// p is the particle's iterate after the pass that this is part of.
void settle(uint i, vec4 p) {
#ifdef FINISH
  const bool last = (push.flags & WEFT_LAST_ITERATION) != 0;
  if (p.w == 0 && last) positions[i].xyz = p.xyz;
#endif
  if (p.w == 0) {
    relaxed[i] = p;
    return;
  }
#if defined(FINISH) || defined(COLLIDERS)
  const vec4 x = FETCH(positions, i);
  const vec4 v = FETCH(velocities, i);
  const vec4 material = FETCH(materials, floatBitsToUint(v.w));
#endif
#ifdef TETHERS
  p.xyz = within_tethers(i, p.xyz);
#endif
#ifdef COLLIDERS
  p.xyz = out_of_colliders(x.xyz, p.xyz, material);
#endif
#ifdef ACCELERATED
  iterates[3 * i + 1] = vec4(p.xyz, 0);
#endif
#ifdef FINISH
  if (last) p = finish_substep(i, x.xyz, p, v.xyz, material.x);
#endif
  relaxed[i] = p;
}
