// mask: which cloths and mesh colliders meet: a row of bits for each of them, by the numbers of their materials, in rows of the same. Needs
// velocities.

READ(uint, contact_masks)

uint material_number(uint particle) { return floatBitsToUint(FETCH(velocities, particle).w); }

// Whether what two particles belong to meets; where contact_mask_words is not 0.
bool meets_other(uint a, uint b) {
  const uint other = material_number(b);
  return (contact_masks[material_number(a) * contact_mask_words + other / 32] >> (other % 32) & 1) != 0;
}
