// slide_apply: what contact_slide_apply does for particle i. Needs motion/displacement_bound.glsl, reaction/mesh.glsl ITERATE(i) and
// MOVE(i, to).

void slide_along(uint i) {
  const uvec3 up = slides[2 * i].xyz, down = slides[2 * i + 1].xyz;
  if ((up | down) == uvec3(0)) return;
  slides[2 * i + 1] = uvec4(0, 0, 0, max(slides[2 * i].w, slides[2 * i + 1].w));
  slides[2 * i] = uvec4(0);
  const vec4 at = ITERATE(i);
  const vec3 before = at.xyz, asked = before + uintBitsToFloat(up) - uintBitsToFloat(down);
  const vec3 end = keep_within_bound(bound_of(i), expected_of(i, detection[0].steps), FETCH(positions, i).xyz, asked);
  MOVE(i, vec4(end, at.w));
  if (first_mesh_body > 0) tell_touched_mesh(i, end - before, end, FETCH(positions, i).w);
}
