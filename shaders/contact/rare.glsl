// rare: how a pass of the detection asks for search_rare. Needs contact/groups.glsl and Detection.

void ask_for_rare() {
  const uint all = groups_of(contact_settings.particles + contact_settings.edges).x;
  if (detection[0].rare.x < all) atomicMax(detection[0].rare.x, all);
}
