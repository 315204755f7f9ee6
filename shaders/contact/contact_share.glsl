// contact_share: the penetration of a contact at the current iterate, and the shares of a particle's mass that its contacts get.
//
// Mass splitting (Tonge et al. 2012), as in stretch.comp, but weighted: a contact gets the share s = v / V of a particle's mass, where
// v = |w| depth is its penetration as the particle sees it, and V the sum of v over the particle's contacts. In a corner or a fold one
// contact in a dozen carries the load, and the others are satisfied up to rounding: with even shares it would correct a twelfth of its
// penetration in an iteration, and contact_limit would have to hold the cloth. The shares sum to 1 in any case, so momentum is conserved
// and no particle is moved further than its contacts ask for.
//
// Needs contact/contact.glsl, ITERATE(i), particle i's iterate, and candidates, contact_normals, contact_weights.

struct ActiveContact {
  Candidate pair;
  vec4 normal, weights;
  mat4x3 iterate;     // m, relative to the first particle
  float depth;        // m, penetration: -C
  bool penetrates;
};

// Of candidate i.
ActiveContact active_contact(uint i) {
  ActiveContact contact;
  contact.pair = unpack_candidate(FETCH(candidates, i));
  contact.normal = FETCH(contact_normals, i);
  contact.weights = weights_of(FETCH(contact_weights, i), contact.pair.edges);
  const vec3 origin = ITERATE(contact.pair.particle[0]).xyz;
  contact.iterate = mat4x3(vec3(0), ITERATE(contact.pair.particle[1]).xyz - origin,
                           ITERATE(contact.pair.particle[2]).xyz - origin,
                           ITERATE(contact.pair.particle[3]).xyz - origin);
  // precise: contact_penetration and contact_solve must get the same bits, so that shares sum to 1.
  precise const vec3 between = contact.iterate * contact.weights;
  precise const float depth = contact.normal.w - dot(contact.normal.xyz, between);
  contact.depth = depth;
  contact.penetrates = contact.depth > 0 && contact.depth < 1e10;
  return contact;
}

// v in units of `quantum`: at least one, so that no share is zero, and at most so many that V does not overflow. Penetrations beyond that
// count alike. `uses`: the particle's contacts.
uint penetration_of(float weight, float depth, uint uses) {
  if (weight == 0) return 0;
  const float most = 2147483648.0 / float(max(uses, 16));
  return uint(clamp(abs(weight) * depth / contact_settings.quantum, 1, most));
}
