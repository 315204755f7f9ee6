// final_track: the track of a particle once it is known who is pushed. Needs contact/grid.glsl, contact/predicted_track.glsl, Detection,
// cluster_pushes and memberships.

// All corners of a triangle that is pushed get out of the way: those that hung back would hold up what comes. Positive floats are ordered
// like their bits.
float pushed(uint i) {
  if (detection[0].most_pushed == 0) return 0;
  uint most = 0;
  const uint end = FETCH_UINT(memberships, i + 1);
  for (uint k = FETCH_UINT(memberships, i); k < end; ++k) most = max(most, LATEST_UINT(cluster_pushes, FETCH_UINT(memberships, k)));
  return uintBitsToFloat(most);
}

Track final_track(uint i) { return predicted_track(i, pushed(i)); }
