// unsafe: what contact_unsafe asks of candidate i. Needs contact/contact.glsl and ITERATE(i).

// Whether every particle ends on its own side of the middle. Then it does so with any step fraction, because steps are straight. `height`:
// of the first particle over the middle, at the substep's start (m).
bool keep_to_their_sides(Candidate pair, vec3 n, float height) {
  const vec3 p[4] = vec3[4](ITERATE(pair.particle[0]).xyz, ITERATE(pair.particle[1]).xyz,
                            ITERATE(pair.particle[2]).xyz, ITERATE(pair.particle[3]).xyz);
  const float squared = dot(p[0], p[0]) + dot(p[1], p[1]) + dot(p[2], p[2]) + dot(p[3], p[3]);
  if (!(squared < 1e18)) return false;   // not finite
  const float rounding = kFloor * sqrt(squared);
  const float margin = max(kMargin * pair.separation, rounding) + rounding;   // more than contact_limit's and contact_slide's
  const float first = height + dot(n, p[0] - FETCH(positions, pair.particle[0]).xyz);
  const vec4 heights = signs(pair.edges) * (first + n * mat4x3(vec3(0), p[1] - p[0], p[2] - p[0], p[3] - p[0]));
  return all(greaterThanEqual(heights, vec4(0.5 * margin)));
}

bool is_unsafe(uint i) {
  const vec4 normal = FETCH(contact_normals, i);
  // Not above 0 where the sides touch.
  const float height = normal.w > 0 ? FETCH(contact_weights, i).x : -normal.w;
  if (untangles && unpack_candidate(FETCH(candidates, i)).separation == WEFT_UNTANGLED) return false;   // it is meant to cross
  return normal.xyz == vec3(0) || height <= 0 || !keep_to_their_sides(unpack_candidate(FETCH(candidates, i)), normal.xyz, height);
}
