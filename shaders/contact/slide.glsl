// slide: what contact_slide does for an active contact. Needs contact/contact.glsl, contact/sides.glsl,
// and reaction/touched_mesh.glsl.

void ask(uint place, vec3 way) {
  if (way.x > 0) atomicMax(slides[place].x, floatBitsToUint(way.x));
  if (way.y > 0) atomicMax(slides[place].y, floatBitsToUint(way.y));
  if (way.z > 0) atomicMax(slides[place].z, floatBitsToUint(way.z));
}

// Cloth goes ahead of kinematic particles: the heights above which either side is out of the way of the other one's.
vec2 ahead_of_kinematic(Sides sides, vec4 end) {
  return sides.margin - least_of_sides(mix(vec4(1e30), end, sides.kinematic), sides.edges).yx;
}

void ask_for_ways(uint i) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (untangles && pair.separation == WEFT_UNTANGLED) return;
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + sides.displacement;
  const vec2 least = least_of_sides(end, sides.edges);
  if (least.x + least.y >= sides.least_gap) return;
  const vec2 stopping = max(stopping_heights(sides, end), ahead_of_kinematic(sides, end));
  const vec4 missing = (sides.edges ? stopping.xxyy : stopping.xyyy) + 2 * sides.rounding_error - end;
  for (int j = 0; j < 4; ++j) {
    if (sides.kinematic[j] || !(missing[j] > 0)) continue;
    const vec3 way = signs(sides.edges)[j] * missing[j] * n;
    ask(2 * pair.particle[j], way);
    ask(2 * pair.particle[j] + 1, -way);
    if (first_mesh_body > 0) touch(pair.particle[j], mesh_of(pair));
  }
}
