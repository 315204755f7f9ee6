// ask_to_hold: how a search that has found more than there is room for asks search_rare to hold it. Needs contact/rare.glsl and
// displacement_bounds.

// `ends`: the searcher's particles. They are held in any case, as they are in all of its pairs; by that search_rare knows it.
void ask_to_hold(uvec2 ends) {
  atomicMin(displacement_bounds[ends.x], 0u);
  atomicMin(displacement_bounds[ends.y], 0u);
  ask_for_rare();
}
