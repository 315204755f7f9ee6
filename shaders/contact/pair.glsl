// pair: whether two primitives may meet before the next detection, and the candidate that comes of it.
//
// A substep takes a particle from within its clearance of its path to within that again, or stops it on the straight line
// between: there it is that close to a place of its path that it passes in this substep, t of a step behind. Two points of A
// and B are mixtures of such particles, so in s substeps their paths bring them closer by at most the largest of
//     |s (q_i - q_j) - (t_i q_i - t_j q_j)| / H    for a path q_i of A and q_j of B, 0 <= t <= 1 and 1 <= s <= H,
// which is convex in each t. At t_i = t_j = 0 or 1 it is at most u, the largest |q_i - q_j|; at 1 and 0 it is
//     |(s - 1) (q_i - q_j) - q_j| / H <= (1 - 1/H) u + |q_j| / H,
// and at 0 and 1 the same with q_i. So A and B, d apart at the detection, cannot meet before the next one if
//     d - u - max(0, max(step_A, step_B) - u / H) - clearance_A - clearance_B >= keep.
// Nor can they if their boxes do not overlap: a place that a path passes is in its box. A pair that stays together wherever it
// goes has u = 0, and only the step by which one of them may be stopped counts.

#include "contact/grid.glsl"
#include "contact/proximity.glsl"

GATHER(positions)
GATHER(velocities)
WRITE(uvec4, candidates)
READ_WRITE(uint, leashes)

bool overlap(Sweep a, Sweep b) { return all(lessThanEqual(a.low, b.high)) && all(lessThanEqual(b.low, a.high)); }

float inverse_mass(uint i) { return FETCH(positions, i).w; }

bool moves(uvec4 particle) {
  return inverse_mass(particle.x) > 0 || inverse_mass(particle.y) > 0 || inverse_mass(particle.z) > 0 || inverse_mass(particle.w) > 0;
}

// What is left of the distance between two sides at the detection, at worst, before the next one (m).
float spare_distance(float distance, float squared_relative, Sweep a, Sweep b) {
  const float relative = sqrt(squared_relative);
  const float stopped = max(max(a.step, b.step) - relative * per_substep(), 0);
  return distance - relative - stopped - a.clearance - b.clearance;
}

bool same_cloth(uint a, uint b) { return floatBitsToUint(FETCH(velocities, a).w) == floatBitsToUint(FETCH(velocities, b).w); }

// A cloth at rest must not push itself apart, however thick it is.
const float share_of_rest = 0.9;
float distance_to_keep(uint a, uint b, float thickness, float at_rest) { return same_cloth(a, b) ? min(thickness, share_of_rest * at_rest) : thickness; }

// Without a place a pair cannot be kept apart by itself: its particles are held where they are.
void add_candidate(uvec4 particle, float keep, bool edges) {
  const uint index = atomicAdd(detection[0].candidates, 1u);
  if (index < contact_settings.capacity) {
    candidates[index] = pack_candidate(particle.x, particle.y, particle.z, particle.w, keep, edges);
  } else {
    for (uint k = 0; k < 4; ++k) atomicMin(leashes[particle[k]], 0u);
  }
}
