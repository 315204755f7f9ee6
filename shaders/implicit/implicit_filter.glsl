// The collider filter of an implicit substep, S v = s v + (1 - 2 s) (n . v) n, which takes constrained directions out of the solve
// (implicit_collide.glsl makes it). A vector n and a number s are one entry of `collider_filters`:
//     (0, 1)   all of v                          (n, 0)   v along n alone, in an edge
//     (n, 1)   all of v but along a normal n     (0, 0)   nothing, in a corner; kinematic particles have this one too

vec3 apply_filter(vec4 directions, vec3 v) { return directions.w * v + (1 - 2 * directions.w) * dot(directions.xyz, v) * directions.xyz; }
