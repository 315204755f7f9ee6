// reaction: what a collider is given for what it gave to a particle. A particle that it moves by d within a substep h has changed its
// momentum by m d / h, so the collider gets J = -m d / h, and r x J about its centre, r from there to the particle: linear and angular
// momentum of cloth and collider together stay what they were. Needs colliders.

#include "reaction/quanta.glsl"

// The collider has moved the particle from `before` to `after`.
void react(uint collider, Particle v, vec3 before, vec3 after, float inverse_mass) {
  const vec3 moved = after - before;
  if (!(dot(moved, moved) > 0 && dot(moved, moved) < 1e20 && inverse_mass > 0)) return;
  const vec3 impulse = -(reaction_settings.quanta / inverse_mass) * moved;
  const vec3 angular = cross(after - surface_at(colliders[collider], v).point, impulse);
  for (int k = 0; k < 3; ++k) {
    add_quanta(collider, k, impulse[k]);
    add_quanta(collider, 3 + k, angular[k]);
  }
}
