// final_track: the track of a particle once it is known who is pushed. Needs contact/grid.glsl, contact/predicted_track.glsl, Detection,
// cluster_pushes and cluster_owners.

float pushed(uint i) {
  return detection[0].most_pushed == 0 ? 0 : uintBitsToFloat(LATEST_UINT(cluster_pushes, FETCH_UINT(cluster_owners, i)));
}

Track final_track(uint i) { return predicted_track(i, pushed(i)); }
