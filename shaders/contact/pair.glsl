// pair: the narrow phase's test, whether two primitives can come within their separation before the next detection, and the candidate.
//
// Bound. Let q_i be the trajectories of A's particles, q_j those of B's, both over a lifetime of H substeps. In a substep a particle moves
// from within its clearance of its trajectory to within that again, or is stopped on the straight line between: there it is that close to
// a place on its trajectory up to t of a step behind. Two points of A and B are mixtures of such particles, so that after s substeps their
// motion has brought them closer by at most the largest of
//     |s (q_i - q_j) - (t_i q_i - t_j q_j)| / H    with 0 <= t_i, t_j <= 1 and 1 <= s <= H,
// which is convex in each t. At t_i = t_j = 0 or 1 it is at most u, the largest |q_i - q_j|; at t_i = 1 and t_j = 0 it is
//     |(s - 1) (q_i - q_j) - q_j| / H <= (1 - 1/H) u + |q_j| / H,
// and at 0 and 1 the same with q_i. So A and B, d apart at the detection, cannot meet before the next one if
//     d - u - max(0, max(step_A, step_B) - u / H) - clearance_A - clearance_B >= separation.
// Nor can they if their boxes do not overlap, because boxes contain trajectories. A pair that moves as one has u = 0, and only the step by
// which one of them may be stopped counts.

#include "contact/grid.glsl"
#include "contact/proximity.glsl"

GATHER(positions)
GATHER(velocities)
WRITE(uvec4, candidates)
READ_WRITE(uint, displacement_bounds)

bool overlap(Sweep a, Sweep b) { return all(lessThanEqual(a.low, b.high)) && all(lessThanEqual(b.low, a.high)); }

float inverse_mass(uint i) { return FETCH(positions, i).w; }

bool moves(uvec4 particle) {
  return inverse_mass(particle.x) > 0 || inverse_mass(particle.y) > 0 || inverse_mass(particle.z) > 0 || inverse_mass(particle.w) > 0;
}

// A lower bound of the distance of two sides until the next detection, from that at the last one (m).
float spare_distance(float distance, float squared_relative, Sweep a, Sweep b) {
  const float relative = sqrt(squared_relative);
  const float stopped = max(max(a.step, b.step) - relative * per_substep(), 0);
  return distance - relative - stopped - a.clearance - b.clearance;
}

bool same_cloth(uint a, uint b) { return floatBitsToUint(FETCH(velocities, a).w) == floatBitsToUint(FETCH(velocities, b).w); }

// Within a cloth the separation is less than the distance of the sides in the rest positions: a thick cloth must not push itself apart.
const float share_of_rest = 0.9;
float rest_separation(uint a, uint b, float thickness, float at_rest) {
  return same_cloth(a, b) ? min(thickness, share_of_rest * at_rest) : thickness;
}

// A candidate beyond the capacity overflows: no contact keeps its sides apart, so its particles are held in place, by a displacement bound
// of 0.
void add_candidate(uvec4 particle, float separation, bool edges) {
  const uint index = atomicAdd(detection[0].candidates, 1u);
  if (index < contact_settings.capacity) {
    candidates[index] = pack_candidate(particle.x, particle.y, particle.z, particle.w, separation, edges);
  } else {
    for (uint k = 0; k < 4; ++k) atomicMin(displacement_bounds[particle[k]], 0u);
  }
}
