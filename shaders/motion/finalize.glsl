// finalize: what a particle can do alone at the end of an iteration: [tethers] [colliders] and, after a substep's last iteration, the
// velocity update. Fused into the last pass that moves the particle, because each part costs less than reading the particle again, and
// specialised to the parts that the scene has. A scene with contacts ends its substeps after them, in the pass contact_finalize.
//
// `predicted` is the iterate at hand and `next_iterate` the next; the host swaps them after a pass that changes iterates.
//
// Needs predicted, next_iterate and counters.

#include "motion/update_velocity.glsl"
#include "collide/colliders.glsl"
#include "tether/tether.glsl"

READ_WRITE(vec4, chebyshev_iterates)

// p is the particle's iterate after the pass that this is part of.
void finalize(uint i, vec4 p) {
  const bool last = !has_contacts && (push.flags & WEFT_LAST_ITERATION) != 0;
  if (p.w == 0) {
    if (last) positions[i].xyz = p.xyz;
    next_iterate[i] = p;
    return;
  }
  const vec4 x = FETCH(positions, i);
  const vec4 v = FETCH(velocities, i);
  const vec4 material = FETCH(materials, floatBitsToUint(v.w));
  if (tether_pairs > 0) p.xyz = within_tethers(i, p.xyz);
  if (has_colliders) p.xyz = out_of_colliders(x.xyz, p.xyz, material);
  if (is_accelerated) chebyshev_iterates[3 * i + 1] = vec4(p.xyz, 0);
  if (last) p = update_velocity(i, x.xyz, p, v.xyz, material.x);
  next_iterate[i] = p;
}

// Stores particle i's next iterate p, and ends the iteration if this pass is the last of it.
void leave(uint i, vec4 p) {
  if (finalizes) finalize(i, p);
  else next_iterate[i] = p;
}
