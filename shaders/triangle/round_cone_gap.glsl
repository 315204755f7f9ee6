// round_cone_gap: how far a triangle is from a capsule with two radii (collide/round_cone.glsl). Its distance is a convex function, the
// length of the way from the nearest place of the core less the radius there, and the gap is the least of it on the triangle. The least is
// at an end's sphere, or on an edge: at the side normals have one slope, so inside the triangle it is no less than on the way to an edge.
// Needs gap.glsl.

// The triangle's point with these weights, if it is nearer than `nearest`.
void consider_point(inout Gap nearest, Body body, mat3 x, vec3 weights) {
  const vec3 way = from_axis(body, point_at(x, weights));
  const float len = length(way), size = len - radius_at(body.radius, body.half_size, nearest_height(body.half_size, point_at(x, weights)));
  if (size < nearest.size) nearest = Gap(way / max(len, 1e-30), size, weights);
}

// Where along the edge from p by e (0 to 1) the distance from the cone of the side is least: cosine |p.xz| + b p.y, a hyperbola.
float nearest_of_edge(float b, vec3 p, vec3 e) {
  const float across = dot(e.xz, e.xz), along = -dot(p.xz, e.xz) / max(across, 1e-20);
  const float off = length(p.xz + along * e.xz), fall = b * e.y, cosine2 = 1 - b * b;
  const float steep = cosine2 * across - fall * fall;
  // Steeper than the side: the lower end, or the higher.
  if (steep <= 0 || across < 1e-20) return fall > 0 ? 0 : 1;
  return clamp(along - fall * off * inversesqrt(steep * across), 0, 1);
}

// As gap_across, to the side on which less of the body is.
Gap round_cone_across(Body body, mat3 x) {
  vec3 across = cross(x[1] - x[0], x[2] - x[0]);
  across /= max(length(across), 1e-30);
  const float height = dot(across, x[0]), above = height - support_of(body, across), below = -height - support_of(body, -across);
  const vec3 normal = above >= below ? across : -across;
  const vec3 deepest = vec3(0, body.half_size.x + (normal.y < body.half_size.z ? -body.half_size.y : body.half_size.y), 0);
  return Gap(normal, max(above, below), -closest_to_triangle(deepest, x[0], x[1], x[2]).yzw);
}

Gap gap_of_round_cone(Body body, mat3 x) {
  const vec3 middle = vec3(0, body.half_size.x, 0), top = vec3(0, body.half_size.y, 0);
  const mat3 centred = mat3(x[0] - middle, x[1] - middle, x[2] - middle);
  Gap nearest = Gap(vec3(1, 0, 0), 3e38, vec3(1, 0, 0));
  for (int end = body.half_size.y > 0 ? -1 : 1; end <= 1; end += 2)
    consider_point(nearest, body, x, -closest_to_triangle(middle + end * top, x[0], x[1], x[2]).yzw);
  if (body.half_size.y > 0)
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      vec3 weights = vec3(0);
      weights[l] = nearest_of_edge(body.half_size.z, centred[k], x[l] - x[k]);
      weights[k] = 1 - weights[l];
      consider_point(nearest, body, x, weights);
    }
  const vec3 point = point_at(x, nearest.weights);
  if (length(from_axis(body, point)) < 1e-9 || body.half_size.y > 0 && crosses(top, centred)) return round_cone_across(body, x);
  return nearest;
}
