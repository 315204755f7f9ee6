// limit: what contact_limit does for an unsafe candidate in one of its rounds. Needs contact/contact.glsl,
// contact/sides.glsl, reaction/touched_mesh.glsl and ITERATE(i).

// The entries of step_fractions that rounds write by turns: each reads the one before its own, and clears the next.
const uint kTurns = 3;
const uint kFallback = 3;   // the entry after them
const uint kYieldingRounds = WEFT_LIMIT_ROUNDS / 2;

vec4 fractions_before(Candidate pair, uint round) {
  const uint entry = (round + kTurns - 1) % kTurns;
  return uintBitsToFloat(uvec4(step_fractions[pair.particle[0]][entry], step_fractions[pair.particle[1]][entry],
                               step_fractions[pair.particle[2]][entry], step_fractions[pair.particle[3]][entry]));
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

// Stage 5; positive floats are ordered like their bits.
void lower_fractions(Candidate pair, uint entry, vec4 t, vec4 before) {
  for (int j = 0; j < 4; ++j)
    if (t[j] < before[j]) {
      atomicMin(step_fractions[pair.particle[j]][entry], floatBitsToUint(t[j]));
      if (first_mesh_body > 0) touch(pair.particle[j], mesh_of(pair));
    }
}

void lower_in_round(Candidate pair, uint round, vec4 t, vec4 before) {
  lower_fractions(pair, round % kTurns, t, before);
  if (any(lessThan(t, before))) atomicOr(detection[0].changed[round % kTurns], 1);
}

// Hands on what earlier rounds have found.
void keep_fractions(Candidate pair, uint round, vec4 before) {
  for (int j = 0; j < 4; ++j) {
    step_fractions[pair.particle[j]][(round + 1) % kTurns] = floatBitsToUint(1.0);
    if (before[j] < 1) atomicMin(step_fractions[pair.particle[j]][round % kTurns], floatBitsToUint(before[j]));
  }
}

// Sides that touch or overlap at the start have no normal, hence no planes: their particles stay, except kinematic ones.
vec4 held_in_place(Candidate pair) {
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j)
    if (FETCH(positions, pair.particle[j]).w > 0) t[j] = 0;
  return t;
}

bool crosses(Sides sides, vec4 end) {
  const vec2 least = least_of_sides(end, sides.edges);
  return least.x + least.y < sides.least_gap;
}

// It crosses although both sides keep to planes that do not move: a kinematic particle was driven through the other side.
void watch_crossing(Sides sides) {
  if (!untangles || all(equal(sides.least_fraction, vec4(0)))) return;
  detection[0].may_cross = 1;
  detection[0].needs_detection = 1;
}

void limit_pair(Candidate pair, vec3 n, uint round, vec4 before) {
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + before * sides.displacement;
  if (!crosses(sides, end)) return;
  vec4 t = vec4(1);
  if (round < kYieldingRounds) t = truncated_fractions(sides, stopping_heights(sides, end));
  if (all(greaterThanEqual(t, before))) t = truncated_fractions(sides, divide_slack(sides, 0, 0));
  if (all(greaterThanEqual(t, before))) watch_crossing(sides);
  lower_in_round(pair, round, t, before);
}

void limit(uint i, uint round) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  const vec4 before = fractions_before(pair, round);
  if (round > 0 && before == vec4(1)) return;   // nothing has changed for this pair since the first round
  if (round > 0) keep_fractions(pair, round, before);
  if (n != vec3(0)) limit_pair(pair, n, round, before);
  else if (round == 0) lower_in_round(pair, round, held_in_place(pair), before);
}

// After the last round, where that lowered fractions: those by planes that do not move, for all, if this pair calls for them.
void fall_back(uint i, uint rounds) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  if (n == vec3(0)) return;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  const vec4 before = fractions_before(pair, rounds);
  const Sides sides = sides_of(pair, n);
  const vec4 fallback = truncated_fractions(sides, divide_slack(sides, 0, 0));
  if (crosses(sides, sides.height + before * sides.displacement)) {
    if (any(lessThan(fallback, before))) atomicOr(detection[0].falls_back, 1);
    watch_crossing(sides);
  }
  lower_fractions(pair, kFallback, fallback, vec4(1));
}
