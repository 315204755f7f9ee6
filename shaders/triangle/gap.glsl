// gap: how far a triangle is from a body, in the body's axes. The corners are the columns of x (m).

#include "contact/proximity.glsl"

struct Gap {
  vec3 normal;    // unit, from the body to the triangle
  float size;     // m, along the normal; negative where they overlap
  vec3 weights;   // of the corners, sum 1: the triangle's nearest point, or the deepest
};

vec3 point_at(mat3 x, vec3 weights) { return x * weights; }

// From a capsule's core to the triangle (m). `nearest` keeps the shortest.
void consider_way(inout Gap nearest, vec3 way, vec3 weights) {
  const float len = length(way);
  if (len < nearest.size) nearest = Gap(way / max(len, 1e-30), len, weights);
}

// The core crosses the triangle: across that, to the side on which less of it is.
Gap gap_across(vec3 top, mat3 x) {
  vec3 across = cross(x[1] - x[0], x[2] - x[0]);
  across /= max(length(across), 1e-30);
  const float height = dot(across, x[0]), reach = dot(abs(across), top);
  const vec3 normal = height < 0 ? -across : across;
  const vec3 deepest = dot(normal, top) < 0 ? -top : top;
  return Gap(normal, abs(height) - reach, -closest_to_triangle(deepest, x[0], x[1], x[2]).yzw);
}

bool crosses(vec3 top, mat3 x) {
  const vec3 ab = x[1] - x[0], bc = x[2] - x[1], ca = x[0] - x[2], across = cross(ab, -ca);
  const float height = dot(across, x[0]), reach = dot(across, top);
  if (abs(height) >= abs(reach)) return false;
  const vec3 place = height / reach * top;
  return min(dot(cross(ab, place - x[0]), across), min(dot(cross(bc, place - x[1]), across), dot(cross(ca, place - x[2]), across))) >= 0;
}

// Exact. A sphere is a capsule without length.
Gap gap_of_capsule(float half_length, float radius, mat3 x) {
  const vec3 top = vec3(0, half_length, 0);
  Gap nearest = Gap(vec3(1, 0, 0), 3e38, vec3(1, 0, 0));
  for (int end = half_length > 0 ? -1 : 1; end <= 1; end += 2) {
    const vec3 weights = -closest_to_triangle(end * top, x[0], x[1], x[2]).yzw;
    consider_way(nearest, point_at(x, weights) - end * top, weights);
  }
  if (half_length > 0) {
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const vec4 between = closest_of_edges(-top, top, x[k], x[l]);
      vec3 weights = vec3(0);
      weights[k] = -between.z;
      weights[l] = -between.w;
      consider_way(nearest, point_at(x, weights) - (between.y - between.x) * top, weights);
    }
  }
  if (nearest.size < 1e-9 || half_length > 0 && crosses(top, x)) nearest = gap_across(top, x);
  nearest.size -= radius;
  return nearest;
}

#include "triangle/round_cone_gap.glsl"

// An axis must part a box and a triangle by so much more (m) than the axes before it, so that rounding does not choose.
const float kBetter = 1e-6;

// Across the face of the box that parts them best. Of corners that are nearly as low as the lowest, each has a share.
Gap gap_of_faces(vec3 half_size, mat3 x) {
  const vec3 above = min(x[0], min(x[1], x[2])) - half_size, below = -max(x[0], max(x[1], x[2])) - half_size;
  const vec3 best = max(above, below);
  const float size = max(best.x, max(best.y, best.z));
  vec3 normal = size == best.y ? vec3(0, 1, 0) : size == best.x ? vec3(1, 0, 0) : vec3(0, 0, 1);
  if (dot(normal, above) < size) normal = -normal;
  const vec3 heights = normal * x - dot(abs(normal), half_size);
  const vec3 shares = max(1 - 1e4 * (heights - size), 0);
  return Gap(normal, size, shares / (shares.x + shares.y + shares.z));
}

// Across the triangle: a corner, an edge or a face of the box touches its inside.
void consider_inside(inout Gap best, vec3 half_size, mat3 x) {
  vec3 across = cross(x[1] - x[0], x[2] - x[0]);
  const float area = length(across);
  if (!(area > 1e-20)) return;
  across /= area;
  const float height = dot(across, x[0]), size = abs(height) - dot(abs(across), half_size);
  if (size <= best.size + kBetter) return;
  const vec3 normal = height < 0 ? -across : across;
  // The corner of the box that is nearest; with an edge or a face that is almost parallel, a point of that.
  const vec3 touching = half_size * clamp(16 * normal, -1, 1);
  best = Gap(normal, size, -closest_to_triangle(touching, x[0], x[1], x[2]).yzw);
}

// Across the triangle's edge from corner k and the box's edges along an axis. They touch only where the third corner is further out.
void consider_edge(inout Gap best, vec3 half_size, mat3 x, int k, vec3 axis) {
  const int l = (k + 1) % 3, m = (k + 2) % 3;
  const vec3 edge = x[l] - x[k];
  vec3 normal = cross(edge, axis);
  const float len = length(normal);
  if (!(len > 1e-4 * length(edge))) return;
  normal /= len;
  if (dot(normal, x[m] - x[k]) < 0) normal = -normal;
  const float size = dot(normal, x[k]) - dot(abs(normal), half_size);
  if (size <= best.size + kBetter) return;
  const vec3 beside = half_size * sign(normal) - x[k], along = edge - dot(edge, axis) * axis;
  vec3 weights = vec3(0);
  weights[l] = clamp(dot(beside, along) / max(dot(along, along), 1e-30), 0, 1);
  weights[k] = 1 - weights[l];
  best = Gap(normal, size, weights);
}

// Of the thirteen axes that can part a box from a triangle the one that parts them best, or along which the way out is shortest
// (Gottschalk, Lin, Manocha 1996). Exact where they overlap; where they do not, never more than their distance.
Gap gap_of_box(vec3 half_size, mat3 x) {
  Gap best = gap_of_faces(half_size, x);
  consider_inside(best, half_size, x);
  for (int k = 0; k < 3; ++k) {
    consider_edge(best, half_size, x, k, vec3(1, 0, 0));
    consider_edge(best, half_size, x, k, vec3(0, 1, 0));
    consider_edge(best, half_size, x, k, vec3(0, 0, 1));
  }
  return best;
}

Gap gap_of(Body body, mat3 x) {
  if (body.radius > 0) return has_tapered ? gap_of_round_cone(body, x) : gap_of_capsule(body.half_size.y, body.radius, x);
  return gap_of_box(body.half_size, x);
}
