// What colliders leave to a particle in an implicit substep: the filter of Baraff and Witkin (1998, section 5.3). A particle whose
// free flight would end inside a collider is led to its surface instead; the direction across is decided with that, and the solve
// has no part in it. Not where the springs would take the particle off by themselves, as far as it can tell with its neighbours in free flight.
//
// `walls` has two entries a particle: the filter and the change of its free flight (m/s). The springs are told of that change
// (implicit_meet.comp), the particle gets it from settle, which puts it out of the collider again and knows friction.

#include "implicit/implicit_filter.glsl"
#include "collide/colliders.glsl"

struct Wall {
  vec4 open;      // the filter
  vec3 change;    // m/s
};

// Takes a further direction, of those that are left, away.
vec4 closed(vec4 open, vec3 direction) {
  if (open.w == 0) return vec4(0);
  return open.xyz == vec3(0) ? vec4(direction, 1) : vec4(normalize(cross(open.xyz, direction)), 0);
}

vec3 out_of_collider(uint k, Visit visit, vec3 p) {
  if (k < planes) return out_of_plane(colliders[k], visit, p);
  if (k < planes + spheres) return out_of_sphere(colliders[k], visit, p);
  if (k < planes + spheres + capsules) return out_of_capsule(colliders[k], visit, p);
  return out_of_box(colliders[k], visit, p);
}

// x, free flight v, and `pushed`, what the springs would change it by (m/s).
Wall wall_at(vec3 x, vec3 v, vec4 material, vec3 pushed) {
  const Visit visit = Visit(push.fraction_from, push.fraction_to, x, material.z, 0);
  Wall wall = Wall(vec4(0, 0, 0, 1), vec3(0));
  for (uint k = 0; k < planes + spheres + capsules + boxes; ++k) {
    const vec3 p = x + motion.h * (v + wall.change), way_out = out_of_collider(k, visit, p) - p;
    const float depth = length(way_out), change = motion.inverse_h * depth;
    const vec3 normal = way_out / max(depth, 1e-20);
    // In a corner only along what the walls before have left.
    const vec3 left = opened(wall.open, normal);
    const float squared = dot(left, left);
    if (depth > 0 && change > dot(normal, pushed) && squared > 1e-6) {
      wall.change += change / squared * left;
      wall.open = closed(wall.open, left * inversesqrt(squared));
    }
  }
  return wall;
}
