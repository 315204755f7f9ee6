// proximity: the closest points of a point and a triangle, or of two edges, as signed weights over their four particles:
// the sum of w_j x_j leads from side B's closest point to side A's.
//
// All features are tried (Ericson, Real-Time Collision Detection, 2005, 5.1.5 and 5.1.9, lists them) and the nearest is taken by its
// measured distance. No region test decides, so that slivers, parallel edges and degenerate edges or triangles can at worst choose a
// point that is as near as the right one, up to rounding. In the interior of a face, and between the
// interiors of two edges, the first weight comes from cross products (|u x v|^2 loses nothing where |u|^2 |v|^2 - (u.v)^2 cancels) and
// the second follows from the first: where both are ill-conditioned, they err together and the distance hardly does.
//
// Everything is relative to one of the particles, so the distance from the origin costs no precision, and `precise`, so that
// every pass that asks about a pair gets the same bits.

// No divisor is smaller (m^2 or m^4): a triangle of edges below 30 nm, or two edges that short, have no inside. 0 / 0 is 0.
const float least_divisor = 1e-30;

float clamped_ratio(float numerator, float divisor) { return clamp(numerator / max(divisor, least_divisor), 0, 1); }

// Of the point on the segment along d that is closest to a point at `from_start` from its start. 0 where d is 0.
float parameter(vec3 from_start, vec3 d) {
  precise const float along = dot(from_start, d), squared = dot(d, d);
  return clamped_ratio(along, squared);
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
  const vec3 ab = b - a, ac = c - a, ap = p - a;
  const float on_ab = parameter(ap, ab), on_bc = parameter(p - b, c - b), on_ca = parameter(p - c, a - c);
  Nearest nearest = Nearest(vec4(1, -1, 0, 0), 3e38);
  consider(nearest, vec4(1, on_ab - 1, -on_ab, 0), p, a, b, c);
  consider(nearest, vec4(1, 0, on_bc - 1, -on_bc), p, a, b, c);
  consider(nearest, vec4(1, -on_ca, 0, on_ca - 1), p, a, b, c);
  // Inside: b's weight v, then the place on what is left of ac beside it.
  precise const vec3 n = cross(ab, ac);
  precise const float share = dot(cross(ap, ac), n), squared = dot(n, n);
  const float v = clamped_ratio(share, squared);
  precise const vec3 from_start = ap - v * ab, left = (1 - v) * ac;
  const float w = (1 - v) * parameter(from_start, left);
  consider(nearest, vec4(1, min(v + w - 1, 0), -v, -w), p, a, b, c);
  return nearest.weights;
}

// Of the edge a, b to the edge c, d: (1-s, s, -(1-t), -t) with s and t between 0 and 1.
vec4 closest_of_edges(vec3 a, vec3 b, vec3 c, vec3 d) {
  const vec3 ab = b - a, cd = d - c, ac = c - a;
  const float at_a = parameter(a - c, cd), at_b = parameter(b - c, cd), at_c = parameter(ac, ab), at_d = parameter(d - a, ab);
  Nearest nearest = Nearest(vec4(1, 0, -1, 0), 3e38);
  consider(nearest, vec4(1, 0, at_a - 1, -at_a), a, b, c, d);
  consider(nearest, vec4(0, 1, at_b - 1, -at_b), a, b, c, d);
  consider(nearest, vec4(1 - at_c, at_c, -1, 0), a, b, c, d);
  consider(nearest, vec4(1 - at_d, at_d, 0, -1), a, b, c, d);
  // Between the insides: s, then the place on cd that is closest to it.
  precise const vec3 n = cross(ab, cd);
  precise const float share = dot(cross(ac, cd), n), squared = dot(n, n);
  const float s = clamped_ratio(share, squared);
  precise const vec3 from_start = s * ab - ac;
  const float t = parameter(from_start, cd);
  consider(nearest, vec4(1 - s, s, t - 1, -t), a, b, c, d);
  return nearest.weights;
}

// Either, to the bit but for a zero's sign, where threads beside each other have pairs of both kinds: they go one way, with operands of
// their own.
vec4 closest_of_pair(mat4x3 x, bool edges) {
  const vec3 ab = edges ? x[1] - x[0] : x[2] - x[1], cd = x[3] - x[2], last = edges ? ab : x[1] - x[3];
  const vec3 between = edges ? x[2] - x[0] : x[0] - x[1];
  const float at_1 = parameter(edges ? x[0] - x[2] : between, edges ? cd : ab), at_2 = parameter((edges ? x[1] : x[0]) - x[2], cd);
  const float at_3 = parameter(edges ? between : x[0] - x[3], last), at_4 = parameter(edges ? x[3] - x[0] : x[0] - x[3], last);
  Nearest nearest = Nearest(edges ? vec4(1, 0, -1, 0) : vec4(1, -1, 0, 0), 3e38);
  consider(nearest, edges ? vec4(1, 0, at_1 - 1, -at_1) : vec4(1, at_1 - 1, -at_1, 0), x[0], x[1], x[2], x[3]);
  consider(nearest, edges ? vec4(0, 1, at_2 - 1, -at_2) : vec4(1, 0, at_2 - 1, -at_2), x[0], x[1], x[2], x[3]);
  consider(nearest, edges ? vec4(1 - at_3, at_3, -1, 0) : vec4(1, -at_3, 0, at_3 - 1), x[0], x[1], x[2], x[3]);
  // A triangle has three edges: the third once more.
  consider(nearest, edges ? vec4(1 - at_4, at_4, 0, -1) : vec4(1, -at_4, 0, at_4 - 1), x[0], x[1], x[2], x[3]);
  const vec3 other = edges ? cd : x[3] - x[1];
  precise const vec3 n = cross(ab, other);
  precise const float share = dot(cross(between, other), n), squared = dot(n, n);
  const float r = clamped_ratio(share, squared);
  precise const vec3 from_start = edges ? r * ab - between : between - r * ab, left = edges ? other : (1 - r) * other;
  const float t = parameter(from_start, left), w = (1 - r) * t;
  consider(nearest, edges ? vec4(1 - r, r, t - 1, -t) : vec4(1, min(r + w - 1, 0), -r, -w), x[0], x[1], x[2], x[3]);
  return nearest.weights;
}
