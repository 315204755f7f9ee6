// outline: a triangle or an edge as it is at the detection, and one trajectory for all of it. Needs contact/grid.glsl.

struct Outline {
  vec3 middle;       // m
  vec3 half_sides;   // m: half of an edge; half of a triangle's box
  vec3 trajectory;   // m
  float reach;       // m: how far a point may be from there, plus half of the thickness
};

// `strays`: by how much a particle's trajectory differs from the one for all (m). As it may be stopped for a substep on its own, so may the
// part by which it differs.
float reach_of(float strays, Sweep sweep, float thickness) {
  return strays * (1 + per_substep()) + sweep.clearance + 0.5 * thickness;
}
