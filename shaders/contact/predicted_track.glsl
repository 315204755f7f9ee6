// predicted_track: the trajectory that a detection gives a particle.
//
// A trajectory is the coming substep's step times the candidate lifetime (detect_arguments): the longer, the more pairs can meet on it. It
// is no longer than 32 cells a substep, so that boxes stay bounded. A particle that is faster leaves its bound, and there is a detection
// in every substep.
//
// The displacement bound is the detection margin. What a kinematic particle is about to push needs more, to be out of its way in the same
// substep: as far as the two approach in a substep. Needs pushed(i), by how much particle i's bound exceeds the margin (m).

GATHER(positions)
GATHER(predicted)

const float most_cells = 32;   // a substep

vec3 trajectory_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // not finite: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].lifetime) * d;
}

Track track_of(uint i) {
  const vec3 x = FETCH(positions, i).xyz;
  return Track(x, trajectory_along(FETCH(predicted, i).xyz - x), detection[0].margin + pushed(i));
}
