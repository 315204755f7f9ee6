// rare: how a search asks for search_rare to go on where there are too many clusters near for a list, or it has found more than there is room
// for. Needs contact/groups.glsl, Detection and displacement_bounds.

void ask_for_rare() {
  const uint all = groups_of(contact_settings.particles + contact_settings.edges).x;
  if (detection[0].rare.x < all) atomicMax(detection[0].rare.x, all);
}

// `ends`: the searcher's particles. They are held in any case, as they are in all of its pairs; by that search_rare knows it.
void ask_to_hold(uvec2 ends) {
  atomicMin(displacement_bounds[ends.x], 0u);
  atomicMin(displacement_bounds[ends.y], 0u);
  ask_for_rare();
}
