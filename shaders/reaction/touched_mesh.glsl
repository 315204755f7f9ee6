// touched_mesh: which mesh collider a particle has to do with in a substep. Kept in contact_sums, where nothing else needs w; contact_finalize
// forgets it. Needs contact_sums, velocities and materials.

#include "motion/body.glsl"

// The mesh collider of a pair, counted from 1; 0: it has none, or they are not told. Two of them are no pair.
uint mesh_of(Candidate pair) {
  if (first_mesh_body == 0) return 0;
  const uint body = max(body_of(pair.particle[0]), body_of(pair.particle[3]));   // one of each side
  return body < first_mesh_body ? 0 : body - first_mesh_body + 1;
}

// Positive integers: of several the last, whatever the order of threads.
void touch(uint particle, uint mesh) {
  if (mesh > 0) atomicMax(contact_sums[particle].w, int(mesh));
}

uint touched_mesh(uint particle) { return uint(contact_sums[particle].w); }
