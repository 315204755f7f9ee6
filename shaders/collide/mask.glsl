// mask: which colliders that are formulas a cloth meets: a row of bits for each cloth, a bit for each collider in the order of `colliders`.

READ(uint, body_masks)

const uint kBodies = planes + spheres + capsules + boxes;

// `material`: of the cloth.
bool meets_body(vec4 material, uint collider) {
  const uint cloth = uint(material.w);
  return !has_body_masks || (body_masks[cloth * ((kBodies + 31) / 32) + collider / 32] >> (collider % 32) & 1) != 0;
}
