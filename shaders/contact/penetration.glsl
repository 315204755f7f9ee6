// penetration: what contact_penetration does for an active contact. Needs contact/contact_share.glsl.

// Whether it penetrates.
bool add_penetrations(uint candidate) {
  const ActiveContact contact = active_contact(candidate);
  if (!contact.penetrates) return false;
  for (int j = 0; j < 4; ++j) {
    const uint i = contact.pair.particle[j];
    if (contact.weights[j] != 0 && FETCH(positions, i).w != 0)
      atomicAdd(contact_penetrations[i], penetration_of(contact.weights[j], contact.depth, FETCH_UINT(contact_counts, i)));
  }
  return true;
}
