// predicted_track: the track that a detection gives a particle (detect_track.comp), before it is known how far all are pushed.
//
// What a kinematic particle is about to push needs a larger bound, to be out of its way in the same substep: as far as the two approach in
// a substep. Needs detected_positions and trajectories.

// `pushed`: by how much its bound exceeds its own (m).
Track predicted_track(uint i, float pushed) {
  const vec4 at = LATEST(detected_positions, i);
  return Track(at.xyz, LATEST(trajectories, i).xyz, at.w + pushed);
}
