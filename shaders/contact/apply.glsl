// apply: what contact_apply does for particle i. Needs collide/colliders.glsl, reaction/mesh.glsl,
// motion/displacement_bound.glsl, motion_constraint/motion_constraint.glsl, ITERATE(i) and MOVE(i, to).

// What rounding of the place leaves of a correction is there for the next iteration; contact_finalize forgets the last.
vec3 moved_by_contacts(uint i, vec3 p) {
  if (contact_penetrations[i] != 0) contact_penetrations[i] = 0;
  const ivec3 sum = contact_sums[i].xyz;
  if (sum == ivec3(0)) return p;
  precise const vec3 asked = contact_settings.quantum * vec3(sum), end = p + asked, rounding = (end - p) - asked;
  contact_sums[i].xyz = -ivec3(roundEven(rounding / contact_settings.quantum));
  return end;
}

void apply_corrections(uint i) {
  const vec4 before = ITERATE(i);
  vec3 p = moved_by_contacts(i, before.xyz);
  if (motion_constraints > 0) p = within_motion_constraint(i, p);
  if (has_colliders) {
    const vec4 x = FETCH(positions, i);
    const vec3 start = x.xyz + (triangles_collide > 0 ? ways_out[i].xyz : vec3(0));   // as in finalize.glsl
    p = out_of_colliders(start, p, FETCH(materials, floatBitsToUint(FETCH(velocities, i).w)), x.w);
  }
  if ((push.flags & WEFT_LAST_ITERATION) != 0) {
    const vec3 end = keep_within_bound(bound_of(i), expected_of(i, detection[0].steps), FETCH(positions, i).xyz, p);
    if (end != p) {
      atomicAdd(counters[0].truncated, 1);
      if (first_mesh_body > 0) tell_touched_mesh(i, end - p, end, FETCH(positions, i).w);
    }
    p = end;
  }
  if (p != before.xyz) MOVE(i, vec4(p, before.w));
}
