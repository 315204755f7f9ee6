// parting: a normal along which the sides of a pair are apart where its steps end. contact_prepare's parts them where they begin; a triangle
// that is pushed at one corner turns, and seems to be in the way of what pushes it. Steps are straight: whoever ends on his side of a plane
// across some normal, and began there, has stayed there. Needs contact/proximity.glsl, contact/sides.glsl and ITERATE(i).

// Of the separation. Sides that end nearer to each other have no room in the next substep, and then wait for each other: there the step is
// rather cut.
const float kParted = 0.5;

// The gap along n where the steps begin or where they end, whichever is less (m).
float gap_throughout(vec3 n, mat4x3 x, mat4x3 p, bool edges) { return min(separation(n, x, edges), separation(n, p, edges)); }

// n, unless the direction between the closest points at the end, or that half-way to it, parts the sides better, and by enough.
vec3 parting_normal(Candidate pair, vec3 n) {
  const uint i = pair.particle[0], j = pair.particle[1], k = pair.particle[2], l = pair.particle[3];
  const vec3 a = FETCH(positions, i).xyz, b = FETCH(positions, j).xyz, c = FETCH(positions, k).xyz, d = FETCH(positions, l).xyz;
  const mat4x3 x = mat4x3(vec3(0), b - a, c - a, d - a);
  const mat4x3 p = x + mat4x3(step_of(a, ITERATE(i).xyz), step_of(b, ITERATE(j).xyz), step_of(c, ITERATE(k).xyz), step_of(d, ITERATE(l).xyz));
  const vec3 between = offset(closest_of_pair(p, pair.edges), p[0], p[1], p[2], p[3]);
  const vec3 last = between / max(length(between), 1e-30), middle = (n + last) / max(length(n + last), 1e-30);
  const float at_last = gap_throughout(last, x, p, pair.edges), at_middle = gap_throughout(middle, x, p, pair.edges);
  if (max(kParted * pair.separation, gap_throughout(n, x, p, pair.edges)) >= max(at_last, at_middle)) return n;
  return at_last > at_middle ? last : middle;
}
