// Colliders as signed distances: whatever its history, a particle inside is put out along the gradient, and a particle that
// a fast collider ran past within the substep is caught on the way. Friction after Coulomb: the tangential motion relative
// to the surface is shortened by at most mu times the depth that was corrected.

struct Surface {
  vec3 point;    // m, of the collider at the substep's end: centre
  vec3 normal;   // planes
  vec3 moved;    // m, motion of the centre in this substep
  vec3 spin;     // rad in this substep
};

// Written so that what does not move stays to the bit, whatever the fraction (mix does not promise that).
vec3 between(vec3 from, vec3 to, float fraction) { return from + fraction * (to - from); }

Surface surface_at(Collider collider, float from, float to) {
  Surface s;
  s.point = to == 1 ? collider.centre_to : between(collider.centre_from, collider.centre_to, to);
  s.moved = (to - from) * (collider.centre_to - collider.centre_from);
  s.normal = normalize(between(collider.normal_from, collider.normal_to, to));
  s.spin = (to - from) * collider.spin;
  return s;
}

// Shortens the tangential part of the motion from x to p over a surface that itself moved by `carried`.
vec3 rub(vec3 x, vec3 p, vec3 carried, vec3 normal, float depth, float friction) {
  const vec3 motion = p - x - carried;
  const vec3 slip = motion - dot(motion, normal) * normal;
  const float len = length(slip);
  return len > 1e-12 ? p - min(1, friction * depth / len) * slip : p;
}

vec3 out_of_plane(Surface s, vec3 x, vec3 p, float thickness, float friction) {
  const float depth = thickness - dot(p - s.point, s.normal);
  if (depth <= 0) return p;
  p += depth * s.normal;
  return rub(x, p, s.moved + cross(s.spin, p - s.point), s.normal, depth, friction);
}

vec3 out_of_sphere(Surface s, float radius, vec3 x, vec3 p, float thickness, float friction) {
  const float reach = radius + thickness;
  vec3 at = p - s.point;
  if (dot(at, at) >= reach * reach) {
    // Seen from the sphere the particle went from `start` to `at`. Did it pass through?
    const vec3 start = x - (s.point - s.moved);
    const vec3 way = at - start;
    const float t = clamp(-dot(start, way) / max(dot(way, way), 1e-20), 0, 1);
    const vec3 nearest = start + t * way;
    if (dot(start, start) < reach * reach || dot(nearest, nearest) >= reach * reach || t == 1) return p;
    at = nearest;
  }
  const float len = length(at);
  const vec3 normal = len > 1e-9 ? at / len : vec3(0, 1, 0);
  const float depth = reach - len;
  p = s.point + reach * normal;
  return rub(x, p, s.moved + cross(s.spin, reach * normal), normal, depth, friction);
}

vec3 out_of_collider(Collider collider, float from, float to, vec3 x, vec3 p, float cloth_friction, float thickness) {
  const Surface s = surface_at(collider, from, to);
  const float friction = sqrt(collider.friction * cloth_friction);
  if (collider.shape == WEFT_PLANE) return out_of_plane(s, x, p, thickness, friction);
  return out_of_sphere(s, collider.radius, x, p, thickness, friction);
}
