// contact_list: compaction. Of all candidates few are active in a substep, and few are unsafe. A pass over all of them lists the numbers of
// those, so that the passes that follow, several times a substep, have threads for these alone. The order of the list differs from run to
// run; no result depends on it.

WRITE(uint, contact_list)

// kind: WEFT_ACTIVE or WEFT_UNSAFE. Both lists begin empty (detect_arguments), and the second overwrites the first.
void list(uint kind, uint candidate) {
  const uint place = atomicAdd(detection[0].listings[kind], 1);
  contact_list[place] = candidate;
  // The first entry of a workgroup's share adds the workgroup to the dispatch.
  const uint workgroup = contact_settings.workgroup;
  if (place % workgroup == 0) atomicMax(detection[0].listed[kind].x, place / workgroup + 1);
}
