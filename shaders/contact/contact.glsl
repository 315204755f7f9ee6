// contact: the two sides of a candidate. Side A is a vertex or an edge, side B a triangle or an edge:
//
//      vertex-triangle            edge-edge
//          0                      0 ------ 1       side A
//          |  n, from B to A         | n
//        / : \                       |
//       1--2--3                   2 ------ 3       side B
//
// Of the largest coordinate: what the heights of two particles lose at most when their places are rounded, four times over. Sides closer
// than that are never passed over.
const float kFloor = 1.0 / 1048576;   // 2^-20
// Of the distance to keep. That much remains at a substep's end, or all that there is if it is less: a part of the gap would shrink
// from substep to substep, until rounding has the rest.
const float kMargin = 0.1;

// Four values of the particles, one each, are a vec4; their places are a matrix of four columns, relative to particle 0's place
// at the substep's start, so that the distance from the origin costs no precision.

// 1 for the particles of side A, -1 for those of side B.
vec4 signs(bool edges) { return vec4(1, edges ? 1 : -1, -1, -1); }

// The least of side A's values and of side B's.
vec2 least_of_sides(vec4 values, bool edges) {
  return edges ? vec2(min(values.x, values.y), min(values.z, values.w)) : vec2(values.x, min(values.y, min(values.z, values.w)));
}

// How far apart two planes across n are of which each touches one side (m): at most the distance of the sides, and that if n is
// its direction; below 0 they overlap.
float separation(vec3 n, mat4x3 x, bool edges) {
  const vec2 least = least_of_sides(signs(edges) * (n * x), edges);
  return least.x + least.y;
}
