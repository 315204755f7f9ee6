// penetration: what contact_penetration does for the active contact at `place` of the list. Needs contact/contact_share.glsl.

void add_penetrations(uint place) {
  const ActiveContact contact = active_contact_at(place);
  if (!contact.penetrates) return;
  for (int j = 0; j < 4; ++j) {
    const uint i = contact.pair.particle[j];
    if (contact.weights[j] != 0 && FETCH(positions, i).w != 0)
      atomicAdd(contact_penetrations[i], penetration_of(contact.weights[j], contact.depth, FETCH_UINT(contact_counts, i)));
  }
}
