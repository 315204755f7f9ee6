// shift: what a substep's sweep leaves of a link's error is remembered, and asked for in the frames that follow.
//
// One sweep a substep carries a steady load by leaving strain: of what a mode is short of it repairs 1 - b, so under a load that adds f in
// each substep the strain comes to rest at c = b f / (1 - b). The method of multipliers (Powell 1969; Hestenes 1969) solves a shifted
// constraint instead, C + s = 0, and moves the shift by the error that is left,
//     s += r c - l s,     c = |x_a - x_b| - L,
// until the load is carried at a smaller strain: c at rest is 1 / (1 + r / l) of what it was, and s what it was less that. An impulse is along
// the link as ever, so momentum is conserved; and one that has too little or too much of a shift is wrong by no more than what it would be
// short of without.
//
// s follows slowly, once a frame: an integral of the error lags behind, and lets what swings grow where a mode's own decay, 1 - b in a
// substep, is less than r (Routh's criterion for s' = r c - l s beside c'' = -(1 - b) (c + s + c')). It pumps a fold that swings, too, as one
// who stands on a swing does: shorter while the pull is large. At three times the r that there is folds over a ball swung on for ever.
//
// What rests has its shift as it is. Under friction an integral hunts: it grows while links stick, and too far.
//
// Forgetting, l, keeps links that something else holds apart from shortening for ever at the cost of one that does not.
//
// A link that gives way, alpha/h^2 beside the inverse masses w of its ends, is right to be longer under a load k (c + s): by
// q (c + s), q = alpha/h^2 / (w + alpha/h^2). So c above is c - q (c + s), which is in gain and kept of engine/effects/shift/shift.cpp.

// Of its length, how much shorter or longer a link is asked to be at most.
const float kMostShift = 0.1;

// m/s: below, a link's ends are on their way to rest.
const float kRests = 0.03;

float shift_of(ShiftedLink link, uint packed_before) {
  const bool only_pulls = (link.low & 1u) != 0u;
  const float before = uintBitsToFloat(packed_before);
  const float error = distance(FETCH(positions, link.a).xyz, FETCH(positions, link.b).xyz) - link.rest;
  if (!(abs(error) < 1e10)) return 0;   // a place is not finite
  const float most = kMostShift * link.rest, renewed = clamp(link.kept * before + link.gain * error, only_pulls ? 0 : -most, most);
  const vec3 a = FETCH(velocities, link.a).xyz, b = FETCH(velocities, link.b).xyz;
  const float moves = min(max(dot(a, a), dot(b, b)) / (kRests * kRests), 1);
  return before + moves * (renewed - before);
}

// The second word of a link (pack_link) with another rest length.
uint with_rest(ShiftedLink link, float rest) { return (((floatBitsToUint(rest / WEFT_REST_UNIT) + 0x10u) >> 5) << 8) | link.low; }
