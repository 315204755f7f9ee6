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
  uint c = 0;
  for (uint k = 0; k < planes; ++k, ++c) p = reacted(c, v, p, out_of_plane(colliders[c], v, p), inverse_mass);
  for (uint k = 0; k < spheres; ++k, ++c) p = reacted(c, v, p, out_of_sphere(colliders[c], v, p), inverse_mass);
  for (uint k = 0; k < capsules; ++k, ++c) p = reacted(c, v, p, out_of_capsule(colliders[c], v, p), inverse_mass);
  for (uint k = 0; k < boxes; ++k, ++c) p = reacted(c, v, p, out_of_box(colliders[c], v, p), inverse_mass);
  return p;
}
