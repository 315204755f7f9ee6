// colliders: puts a particle out of all colliders that its cloth meets (collide.glsl, mask.glsl), which may react (reaction.glsl). How many
// there are of each shape is a specialisation constant. Needs push.

#include "collide/collide.glsl"
#include "collide/size.glsl"
#include "collide/mask.glsl"
#include "reaction/reaction.glsl"

// m, how far colliders have put the particle out, which then hold it (support/support.glsl).
vec3 put_out = vec3(0);
uint last_met = WEFT_NONE;   // the last of those

// p, which was `before` until that collider moved it.
vec3 reacted(uint collider, Particle v, vec3 before, vec3 p, float inverse_mass) {
  if (reacts) react(collider, v, before, p, inverse_mass);
  if (has_supports && p != before && !changes_size(collider, push.fraction_from, push.fraction_to)) {
    put_out += last_put_out;
    last_met = collider;
  }
  return p;
}

vec3 out_of_colliders(vec3 x, vec3 p, vec4 material, float inverse_mass) {
  const Particle v = Particle(push.fraction_from, push.fraction_to, x, material.z, material.y);
  for (uint k = 0; k < planes; ++k)
    if (meets_body(material, k)) p = reacted(k, v, p, out_of_plane(colliders[k], v, p), inverse_mass);
  for (uint k = planes; k < planes + spheres; ++k)
    if (meets_body(material, k)) p = reacted(k, v, p, out_of_sphere(collider_at(k, v.to), v, p), inverse_mass);
  for (uint k = planes + spheres; k < planes + spheres + capsules; ++k)
    if (meets_body(material, k)) p = reacted(k, v, p, out_of_capsule(collider_at(k, v.to), v, p), inverse_mass);
  for (uint k = planes + spheres + capsules; k < planes + spheres + capsules + boxes; ++k)
    if (meets_body(material, k)) p = reacted(k, v, p, out_of_box(collider_at(k, v.to), growth_of(k, v.from, v.to), v, p), inverse_mass);
  return p;
}
