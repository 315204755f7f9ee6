// triangle_search: lists the triangles that a plane does not show to be clear of all bodies (triangle_collide.comp), so that the pass that
// looks closer has threads for these alone. The order of the list differs from run to run; no result depends on it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER(positions)
GATHER(velocities)
GATHER(materials)
GATHER_UINT4(triangles)
READ_WRITE(Collisions, collisions)
WRITE(uint, collision_list)

#include "triangle/bodies.glsl"

// The plane touches the body where it is nearest to the first corner, and moves with the body. The triangle is clear if it was on the
// outer side of it when the substep began (x), and is further out than its separation now (p).
bool is_clear(Body body, mat3 x, mat3 p, float separation) {
  const vec3 n = direction_to(body, at_end(body.pose, p[0]));
  const vec3 before = rotate(body.pose.rotation_from, n) * x, now = rotate(body.pose.rotation_to, n) * p;
  const float support = support_of(body, n);
  return min(before.x, min(before.y, before.z)) - dot(rotate(body.pose.rotation_from, n), body.pose.centre_from) >= support &&
         min(now.x, min(now.y, now.z)) - dot(rotate(body.pose.rotation_to, n), body.pose.centre_to) >= support + separation;
}

void list(uint triangle) {
  const uint place = atomicAdd(collisions[0].count, 1);
  collision_list[place] = triangle;
  // The first entry of a workgroup's share adds the workgroup to the dispatch.
  if (place % gl_WorkGroupSize.x == 0) atomicMax(collisions[0].groups.x, place / gl_WorkGroupSize.x + 1);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  if (i == 0) collisions[0].groups.y = collisions[0].groups.z = 1;
  const uvec3 corner = FETCH(triangles, i).xyz;
  const vec4 material = material_of_triangle(corner);
  const mat3 x = mat3(FETCH(positions, corner.x).xyz, FETCH(positions, corner.y).xyz, FETCH(positions, corner.z).xyz);
  const mat3 p = mat3(FETCH(predicted, corner.x).xyz, FETCH(predicted, corner.y).xyz, FETCH(predicted, corner.z).xyz);
  bool clear = true;
  for (uint k = first_body; k < last_body; ++k)
    if (meets_body(material, planes + k)) clear = clear && is_clear(body_at(k, particle_of(material)), x, p, separation_of(material));
  if (!clear) list(i);
}
