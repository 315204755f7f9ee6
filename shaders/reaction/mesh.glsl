// mesh: what mesh colliders are given, by contacts. A contact that parts cloth from one has changed the momentum of each of the cloth's
// particles by m d / h, and the collider gets the opposite of them all, with levers from the centre of its pose: as from colliders that are
// formulas (reaction.glsl). What rounding leaves of the last correction is told at the substep's end, as all
// particles of a sheet that lies flat round alike.
//
// Slides, limits and displacement bounds move a particle without a partner that would get the opposite. Where it has touched a mesh collider
// in this substep, that is given what they took: where it has touched several, or cloth as well, all of it goes to the last of them.
//
// Needs `colliders`, in which mesh colliders follow all others, with the places of their centres alone; reaction/quanta.glsl and
// reaction/touched_mesh.glsl.

uint formulas() { return planes + spheres + capsules + boxes; }

vec3 centre_of_mesh(uint mesh) {
  const Collider body = colliders[formulas() + mesh - 1];
  return push.fraction_to == 1 ? body.centre_to : body.centre_from + push.fraction_to * (body.centre_to - body.centre_from);
}

// Impulses are in quanta.
void give_mesh(uint mesh, vec3 impulse, vec3 angular) {
  if (!(dot(impulse, impulse) > 0)) return;
  const uint k = formulas() + grab_count / 3 + mesh - 1;
  for (int c = 0; c < 3; ++c) {
    add_quanta(k, c, impulse[c]);
    add_quanta(k, 3 + c, angular[c]);
  }
}

// The opposite of what a particle has been given that moved so far, in quanta.
vec3 opposite_of(vec3 moved, float inverse_mass) { return -(reaction_settings.quanta / inverse_mass) * moved; }

// Particle i moved so far to `after`, alone.
void tell_touched_mesh(uint i, vec3 moved, vec3 after, float inverse_mass) {
  const uint mesh = touched_mesh(i);
  if (mesh == 0 || !(dot(moved, moved) < 1e20 && inverse_mass > 0)) return;
  const vec3 impulse = opposite_of(moved, inverse_mass);
  give_mesh(mesh, impulse, cross(after - centre_of_mesh(mesh), impulse));
}
