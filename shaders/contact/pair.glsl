// pair: the narrow phase's test, whether two primitives can come within their separation before the next detection, and the candidate.
//
// Bound. In a substep a particle moves from within its clearance of its trajectory to within that again, or is stopped on the straight
// line between: there it is that close to a place on its trajectory up to a step behind. Seen along a direction n the heights of particles
// on their trajectories are linear in the substeps s since the detection, so the least heights a(s) and b(s) of the sides, each towards
// itself, are concave (contact_limit.comp has the drawing). Whoever is stopped, within substep s the gap along n is at least
//     min(a(s), a(s - 1)) + min(b(s), b(s - 1)) - clearance_A - clearance_B,
// the least of four sums, each concave in s, which are least where s is 1 or the lifetime H. So A and B cannot meet before the next
// detection if that is at least their separation for some n. Tried are n between the closest points at the detection, and where
// trajectories end; the coordinate axes; and for edges the line between their middles half-way. The search rejects pairs by bounds along
// the last two that are never tighter, so that it does not matter which pairs it lists besides. Of a pair that moves as one only the step
// along n counts, by which one of them may be stopped.
//
// Needs contact/track.glsl, motion/body.glsl, contact/candidate.glsl with the buffers, and positions.

#include "contact/proximity.glsl"
#include "contact/contact.glsl"
#include "untangle/tangled.glsl"

GATHER_UINT(tangled_pairs)

float inverse_mass(uint i) { return FETCH(positions, i).w; }

bool moves(uvec4 particle) {
  return inverse_mass(particle.x) > 0 || inverse_mass(particle.y) > 0 || inverse_mass(particle.z) > 0 || inverse_mass(particle.w) > 0;
}

// A lower bound of the gap along n until the next detection (m). x: positions at the detection, relative to one of them; q: trajectories;
// `part`: of them, what a substep goes.
float least_gap(vec3 n, mat4x3 x, mat4x3 q, float part, bool edges) {
  const vec4 start = signs(edges) * (n * x), way = signs(edges) * (n * q), step = part * way;
  const vec2 first = least_of_sides(start, edges), second = least_of_sides(start + step, edges);
  const vec2 last = least_of_sides(start + way, edges), before = least_of_sides(start + way - step, edges);
  const float at_start = min(first.x + min(first.y, second.y), second.x + first.y);
  return min(at_start, min(last.x + min(last.y, before.y), before.x + last.y));
}

vec4 closest(mat4x3 x, bool edges) {
  return edges ? closest_of_edges(x[0], x[1], x[2], x[3]) : closest_to_triangle(x[0], x[1], x[2], x[3]);
}

vec3 shortest(mat4x3 x, bool edges) { return offset(closest(x, edges), x[0], x[1], x[2], x[3]); }

float least_gap_along(vec3 d, mat4x3 x, mat4x3 q, float part, bool edges) {
  return least_gap(d / max(length(d), 1e-30), x, q, part, edges);
}

// Whether two sides can come within their separation before the next detection.
bool may_meet(Track a, Track b, Track c, Track d, bool edges, float separation) {
  const float part = per_substep();
  const mat4x3 x = mat4x3(vec3(0), b.at - a.at, c.at - a.at, d.at - a.at);
  const mat4x3 q = mat4x3(a.trajectory, b.trajectory, c.trajectory, d.trajectory);
  const mat4x3 end = x + mat4x3(vec3(0), q[1] - q[0], q[2] - q[0], q[3] - q[0]);
  const vec3 middles = edges ? x[0] + x[1] - x[2] - x[3] + end[0] + end[1] - end[2] - end[3] : vec3(0);
  float gap = max(least_gap_along(shortest(x, edges), x, q, part, edges), least_gap_along(shortest(end, edges), x, q, part, edges));
  gap = max(gap, least_gap_along(middles, x, q, part, edges));
  for (int k = 0; k < 3; ++k) {
    vec3 axis = vec3(0);
    axis[k] = 1;
    gap = max(gap, max(least_gap(axis, x, q, part, edges), least_gap(-axis, x, q, part, edges)));
  }
  return gap < separation;
}

bool same_cloth(uint a, uint b) { return body_of(a) == body_of(b); }

// Two of a cloth that are at one place at rest were one before it tore. What hangs together by them has no distance to keep.
bool were_one(vec4 rest_a, vec4 rest_b) { return rest_a.xyz == rest_b.xyz; }

// Within a cloth the separation is less than the distance of the sides in the rest positions: a thick cloth must not push itself apart.
const float share_of_rest = 0.9;
float rest_separation(uint a, uint b, float thickness, float at_rest) {
  return same_cloth(a, b) ? min(thickness, share_of_rest * at_rest) : thickness;
}

bool is_tangled(uint a, uint b) {
  const uint key = key_of(a, b), last = contact_settings.tangled_room - 1;
  for (uint k = 0; k <= last; ++k) {
    const uint found = FETCH_UINT(tangled_pairs, (key + k) & last);
    if (found == key) return true;
    if (found == 0) return false;
  }
  return false;
}

// What goes through each other has no sides that a contact could keep.
bool are_tangled(uvec4 particle, bool edges) {
  if (!untangles || detection[0].crossings == 0 || detection[0].looks != 1) return false;
  for (uint j = edges ? 2 : 1; j < 4; ++j)
    if (is_tangled(particle.x, particle[j]) || (edges && is_tangled(particle.y, particle[j]))) return true;
  return false;
}
