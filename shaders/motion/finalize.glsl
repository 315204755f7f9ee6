// finalize: what a particle can do alone at the end of an iteration: [tethers] [motion constraints] [colliders, and what they hold] and,
// after a substep's last iteration, the velocity update. Fused into the last pass that moves the particle, because each part costs less
// than reading the particle again, and specialised to the parts that the scene has. Where triangles collide (triangle_collide), tethers
// come before that, in the last pass of the constraints. With contacts a particle is kept within its displacement bound first, and one
// that has candidates ends its substep after these, in the pass contact_finalize.
//
// `predicted` is the iterate at hand and `next_iterate` the next; the host swaps them after a pass that changes iterates.
//
// Needs predicted, next_iterate and counters.

READ_WRITE(Detection, detection)

#include "motion/update_velocity.glsl"
#include "motion/watch_bound.glsl"
#include "collide/colliders.glsl"
#include "support/support.glsl"
#include "tether/tether.glsl"
#include "motion_constraint/motion_constraint.glsl"

READ_WRITE(vec4, chebyshev_iterates)
READ_WRITE(vec4, supports)
READ_WRITE(uint, support_bodies)
READ_WRITE(ivec4, collision_sums)
READ_WRITE(int, collision_depths)
READ_WRITE(Collisions, collisions)
WRITE(vec4, ways_out)

// What a particle's triangles ask for together (triangle_collide): out of the collider, and friction (m).
struct Asked {
  vec3 out_of, friction;
  float alike;   // 1: all one way, 1/2: half of them at right angles to the others; 0: no collider that keeps its size
  uint body;   // reactions: one of the bodies that they met, counted from 1 (triangle/bodies.glsl)
};

// |m|^2 / (mean d)^2 of three ways out at right angles. Ways that oppose each other have less:
// however long, their mean leads out of neither.
const float kLeastAlike = 1.0 / 3;

// Each triangle asks for d along its n. Their mean m is enough where all n are one. At a box's corner one triangle asks along x and the
// next along y: the mean is half of each, and cloth whose tension pulls it back rested with an edge 1 mm inside. So m is made longer, by
// (mean d)^2 / |m|^2: a simultaneous projection, extrapolated (Pierra 1984, "Decomposition through formalization in a product space").
// His own factor, mean d^2 / |m|^2, is never less, and up to that no place that all of them allow becomes further away; but by that
// cloth shivers, at three times the speed. Where no triangle tells its d (triangle_collide) the mean is taken as it is.
//
// Forgets what was asked, for the next iteration.
Asked asked_by_triangles(uint i) {
  const ivec4 sum = collision_sums[2 * i];
  if (sum.w == 0) return Asked(vec3(0), vec3(0), 0, 0);
  const float unit = WEFT_WHOLE_WEIGHT * collision_settings.quantum / float(sum.w);
  const float depths = float(collision_depths[i]), alike = depths > 0 ? dot(vec3(sum.xyz), vec3(sum.xyz)) / (depths * depths) : 1;
  const vec3 out_of = unit / clamp(alike, kLeastAlike, 1) * vec3(sum.xyz);
  const Asked asked = Asked(out_of, unit * vec3(collision_sums[2 * i + 1].xyz), depths > 0 ? alike : 0, uint(collision_sums[2 * i + 1].w));
  collision_sums[2 * i] = collision_sums[2 * i + 1] = ivec4(0);
  collision_depths[i] = 0;
  return asked;
}

// p is the particle's iterate after the pass that this is part of.
void finalize(uint i, vec4 p) {
  const bool last = (push.flags & WEFT_LAST_ITERATION) != 0;
  const uint bits = has_contacts && last ? FETCH_UINT(displacement_bounds, i) : 0;
  const bool ends = last && (bits & WEFT_PAIRED) == 0;
  if (triangles_collide > 0 && i == 0) collisions[0] = Collisions(Groups(0, 0, 0), 0);   // for the next iteration
  if (p.w == 0) {
    if (has_supports) supports[i] = vec4(0);   // it may have been pinned
    if (ends) positions[i].xyz = p.xyz;
    if (has_pins && ends) keep(i, steps_of_fall());
    next_iterate[i] = p;
    return;
  }
  const vec4 x = FETCH(positions, i);
  const vec4 v = FETCH(velocities, i);
  const vec4 material = FETCH(materials, floatBitsToUint(v.w));
  vec3 start = x.xyz;
  const vec3 solved = p.xyz;
  const vec4 support = has_supports ? supports[i] : vec4(0);
  held = held_by(support);
  if (has_supports && reacts && held != vec3(0)) {   // the collider that has put it out of late holds it
    const Particle particle = Particle(push.fraction_from, push.fraction_to, start, material.z, material.y);
    react(support_bodies[i], particle, p.xyz - held, p.xyz, x.w);
  }
  if (triangles_collide > 0) {
    // The way round a box's edge is no way into the box, nor a slip: the particle begins where its triangles put it.
    const Asked asked = asked_by_triangles(i);
    start += asked.out_of;
    const vec3 before = p.xyz;
    p.xyz += asked.out_of + asked.friction;
    put_out = clamp(2 * asked.alike - 1, 0, 1) * asked.out_of;   // between two sides of an edge nothing is held
    if (asked.out_of != vec3(0)) held = vec3(0);   // triangle_collide has rubbed by it
    if (reacts && asked.body > 0) {
      const Particle particle = Particle(push.fraction_from, push.fraction_to, start, material.z, material.y);
      p.xyz = reacted(planes + asked.body - 1, particle, before, p.xyz, x.w);
      if (put_out != vec3(0)) last_met = planes + asked.body - 1;
    }
    if (has_contacts) ways_out[i] = vec4(asked.out_of, 0);   // contact_apply puts the particle out once more
  }
  if (motion_constraints > 0) p.xyz = within_motion_constraint(i, p.xyz);
  if (has_colliders) p.xyz = out_of_colliders(start, p.xyz, material, x.w);
  if (has_supports) supports[i] = vec4(renewed(support, put_out, last), 0);
  if (has_supports && reacts && last_met != WEFT_NONE) support_bodies[i] = last_met;
  if (is_accelerated) chebyshev_iterates[3 * i + 1] = vec4(p.xyz, 0);
  if (has_contacts && last) {
    const float bound = uintBitsToFloat(bits & ~WEFT_PAIRED);
    const Expected expected = expected_of(i, detection[0].steps);
    const vec3 end = keep_within_bound(bound, expected, x.xyz, p.xyz);
    if (end != p.xyz) atomicAdd(counters[0].truncated, 1);
    p.xyz = end;
    if (ends) {
      p = update_velocity(i, x.xyz, p, vec3(0), v.xyz, material.x);
      watch_bound(bound, expected, end, p.xyz);
    }
  } else if (last) {
    p = update_velocity(i, x.xyz, p, p.xyz - solved, v.xyz, material.x);
  }
  next_iterate[i] = p;
}

// Stores particle i's next iterate p, and ends the iteration if this pass is the last of it.
void leave(uint i, vec4 p) {
  if (tether_pairs > 0 && p.w != 0) p.xyz = within_tethers(i, p.xyz);
  if (finalizes) finalize(i, p);
  else next_iterate[i] = p;
}
