// proximity: the closest points of a point and a triangle, or of two edges, as signed weights over their four particles:
// the sum of w_j x_j leads from side B's closest point to side A's.
//
// Features are enumerated (Ericson, Real-Time Collision Detection, 2005, 5.1.5 and 5.1.9, tells which there are) and the
// nearest wins by its measured distance. No region test decides, so slivers, parallel edges and edges or triangles without
// extent can at worst choose a feature that is as near as the right one, up to rounding. Inside a face and between the
// insides of two edges the weights come from cross products: |u x v|^2 loses nothing where |u|^2 |v|^2 - (u.v)^2 cancels.
//
// Everything is relative to one of the particles, so the distance from the origin costs no precision, and `precise`, so that
// every pass that asks about a pair gets the same bits.

// m^4. A triangle of edges below 30 nm has no inside, nor have two edges that short; their ends still count.
const float least_cross = 1e-30;

// Of the segment from a along d: the parameter of the point that is closest to p. 0 where d is 0.
float parameter(vec3 p, vec3 a, vec3 d) {
  precise const float squared = dot(d, d);
  precise const float along = dot(p - a, d);
  return clamp(along / max(squared, least_cross), 0, 1);
}

// Sum w_j x_j for weights that sum to 0 (m).
vec3 offset(vec4 weights, vec3 x0, vec3 x1, vec3 x2, vec3 x3) {
  precise const vec3 sum = weights.y * (x1 - x0) + weights.z * (x2 - x0) + weights.w * (x3 - x0);
  return sum;
}

struct Nearest {
  vec4 weights;
  float squared;   // m^2
};

void consider(inout Nearest nearest, vec4 weights, vec3 x0, vec3 x1, vec3 x2, vec3 x3) {
  const vec3 d = offset(weights, x0, x1, x2, x3);
  precise const float squared = dot(d, d);
  if (squared < nearest.squared) nearest = Nearest(weights, squared);
}

// Of p to the triangle a, b, c: (1, -u, -v, -w) with u, v, w >= 0 and of sum 1.
vec4 closest_to_triangle(vec3 p, vec3 a, vec3 b, vec3 c) {
  const float ab = parameter(p, a, b - a), bc = parameter(p, b, c - b), ca = parameter(p, c, a - c);
  Nearest nearest = Nearest(vec4(1, -1, 0, 0), 3e38);
  consider(nearest, vec4(1, ab - 1, -ab, 0), p, a, b, c);
  consider(nearest, vec4(1, 0, bc - 1, -bc), p, a, b, c);
  consider(nearest, vec4(1, -ca, 0, ca - 1), p, a, b, c);
  precise const vec3 n = cross(b - a, c - a);
  precise const float squared = dot(n, n);
  precise const float v = dot(cross(p - a, c - a), n) / max(squared, least_cross);
  precise const float w = dot(cross(b - a, p - a), n) / max(squared, least_cross);
  if (squared > least_cross && v >= 0 && w >= 0 && v + w <= 1) consider(nearest, vec4(1, v + w - 1, -v, -w), p, a, b, c);
  return nearest.weights;
}

// Of the edge a, b to the edge c, d: (1-s, s, -(1-t), -t) with s and t between 0 and 1.
vec4 closest_of_edges(vec3 a, vec3 b, vec3 c, vec3 d) {
  const float at_a = parameter(a, c, d - c), at_b = parameter(b, c, d - c);
  const float at_c = parameter(c, a, b - a), at_d = parameter(d, a, b - a);
  Nearest nearest = Nearest(vec4(1, 0, -1, 0), 3e38);
  consider(nearest, vec4(1, 0, at_a - 1, -at_a), a, b, c, d);
  consider(nearest, vec4(0, 1, at_b - 1, -at_b), a, b, c, d);
  consider(nearest, vec4(1 - at_c, at_c, -1, 0), a, b, c, d);
  consider(nearest, vec4(1 - at_d, at_d, 0, -1), a, b, c, d);
  precise const vec3 n = cross(b - a, d - c);
  precise const float squared = dot(n, n);
  precise const float s = dot(cross(c - a, d - c), n) / max(squared, least_cross);
  precise const float t = dot(cross(c - a, b - a), n) / max(squared, least_cross);
  if (squared > least_cross && min(s, t) >= 0 && max(s, t) <= 1) consider(nearest, vec4(1 - s, s, t - 1, -t), a, b, c, d);
  return nearest.weights;
}
