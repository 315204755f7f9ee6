// colliders: puts a particle out of all colliders (collide.glsl). How many there are of
// each shape is a specialisation constant. Needs push.

#include "collide/collide.glsl"
READ(Collider, colliders)

vec3 out_of_colliders(vec3 x, vec3 p, vec4 material) {
  const Particle v = Particle(push.fraction_from, push.fraction_to, x, material.z, material.y);
  for (uint k = 0; k < planes; ++k) p = out_of_plane(colliders[k], v, p);
  for (uint k = 0; k < spheres; ++k) p = out_of_sphere(colliders[planes + k], v, p);
  for (uint k = 0; k < capsules; ++k) p = out_of_capsule(colliders[planes + spheres + k], v, p);
  for (uint k = 0; k < boxes; ++k) p = out_of_box(colliders[planes + spheres + capsules + k], v, p);
  return p;
}
