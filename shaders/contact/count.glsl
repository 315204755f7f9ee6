// count: how a pass adds an active contact to its particles. Needs positions and Detection.

READ_WRITE(uint, contact_counts)
WRITE(uint, touched_particles)

// Counts the contacts of a particle that can move, and lists it at the first, for the passes that move particles. Kinematic ones are left
// out: the corner of a large triangle has thousands of contacts, whose impulses its count would scale down (contact_solve).
void count(uint particle) {
  if (FETCH(positions, particle).w == 0 || atomicAdd(contact_counts[particle], 1) != 0) return;
  const uint place = atomicAdd(detection[0].touchings, 1);
  touched_particles[place] = particle;
  const uint workgroup = contact_settings.workgroup;
  if (place % workgroup == 0) atomicMax(detection[0].touched.x, place / workgroup + 1);
}
