// end_substep: what contact_finalize does for particle i, which has candidates. Needs motion/update_velocity.glsl, motion/watch_bound.glsl,
// reaction/mesh.glsl, step_fractions, contact_counts, contact_sums, Detection, Counters, ITERATE(i) and
// MOVE(i, to).

const uint kOne = 0x3f800000u;   // 1.0

// The step fraction of particle i: the least of all that contact_limit found. Resets its entries for the next substep.
float fraction_of(uint i) {
  if (contact_counts[i] != 0) {
    contact_counts[i] = 0;
    slides[2 * i + 1].w = 0;
  }
  const uvec4 fractions = step_fractions[i];
  if (detection[0].falls_back == WEFT_ALL_WAIT) return 0;
  if (fractions == uvec4(kOne)) return 1;
  step_fractions[i] = uvec4(kOne);
  return uintBitsToFloat(min(min(fractions.x, fractions.y), min(fractions.z, fractions.w)));
}

// Where the substep's step from x to p, the last iterate, ends.
vec3 allowed(uint i, vec3 x, vec3 p) {
  const float fraction = fraction_of(i);
  if (fraction == 1) return p;
  atomicAdd(counters[0].truncated, 1);
  return x + fraction * (p - x);
}

// A kinematic particle goes to its target, or as far as contact_limit lets it: then it goes on from there in the next substep.
void move_kinematic(uint i, vec3 x, vec3 target) {
  const vec3 end = allowed(i, x, target);
  if (end != target && is_off(end, expected_of(i, detection[0].steps).now, bound_of(i))) detection[0].needs_detection = 1;
  positions[i].xyz = end;
}

// What the particle lost alone, what rounding left of its corrections with it, is a mesh collider's, if it has touched one
// (reaction/mesh.glsl). Both are forgotten then.
void settle(uint i, vec3 before, vec3 after) {
  const ivec4 left = contact_sums[i];
  if (left == ivec4(0)) return;
  if (first_mesh_body > 0) tell_touched_mesh(i, after - before - contact_settings.quantum * vec3(left.xyz), after, FETCH(positions, i).w);
  contact_sums[i] = ivec4(0);
}

void end_substep(uint i) {
  vec4 p = ITERATE(i);
  const vec3 x = FETCH(positions, i).xyz;
  if (p.w == 0) {
    if (first_mesh_body > 0) contact_sums[i].w = 0;
    move_kinematic(i, x, p.xyz);
    return;
  }
  const vec4 v = FETCH(velocities, i);
  const vec3 end = allowed(i, x, p.xyz);
  settle(i, p.xyz, end);
  p.xyz = end;
  p = update_velocity(i, x, p, vec3(0), v.xyz, FETCH(materials, floatBitsToUint(v.w)).x);
  watch_bound(bound_of(i), expected_of(i, detection[0].steps), end, p.xyz);
  MOVE(i, p);
}
