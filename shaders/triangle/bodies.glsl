// bodies: spheres, capsules and boxes as triangles meet them: convex, in axes of their own. Needs push.

#include "collide/colliders.glsl"

struct Body {
  Pose pose;
  vec3 half_size;   // m: half a box's sides; y: half a capsule's length, x and z as Collider has them
  float radius;     // m; 0: a box
  float friction;   // of the pair
  uint number;      // counted from 1, without planes
};

// Those that triangles collide with: boxes, and round ones where some are too small for the cells of cloth.
const uint first_body = triangles_collide == 2 ? 0 : spheres + capsules, last_body = spheres + capsules + boxes;

Body body_at(uint k, Particle v) {
  const Collider collider = collider_at(planes + k, v.to);
  const Surface s = surface_at(collider, v);
  const bool is_sphere = k < spheres, is_box = k >= spheres + capsules;
  return Body(pose_of(collider, s, v.from, v.to), is_sphere ? vec3(0) : collider.half_size, is_box ? 0 : collider.radius, s.friction,
              k + 1);
}

// Of cloth `material`, in this substep.
Particle particle_of(vec4 material) { return Particle(push.fraction_from, push.fraction_to, vec3(0), material.z, material.y); }

vec4 material_of(uint particle) { return FETCH(materials, floatBitsToUint(FETCH(velocities, particle).w)); }

// Where maps vary the cloth, the thinnest and the smoothest of the corners': vertices keep their own distances.
vec4 material_of_triangle(uvec3 corner) {
  const vec4 material = material_of(corner.x);
  return has_maps ? min(material, min(material_of(corner.y), material_of(corner.z))) : material;
}

// How near triangles may come (m): nearer than vertices, so that where these lie on a body triangles have nothing to do.
float separation_of(vec4 material) { return 0.9 * material.z; }

vec3 from_axis(Body body, vec3 p) {
  float height = clamp(p.y, -body.half_size.y, body.half_size.y);
  if (has_tapered) height = nearest_height(body.half_size, p);
  return p - vec3(0, height, 0);
}

// How far the body extends in the direction n (m).
float support_of(Body body, vec3 n) {
  float support = body.radius > 0 ? body.half_size.y * abs(n.y) + body.radius : dot(abs(n), body.half_size);
  if (has_tapered && body.radius > 0)   // the farther of the ends' spheres
    support = body.half_size.x * n.y + body.half_size.y * abs(n.y - body.half_size.z) + body.radius;
  return support;
}

// Unit: from the body to p, or across the box's face that is nearest.
vec3 direction_to(Body body, vec3 p) {
  const vec3 d = from_axis(body, p), q = abs(p) - body.half_size;
  const float len = length(d), most = max(q.x, max(q.y, q.z));
  const vec3 axis = most == q.y ? vec3(0, 1, 0) : most == q.x ? vec3(1, 0, 0) : vec3(0, 0, 1);
  return body.radius == 0 ? (dot(axis, p) < 0 ? -axis : axis) : len > 1e-9 ? d / len : vec3(1, 0, 0);
}

// Of a point outside (m); of one inside a box at most 0.
float distance_to(Body body, vec3 p) {
  float radius = body.radius;
  if (has_tapered) radius = radius_at(body.radius, body.half_size, nearest_height(body.half_size, p));
  return body.radius > 0 ? length(from_axis(body, p)) - radius : length(max(abs(p) - body.half_size, 0));
}
