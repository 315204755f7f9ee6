// colliders: puts a particle out of all colliders (collide.glsl), which may react (reaction.glsl). How many there are of
// each shape is a specialisation constant. Needs push.

#include "collide/collide.glsl"
READ(Collider, colliders)
#include "reaction/reaction.glsl"

// p, which was `before` until that collider moved it.
vec3 reacted(uint collider, Particle v, vec3 before, vec3 p, float inverse_mass) {
  if (reacts) react(collider, v, before, p, inverse_mass);
  return p;
}

vec3 out_of_colliders(vec3 x, vec3 p, vec4 material, float inverse_mass) {
  const Particle v = Particle(push.fraction_from, push.fraction_to, x, material.z, material.y);
  for (uint k = 0; k < planes; ++k) p = reacted(k, v, p, out_of_plane(colliders[k], v, p), inverse_mass);
  for (uint k = 0, c = planes; k < spheres; ++k) p = reacted(c + k, v, p, out_of_sphere(colliders[c + k], v, p), inverse_mass);
  for (uint k = 0, c = planes + spheres; k < capsules; ++k) p = reacted(c + k, v, p, out_of_capsule(colliders[c + k], v, p), inverse_mass);
  for (uint k = 0, c = planes + spheres + capsules; k < boxes; ++k)
    p = reacted(c + k, v, p, out_of_box(colliders[c + k], v, p), inverse_mass);
  return p;
}
