// track: what the last detection has written about particles (detect_track.comp, detect_outline.comp).

#include "contact/grid.glsl"

GATHER(detected_positions)
GATHER(trajectories)

Track track_of(uint i) {
  const vec4 trajectory = FETCH(trajectories, i);
  return Track(FETCH(detected_positions, i).xyz, trajectory.xyz, trajectory.w);
}
