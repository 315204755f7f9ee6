// slide: what contact_slide does for an active contact. Needs contact/contact.glsl, contact/sides.glsl,
// and reaction/touched_mesh.glsl.

void ask(uint place, vec3 way) {
  if (way.x > 0) atomicMax(slides[place].x, floatBitsToUint(way.x));
  if (way.y > 0) atomicMax(slides[place].y, floatBitsToUint(way.y));
  if (way.z > 0) atomicMax(slides[place].z, floatBitsToUint(way.z));
}

// Particles of the higher rank do not give way to the other side: kinematic ones, and those of cloth that have to go ahead of them. If
// these gave way to cloth that has not, the kinematic ones behind them would have to wait for a crease that nobody presses flat.
vec4 ranks_of(Candidate pair, Sides sides) {
  const uint a = 2 * pair.particle[0] + 1, b = 2 * pair.particle[1] + 1, c = 2 * pair.particle[2] + 1, d = 2 * pair.particle[3] + 1;
  return mix(vec4(slides[a].w, slides[b].w, slides[c].w, slides[d].w), vec4(kKinematic), sides.kinematic);
}

bvec4 pushing_particles(Candidate pair, Sides sides) {
  const vec4 ranks = ranks_of(pair, sides);
  const vec2 of_sides = -least_of_sides(-ranks, sides.edges);
  const vec4 lead = signs(sides.edges) * (of_sides.x - of_sides.y);   // of the particle's side
  return bvec4(uvec4(sides.kinematic) | uvec4(greaterThan(ranks, vec4(0))) * uvec4(greaterThan(lead, vec4(0))));
}

// Cloth goes ahead of what pushes it: the heights above which either side is out of the way of these particles of the other one.
vec2 ahead_of(bvec4 pushing, Sides sides, vec4 end) {
  return sides.margin - least_of_sides(mix(vec4(1e30), end, pushing), sides.edges).yx;
}

void ask_for_ways(uint i) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (untangles && pair.separation == WEFT_UNTANGLED) return;
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + sides.displacement;
  const vec2 least = least_of_sides(end, sides.edges);
  if (least.x + least.y >= sides.least_gap) return;
  const bvec4 pushing = pushing_particles(pair, sides);
  const bvec2 pushed = either(pushing, sides.edges).yx;
  const vec2 stopping = max(stopping_heights(sides, end), ahead_of(pushing, sides, end));
  const vec4 missing = (sides.edges ? stopping.xxyy : stopping.xyyy) + 2 * sides.rounding_error - end;
  for (int j = 0; j < 4; ++j) {
    if (pushing[j] || !(missing[j] > 0)) continue;
    const float side = signs(sides.edges)[j];
    const vec3 way = side * missing[j] * n;
    ask(2 * pair.particle[j], way);
    ask(2 * pair.particle[j] + 1, -way);
    if (side > 0 ? pushed.x : pushed.y) slides[2 * pair.particle[j]].w = kTold;
    if (first_mesh_body > 0) touch(pair.particle[j], mesh_of(pair));
  }
}
