// mask: which cloths and mesh colliders meet: a row of bits for each of them, cloths first, in rows of the same. Needs velocities.

READ(uint, contact_masks)

GATHER(materials)
#include "motion/body.glsl"

// Whether what two particles belong to meets; where contact_mask_words is not 0.
bool meets_other(uint a, uint b) {
  const uint other = body_of(b);
  return (contact_masks[body_of(a) * contact_mask_words + other / 32] >> (other % 32) & 1) != 0;
}
