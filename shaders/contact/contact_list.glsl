// contact_list: of all candidates few touch in a substep, and few could cross. A pass over all of them writes down the numbers of those,
// so that the passes that follow, several times a substep, have a thread for no others. Their order in the list differs from
// run to run; nothing that comes of it depends on that.

WRITE(uint, contact_list)

// kind: WEFT_TOUCHING or WEFT_OPEN. Both begin empty (contact_arm), and the second takes the place of the first.
void list(uint kind, uint candidate) {
  const uint place = atomicAdd(detection[0].listings[kind], 1);
  contact_list[place] = candidate;
  // The first of those that a workgroup will take calls for it.
  if (place % gl_WorkGroupSize.x == 0) atomicMax(detection[0].listed[kind].x, place / gl_WorkGroupSize.x + 1);
}
