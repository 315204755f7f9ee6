// contact_list: compaction. Of all candidates few are active in a substep, of those few penetrate in an iteration, and few candidates are
// unsafe. A pass over all of them lists the numbers of those, so that the passes that follow have threads for these alone. The order of a
// list differs from run to run; no result depends on it. Needs contact/list_places.glsl.

// All lists begin empty (detect_arguments).
void list(uint kind, uint candidate) {
  const uint place = atomicAdd(detection[0].listings[kind], 1);
  contact_list[first_place(kind) + place] = candidate;
  // The first entry of a workgroup's share adds the workgroup to the dispatch.
  const uint workgroup = contact_settings.workgroup;
  if (place % workgroup == 0) atomicMax(detection[0].listed[kind].x, place / workgroup + 1);
}
