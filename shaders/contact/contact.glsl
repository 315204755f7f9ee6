// contact: the two sides of a candidate. Side A is a vertex or an edge, side B a triangle or an edge:
//
//      vertex-triangle            edge-edge
//          0                      0 ------ 1       side A
//          |  n, from B to A         | n
//        / : \                       |
//       1--2--3                   2 ------ 3       side B
//
// Relative to the largest coordinate: four times what rounding of positions can change the heights of two particles by. A pair that is
// closer than that always counts as unsafe.
const float kFloor = 1.0 / 1048576;   // 2^-20
// Relative to the separation: the gap that contact_limit leaves at a substep's end, or the whole gap if it is less. A share of the gap
// instead would shrink from substep to substep, down to the size of rounding errors.
const float kMargin = 0.1;

// Four values of the particles, one each, are a vec4; their positions are a matrix of four columns, relative to particle 0
// at the substep's start, so that the distance from the origin costs no precision.

// 1 for the particles of side A, -1 for those of side B.
vec4 signs(bool edges) { return vec4(1, edges ? 1 : -1, -1, -1); }

// What contact_weights has of an active candidate: its first weight follows from the others, to the bit, as each side's sum to 1. In its
// place is the height of the first particle over the middle of the gap, at the substep's start (m).
vec4 weights_of(vec4 stored, bool edges) { return vec4(edges ? 1 - stored.y : 1, stored.yzw); }

// Ranks of particles, by which it is decided who gives way (slide.glsl): told in an earlier round of contact_slide to get out of the way of
// one with a rank; where a kinematic particle is going to be in this substep (prepare.glsl); kinematic. Others have 0.
const uint kTold = 1, kInTheWay = 2, kKinematic = 3;

// Whether it is so of a particle of side A, and of side B.
bvec2 either(bvec4 particles, bool edges) {
  return edges ? bvec2(particles.x || particles.y, particles.z || particles.w)
               : bvec2(particles.x, particles.y || particles.z || particles.w);
}

// The least of side A's values and of side B's.
vec2 least_of_sides(vec4 values, bool edges) {
  return edges ? vec2(min(values.x, values.y), min(values.z, values.w)) : vec2(values.x, min(values.y, min(values.z, values.w)));
}

// The gap along n: the distance (m) of two planes across n that touch one side each. It is at most the distance of the sides, and equal
// to it where n is the direction of the shortest connection; below 0 the projections overlap.
float separation(vec3 n, mat4x3 x, bool edges) {
  const vec2 least = least_of_sides(signs(edges) * (n * x), edges);
  return least.x + least.y;
}
