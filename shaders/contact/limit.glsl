// limit: what contact_limit does for an unsafe candidate in one of its rounds. Needs contact/contact.glsl,
// contact/sides.glsl, contact/parting.glsl, reaction/touched_mesh.glsl and ITERATE(i).

// Entries of step_fractions: the least of all rounds but the last; and what a round has found, three by turns. A round reads that of the
// round before, writes its own, and clears the next one's.
const uint kSettled = 0;
uint entry_of(uint round) { return 1 + round % 3; }
const uint kYieldingRounds = WEFT_LIMIT_ROUNDS / 2;

struct Fractions {
  vec4 recent, stale;   // what the round before found, and what lies in the next one's entry
  vec4 before;          // the least of all rounds before
};

Fractions fractions_before(Candidate pair, uint round) {
  const uvec4 a = step_fractions[pair.particle[0]], b = step_fractions[pair.particle[1]], c = step_fractions[pair.particle[2]],
              d = step_fractions[pair.particle[3]];
  const uint last = entry_of(round + 2), next = entry_of(round + 1);
  Fractions fractions;
  fractions.recent = uintBitsToFloat(uvec4(a[last], b[last], c[last], d[last]));
  fractions.stale = uintBitsToFloat(uvec4(a[next], b[next], c[next], d[next]));
  fractions.before = min(uintBitsToFloat(uvec4(a[kSettled], b[kSettled], c[kSettled], d[kSettled])), fractions.recent);
  return fractions;
}

// Stage 4: the step fractions at which particles reach the planes at these heights, their times of impact; 1 for those that do not.
// Kinematic particles take at least the fraction that they must.
vec4 truncated_fractions(Sides sides, vec2 stopping) {
  const vec4 bound = sides.edges ? stopping.xxyy : stopping.xyyy;
  const vec4 impact = clamp((sides.height - bound) / max(-sides.displacement, vec4(1e-30)), sides.least_fraction, vec4(1));
  const bvec4 ends_beyond = lessThan(sides.height + sides.displacement, bound);
  const bvec4 approaches = lessThan(sides.displacement, vec4(sides.rounding_error));
  return mix(vec4(1), mix(vec4(1), impact, approaches), ends_beyond);
}

// Positive floats are ordered like their bits.
void lower_fraction(Candidate pair, int j, uint entry, float t, float before) {
  if (t >= before) return;
  atomicMin(step_fractions[pair.particle[j]][entry], floatBitsToUint(t));
  if (first_mesh_body > 0) touch(pair.particle[j], mesh_of(pair));
}

// Stage 5. No loop, as a workgroup that goes through all rounds has a loop for pairs, whose turns are counted (limit_rest.glsl).
void lower_fractions(Candidate pair, uint entry, vec4 t, vec4 before) {
  lower_fraction(pair, 0, entry, t.x, before.x);
  lower_fraction(pair, 1, entry, t.y, before.y);
  lower_fraction(pair, 2, entry, t.z, before.z);
  lower_fraction(pair, 3, entry, t.w, before.w);
}

void lower_in_round(Candidate pair, uint round, vec4 t, vec4 before) {
  lower_fractions(pair, entry_of(round), t, before);
  if (any(lessThan(t, before))) atomicOr(detection[0].changed[round % 3], 1);
}

void settle_fraction(uint i, uint round, float recent, float stale) {
  if (recent < 1) atomicMin(step_fractions[i][kSettled], floatBitsToUint(recent));
  if (stale < 1) step_fractions[i][entry_of(round + 1)] = floatBitsToUint(1.0);
}

// Whether other pairs settle the same meanwhile makes no difference: nobody reads the one without the other.
void settle_fractions(Candidate pair, uint round, Fractions fractions) {
  settle_fraction(pair.particle[0], round, fractions.recent.x, fractions.stale.x);
  settle_fraction(pair.particle[1], round, fractions.recent.y, fractions.stale.y);
  settle_fraction(pair.particle[2], round, fractions.recent.z, fractions.stale.z);
  settle_fraction(pair.particle[3], round, fractions.recent.w, fractions.stale.w);
}

// Sides that touch or overlap at the start have no normal, hence no planes: their particles stay, except kinematic ones.
vec4 held_in_place(Candidate pair) {
  const vec4 inverse_masses = vec4(FETCH(positions, pair.particle[0]).w, FETCH(positions, pair.particle[1]).w,
                                   FETCH(positions, pair.particle[2]).w, FETCH(positions, pair.particle[3]).w);
  return mix(vec4(1), vec4(0), greaterThan(inverse_masses, vec4(0)));
}

vec4 fallback(Sides sides) { return truncated_fractions(sides, divide_slack(sides, 0, 0)); }

bool crosses(Sides sides, vec4 end) {
  const vec2 least = least_of_sides(end, sides.edges);
  return least.x + least.y < sides.least_gap;
}

// Along the pair's normal, or along a better one if it seems to cross.
Sides parted_sides(Candidate pair, vec3 n, vec4 fractions) {
  const Sides sides = sides_of(pair, n);
  return crosses(sides, sides.height + fractions * sides.displacement) ? sides_of(pair, parting_normal(pair, n)) : sides;
}

// It crosses although both sides keep to planes that do not move: a kinematic particle was driven through the other side.
void watch_crossing(Sides sides) {
  if (!untangles || all(equal(sides.least_fraction, vec4(0)))) return;
  detection[0].may_cross = 1;
  detection[0].needs_detection = 1;
}

void limit_pair(Candidate pair, vec3 n, uint round, vec4 before) {
  const Sides sides = parted_sides(pair, n, before);
  const vec4 end = sides.height + before * sides.displacement;
  if (!crosses(sides, end)) return;
  vec4 t = vec4(1);
  if (round < kYieldingRounds) t = truncated_fractions(sides, stopping_heights(sides, end));
  if (all(greaterThanEqual(t, before))) t = fallback(sides);
  if (all(greaterThanEqual(t, before))) watch_crossing(sides);
  lower_in_round(pair, round, t, before);
}

void limit(uint i, uint round) {
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  const Fractions fractions = fractions_before(pair, round);
  if (round > 0) settle_fractions(pair, round, fractions);
  if (round > 0 && fractions.recent == vec4(1)) return;   // nothing has changed for this pair
  const vec3 n = FETCH(contact_normals, i).xyz;
  if (n != vec3(0)) limit_pair(pair, n, round, fractions.before);
  else if (round == 0) lower_in_round(pair, round, held_in_place(pair), fractions.before);
}

// After the last round, where it lowered fractions: whether this pair calls for those by planes that do not move, for all.
void ask_to_fall_back(uint i, uint rounds) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  if (n == vec3(0)) return;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  const vec4 before = fractions_before(pair, rounds).before;
  const Sides sides = parted_sides(pair, n, before);
  if (!crosses(sides, sides.height + before * sides.displacement)) return;
  if (any(lessThan(fallback(sides), before))) atomicOr(detection[0].falls_back, 1);
  watch_crossing(sides);
}

void fall_back(uint i, uint rounds) {
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (n != vec3(0)) lower_fractions(pair, entry_of(rounds), fallback(parted_sides(pair, n, vec4(1))), vec4(1));
}
