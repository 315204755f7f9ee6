// limit: what contact_limit does for an unsafe candidate in one of its passes. Needs contact/contact.glsl,
// contact/sides.glsl, reaction/touched_mesh.glsl and ITERATE(i).

const uint kLastPass = WEFT_LIMIT_PASSES - 1;
// The step fraction of particle i after the passes before this one.
float fraction_before(uint i, uint pass) {
  uint least = 0x3f800000u;   // 1.0; positive floats are ordered like their bits
  for (uint r = 0; r < pass; ++r) least = min(least, step_fractions[i][r]);
  return uintBitsToFloat(least);
}

// Stage 4: the step fractions at which particles reach the planes at these heights, their times of impact; 1 for those that do not.
// Kinematic particles take at least the fraction that they must.
vec4 truncated_fractions(Sides sides, vec2 stopping) {
  const vec4 bound = sides.edges ? stopping.xxyy : stopping.xyyy;
  const vec4 impact = clamp((sides.height - bound) / max(-sides.displacement, vec4(1e-30)), sides.least_fraction, vec4(1));
  const bvec4 ends_beyond = lessThan(sides.height + sides.displacement, bound);
  const bvec4 approaches = lessThan(sides.displacement, vec4(sides.rounding_error));
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j) t[j] = ends_beyond[j] && approaches[j] ? impact[j] : 1;
  return t;
}

// Stage 5.
void lower_fractions(Candidate pair, uint pass, vec4 t, vec4 before) {
  for (int j = 0; j < 4; ++j)
    if (t[j] < before[j]) {
      atomicMin(step_fractions[pair.particle[j]][pass], floatBitsToUint(t[j]));
      if (first_mesh_body > 0) touch(pair.particle[j], mesh_of(pair));
    }
  if (pass < kLastPass && any(lessThan(t, before))) atomicOr(detection[0].changed[pass], 1);
}

// Sides that touch or overlap at the start have no normal, hence no planes: their particles stay, except kinematic ones.
void hold_in_place(Candidate pair) {
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j)
    if (FETCH(positions, pair.particle[j]).w > 0) t[j] = 0;
  lower_fractions(pair, 0, t, vec4(1));
}

void limit_pair(Candidate pair, vec3 n, uint pass) {
  vec4 before;
  for (int j = 0; j < 4; ++j) before[j] = fraction_before(pair.particle[j], pass);
  // Nothing has changed for this pair since the first pass.
  if (pass > 0 && pass < kLastPass && before == vec4(1)) return;
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + before * sides.displacement;
  const vec2 least = least_of_sides(end, sides.edges);
  const bool crosses = least.x + least.y < sides.least_gap;
  if (pass < kLastPass) {
    if (crosses) lower_fractions(pair, pass, truncated_fractions(sides, stopping_heights(sides, end)), before);
    return;
  }
  const vec4 fallback = truncated_fractions(sides, divide_slack(sides, 0, 0));
  // A pair that crosses calls for the fallback, unless that would change nothing for it: then the others need not stop on its account.
  if (crosses && any(lessThan(fallback, before))) atomicOr(detection[0].falls_back, 1);
  if (untangles && crosses && any(greaterThan(sides.least_fraction, vec4(0)))) {   // perhaps driven through
    detection[0].may_cross = 1;
    detection[0].needs_detection = 1;
  }
  lower_fractions(pair, pass, fallback, vec4(1));
}

void limit(uint i, uint pass) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (n != vec3(0)) limit_pair(pair, n, pass);
  else if (pass == 0) hold_in_place(pair);
}
