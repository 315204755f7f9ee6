// The filter of an implicit substep, by which colliders take directions out of its solve (implicit_wall.glsl makes it):
//
// S v = s v + (1 - 2 s) (n . v) n of a vector n and a number s in one entry of `walls`: all of v (0, 1), all but along a normal n
// (n, 1), in an edge along n alone (n, 0), in a corner nothing (0, 0), which is also what a held particle has.

vec3 opened(vec4 open, vec3 v) { return open.w * v + (1 - 2 * open.w) * dot(open.xyz, v) * open.xyz; }
