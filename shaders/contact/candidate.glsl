// candidate: how a pass adds a candidate pair. Needs Detection, Counters, candidates and displacement_bounds.

#include "contact/groups.glsl"

// Its number. A candidate beyond the capacity overflows and has none: no contact keeps its sides apart, so its particles are held in place,
// by a displacement bound of 0. A bit of the bound says that the particle has candidates.
uint add_candidate(uvec4 particle, float separation, bool edges) {
  const uint index = atomicAdd(detection[0].candidates, 1u);
  if (counters[0].contacts_most <= index) atomicMax(counters[0].contacts_most, index + 1);
  if (counters[0].contacts_room <= index) atomicMax(counters[0].contacts_room, index + 1);
  const bool overflows = index >= contact_settings.capacity;
  if (overflows) {
    atomicAdd(counters[0].contacts_overflowed, 1u);
  } else {
    candidates[index] = pack_candidate(particle.x, particle.y, particle.z, particle.w, separation, edges);
    // The first candidate of a workgroup's share adds the workgroup to the dispatches.
    const uint workgroup = contact_settings.workgroup;
    if (index % workgroup == 0) atomicMax(detection[0].contacts.x, index / workgroup + 1);
    if (index == 0) {
      detection[0].paired.x = groups_of(contact_settings.particles).x;   // one row each: begin_detection
      detection[0].alone.x = 1;
    }
  }
  for (uint k = 0; k < 4; ++k) {
    if (overflows) atomicAnd(displacement_bounds[particle[k]], WEFT_PAIRED);
    else if ((FETCH_UINT(displacement_bounds, particle[k]) & WEFT_PAIRED) == 0)   // of before or of now: once more does no harm
      atomicOr(displacement_bounds[particle[k]], WEFT_PAIRED);
  }
  return overflows ? WEFT_NONE : index;
}
