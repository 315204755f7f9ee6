// sides: the two sides of a pair seen along its normal, and the heights at which steps that would cross must stop. contact_limit.comp
// derives them and numbers the stages. Needs ITERATE(i), particle i's iterate.

GATHER_UINT(kinematic_lags)

float lag_of(uint i) { return uintBitsToFloat(FETCH_UINT(kinematic_lags, i)); }

// Of a gap that may not shrink: a change as small as this is no motion.
const float kNegligible = 1e-4;

float largest(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }
float size_of(vec3 x, vec3 step) { return max(largest(x), largest(x + step)); }

// A pair seen along its normal; vec4s have one value for each of its particles.
struct Sides {
  bool edges;
  bvec4 kinematic;       // of inverse mass 0
  vec4 least_fraction;   // of its step that each must take: 0 unless it is kinematic and far from its target
  vec4 height;           // m, at the substep's start: h in the drawing
  vec4 displacement;     // m, change of the height over the whole step: d
  float margin;          // m, to which sides that would cross are parted
  float rounding_error;  // m, of a height, at most
  float least_gap;       // m, below which the pair counts as crossing
};

// contact_finalize lets a particle stay whose prediction is not finite.
vec3 step_of(vec3 x, vec3 p) { return dot(p, p) < 1e20 ? p - x : vec3(0); }

// Stage 1.
Sides sides_of(Candidate pair, vec3 n) {
  const uint a = pair.particle[0], b = pair.particle[1], c = pair.particle[2], d = pair.particle[3];
  const mat4 x = mat4(FETCH(positions, a), FETCH(positions, b), FETCH(positions, c), FETCH(positions, d));
  const mat4x3 steps = mat4x3(step_of(x[0].xyz, ITERATE(a).xyz), step_of(x[1].xyz, ITERATE(b).xyz),
                              step_of(x[2].xyz, ITERATE(c).xyz), step_of(x[3].xyz, ITERATE(d).xyz));
  const vec4 towards = signs(pair.edges);
  Sides sides;
  sides.edges = pair.edges;
  sides.kinematic = equal(vec4(x[0].w, x[1].w, x[2].w, x[3].w), vec4(0));
  const vec4 lags = vec4(lag_of(a), lag_of(b), lag_of(c), lag_of(d));
  const vec4 lengths = vec4(length(steps[0]), length(steps[1]), length(steps[2]), length(steps[3]));
  const vec4 too_far = lags - contact_settings.kinematic_lag_limit * pair.separation;
  const vec4 required = clamp(too_far / max(lengths, vec4(1e-30)), vec4(0), vec4(1));
  sides.least_fraction = mix(vec4(0), required, sides.kinematic);
  sides.displacement = towards * (n * steps);
  const vec4 height = towards * (n * mat4x3(vec3(0), x[1].xyz - x[0].xyz, x[2].xyz - x[0].xyz, x[3].xyz - x[0].xyz));
  const vec2 least = least_of_sides(height, pair.edges);
  const float gap = least.x + least.y;
  sides.height = height + towards * (0.5 * (least.y - least.x));   // now the least height of either side is half the gap
  const float size_ab = max(size_of(x[0].xyz, steps[0]), size_of(x[1].xyz, steps[1]));
  const float size = max(size_ab, max(size_of(x[2].xyz, steps[2]), size_of(x[3].xyz, steps[3])));
  sides.margin = clamp(gap, 0, max(kMargin * pair.separation, kFloor * size));
  sides.rounding_error = 0.25 * kFloor * size;
  // A pair that an earlier pass parted to the margin does not count as crossing, in spite of rounding: no further pass is needed for it.
  // A pair without slack may not come any closer.
  const float tolerance = gap > sides.margin + sides.rounding_error ? sides.rounding_error : kNegligible * sides.margin;
  sides.least_gap = sides.margin - tolerance;
  return sides;
}

// How much lower than half the gap the least height of each side is at the end, or 0 (m).
vec2 approach(Sides sides, vec4 end) {
  return max(vec2(0), least_of_sides(sides.height, sides.edges) - least_of_sides(end, sides.edges));
}

// The same for the kinematic particles alone, if they take these fractions of their steps: the slack that they need (m).
vec2 kinematic_approach(Sides sides, vec4 fractions) {
  return approach(sides, mix(vec4(1e30), sides.height + fractions * sides.displacement, sides.kinematic));
}

// Side A's share of the slack, changed so that each side gets the slack that it needs: side B first, if there is not enough for both.
float share_with_kinematic(float share, vec2 needs, float slack) { return min(max(share, needs.x), slack - needs.y); }

// The stopping heights if the slack is divided as part_a to parts - part_a; in halves if parts is 0. Kinematic particles get what they
// need to reach their targets, and before that what they need to stay within their lag limit. Without slack nobody approaches, not even
// by rounding.
vec2 divide_slack(Sides sides, float part_a, float parts) {
  const vec2 half_gap = least_of_sides(sides.height, sides.edges);
  const float slack = half_gap.x + half_gap.y - sides.margin;
  if (slack <= 0) return vec2(0.5 * sides.margin);
  const float proportional = parts > 0 ? slack * (part_a / parts) : 0.5 * slack;
  const float wanted = share_with_kinematic(proportional, kinematic_approach(sides, vec4(1)), slack);
  const float share = share_with_kinematic(wanted, kinematic_approach(sides, sides.least_fraction), slack);
  return half_gap - vec2(share, slack - share);
}

// Stage 3: the heights at which the planes stand, below which no particle of side A (x) or B (y) may end. If one side approaches alone,
// its plane follows the other side up to the margin; the other side's plane, at half the margin, only guards it against rounding.
vec2 stopping_heights(Sides sides, vec4 end) {
  const vec2 nearer = approach(sides, end);
  if (nearer.x > 0 == nearer.y > 0) return divide_slack(sides, nearer.x, nearer.x + nearer.y);
  const vec2 least = least_of_sides(end, sides.edges);
  const float guard = 0.5 * sides.margin;
  return nearer.x > 0 ? vec2(sides.margin - least.y, guard) : vec2(guard, sides.margin - least.x);
}

