// Makes the collider filter of a particle in an implicit substep (Baraff and Witkin 1998, section 5.3). Where the free flight would end
// inside a collider it is changed so that it ends on the surface, and the direction across the surface is constrained: the solve does not
// change it. Not where the springs would take the particle off by themselves, judged with its neighbours in free flight.
//
// `collider_filters` has two entries a particle: the filter; and the change of its free flight (m/s), w the trace of its springs' block over
// its mass. implicit_filter.comp tells the springs
// of that change; the particle itself gets it from finalize, which puts it out of the collider again and adds friction.

#include "implicit/implicit_filter.glsl"
#include "collide/colliders.glsl"

struct ColliderFilter {
  vec4 directions;   // n and s of implicit_filter.glsl
  vec3 change;       // m/s, of the free flight
};

// The filter with one more direction constrained, which must be one that was free.
vec4 without(vec4 directions, vec3 direction) {
  if (directions.w == 0) return vec4(0);
  return directions.xyz == vec3(0) ? vec4(direction, 1) : vec4(normalize(cross(directions.xyz, direction)), 0);
}

vec3 out_of_collider(uint k, Particle particle, vec3 p) {
  if (k < planes) return out_of_plane(colliders[k], particle, p);
  if (k < planes + spheres) return out_of_sphere(collider_at(k, particle.to), particle, p);
  if (k < planes + spheres + capsules) return out_of_capsule(collider_at(k, particle.to), particle, p);
  return out_of_box(collider_at(k, particle.to), growth_of(k, particle.from, particle.to), particle, p);
}

// x, the velocity v of the free flight, and `pushed`, the change of v by the springs (m/s).
ColliderFilter filter_at(vec3 x, vec3 v, vec4 material, vec3 pushed) {
  const Particle particle = Particle(push.fraction_from, push.fraction_to, x, material.z, 0);
  ColliderFilter result = ColliderFilter(vec4(0, 0, 0, 1), vec3(0));
  for (uint k = 0; k < kBodies; ++k) {
    if (!meets_body(material, k)) continue;
    const vec3 p = x + motion.h * (v + result.change), way_out = out_of_collider(k, particle, p) - p;
    const float depth = length(way_out), change = motion.inverse_h * depth;
    const vec3 normal = way_out / max(depth, 1e-20);
    // In a corner only along the directions that earlier colliders have left free.
    const vec3 left = apply_filter(result.directions, normal);
    const float squared = dot(left, left);
    if (depth > 0 && change > dot(normal, pushed) && squared > 1e-6) {
      result.change += change / squared * left;
      result.directions = without(result.directions, left * inversesqrt(squared));
    }
  }
  return result;
}
