// prepare: what contact_prepare does for candidate i. Needs contact/proximity.glsl, contact/contact.glsl, positions, predicted, candidates,
// displacement_bounds and Detection.

WRITE(vec4, contact_normals)
WRITE(vec4, contact_weights)

WRITE(uvec4, slides)
WRITE(uint, contact_list)
#include "contact/list_places.glsl"
#include "contact/contact_list.glsl"
#include "contact/count.glsl"

// Rounding error of an offset, over the sides' extent: what is shorter has no direction. Weights are quotients, in which drivers may err by
// two and a half units in the last place.
const float kNoDistance = WEFT_NO_DISTANCE;
// m. No two points of a mesh that is finite are further apart.
const float kNoMesh = 1e9;

// Of the displacement bounds of both sides: what constraints use of them. Where the solve pulled sides into each other whose prediction
// stayed apart, and no contact was active, the step was cut short instead, and cloth hooked on a body's ears (Slip).
const float kUsed = 0.35;
// Of the separation: at least for what other contacts do, and no more where both sides may give way, as coarse cloth that is shaken has
// bounds of centimetres.
const float kLeastSpare = 0.1, kMostSpare = 0.5;

float bound_of(uint i) { return uintBitsToFloat(LATEST_UINT(displacement_bounds, i) & ~WEFT_PAIRED); }

// How much nearer to each other than their prediction constraints may bring the sides (m). Bounds that are larger because something pushes
// count for no more than others may.
float may_come_off(vec4 bounds, bool edges) {
  const float a = edges ? max(bounds.x, bounds.y) : bounds.x, b = max(max(edges ? 0 : bounds.y, bounds.z), bounds.w);
  return min(kUsed * (a + b), detection[0].margin);
}

// The directions in which the features extend that the closest points lie on; 0 where there are fewer than two.
mat2x3 tangents(vec4 weights, mat4x3 x, bool edges) {
  const bvec4 used = notEqual(weights, vec4(0));
  if (edges) return mat2x3(used.x && used.y ? x[1] - x[0] : vec3(0), used.z && used.w ? x[3] - x[2] : vec3(0));
  const vec3 first = used.y && used.z ? x[2] - x[1] : used.z && used.w ? x[3] - x[2] : vec3(0);
  return mat2x3(first, used.y && used.w ? x[3] - x[1] : vec3(0));
}

// The unit normal from side B to side A. d leads from closest point to closest point. Rounding errors in the weights turn it, the more
// the shorter it is than the edges; the normal of the features that the points lie on has no such error, unless these are nearly parallel.
// Of the two candidates the one with the larger gap is better: no direction has a gap larger than the sides' distance.
vec3 direction(vec3 d, vec4 weights, mat4x3 x, bool edges) {
  const mat2x3 along = tangents(weights, x, edges);
  vec3 across = cross(along[0], along[1]);
  if (dot(across, across) > 0) {
    if (dot(across, d) < 0) across = -across;
  } else {
    const vec3 edge = along[0] + along[1];
    across = d - (dot(d, edge) / max(dot(edge, edge), 1e-30)) * edge;
  }
  const vec3 n = d / length(d);
  const vec3 of_features = across / max(length(across), 1e-30);
  return separation(of_features, x, edges) > separation(n, x, edges) ? of_features : n;
}

// `comes_over`: whether a kinematic particle of side A, or of side B, is going to be where the other side is now.
void rank(Candidate pair, bvec4 is_held, bvec2 comes_over) {
  for (int j = 0; j < 4; ++j)
    if (!is_held[j] && (signs(pair.edges)[j] > 0 ? comes_over.y : comes_over.x)) slides[2 * pair.particle[j] + 1].w = kInTheWay;
}

void prepare(uint i) {
  const Candidate pair = unpack_candidate(LATEST(candidates, i));
  const uint a = pair.particle[0], b = pair.particle[1], c = pair.particle[2], d = pair.particle[3];
  const vec4 at_a = FETCH(positions, a), at_b = FETCH(positions, b), at_c = FETCH(positions, c), at_d = FETCH(positions, d);
  const vec3 origin = at_a.xyz;
  const mat4x3 x = mat4x3(vec3(0), at_b.xyz - origin, at_c.xyz - origin, at_d.xyz - origin);
  const mat4x3 p = mat4x3(FETCH(predicted, a).xyz - origin, FETCH(predicted, b).xyz - origin, FETCH(predicted, c).xyz - origin,
                          FETCH(predicted, d).xyz - origin);
  const vec4 weights = closest_of_pair(x, pair.edges);
  const vec3 between = offset(weights, x[0], x[1], x[2], x[3]);
  const float gap = length(between);
  const vec3 extent = max(abs(x[1]), max(abs(x[2]), abs(x[3])));
  if (!(gap > kNoDistance * max(extent.x, max(extent.y, extent.z)) && gap < kNoMesh)) {
    contact_normals[i] = vec4(0, 0, 0, -1);
    return;
  }
  const vec3 n = direction(between, weights, x, pair.edges);
  const float separation = min(pair.separation, gap + contact_settings.recover);
  const vec2 least = least_of_sides(signs(pair.edges) * (n * x), pair.edges);
  const float half_gap = 0.5 * (least.x + least.y), height = half_gap - least.x;
  // The prediction is the first iterate; other contacts and constraints move it.
  // A kinematic particle that is fast may come up to cloth that other constraints hold back, however far the prediction was ahead of it.
  const bvec4 is_held = equal(vec4(at_a.w, at_b.w, at_c.w, at_d.w), vec4(0));
  const vec4 approach = mix(vec4(0), -signs(pair.edges) * (n * p - n * x), is_held);
  const bool is_pushed = max(max(approach.x, approach.y), max(approach.z, approach.w)) > pair.separation;
  const float off = may_come_off(vec4(bound_of(a), bound_of(b), bound_of(c), bound_of(d)), pair.edges);
  const float most = any(is_held) ? off : min(off, kMostSpare * pair.separation);
  const float spare = max(most, kLeastSpare * pair.separation);
  const bool touches = half_gap < kFloor * length(origin);
  const bool is_active = is_pushed || dot(n, p * weights) < separation + spare || touches;
  contact_normals[i] = vec4(n, is_active ? separation : -height);
  // Of pairs that would meet, so that it makes no difference which others are candidates.
  if (is_pushed && dot(n, p * weights) < separation && detection[0].slack != WEFT_LEVEL_SLACK) detection[0].slack = WEFT_LEVEL_SLACK;
  if (!is_active) return;
  list(WEFT_ACTIVE, i);
  contact_weights[i] = vec4(touches ? 0 : height, weights.yzw);
  count(a);
  count(b);
  count(c);
  count(d);
  const bvec2 comes_over = either(greaterThan(approach, vec4(2 * half_gap)), pair.edges);
  if (comes_over.x || comes_over.y) rank(pair, is_held, comes_over);
}
