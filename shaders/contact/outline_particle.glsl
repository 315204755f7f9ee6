// outline_particle: completes a particle's displacement bound. Needs contact/final_track.glsl, trajectories and displacement_bounds.

// Nobody else reads the trajectory's w in this pass.
void outline_particle(uint i) {
  const Track track = final_track(i);
  trajectories[i].w = track.bound;
  displacement_bounds[i] = floatBitsToUint(track.bound);
}
