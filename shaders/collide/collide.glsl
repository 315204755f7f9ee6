// Colliders as signed distances. A particle inside is put out along the gradient (projection); one that a fast collider passed over within
// the substep is found by continuous detection and put out too. Coulomb friction: the tangential motion relative to the surface is reduced
// by at most mu times the depth that was corrected.
//
// Capsules and boxes are handled in their own axes, in which they stand still: there the particle moved straight from a to b. Such a body
// is two functions: its distance with the gradient, and the first entry of a segment that begins outside.

// A particle and the substep, as colliders need them.
struct Particle {
  float from, to;      // the substep, as fractions of the frame
  vec3 x;              // m, at the substep's start
  float thickness;     // m
  float friction;      // Coulomb, the cloth's
};

struct Surface {
  vec3 point;    // m, of the collider at the substep's end: centre
  vec3 normal;   // planes
  vec3 moved;    // m, motion of the centre in this substep
  vec3 spin;     // rad in this substep
  float friction;   // of the pair
};

// Exact to the bit where from == to, whatever the fraction (mix does not promise that).
vec3 between(vec3 from, vec3 to, float fraction) { return from + fraction * (to - from); }

Surface surface_at(Collider collider, Particle v) {
  Surface s;
  s.point = v.to == 1 ? collider.centre_to : between(collider.centre_from, collider.centre_to, v.to);
  s.moved = (v.to - v.from) * (collider.centre_to - collider.centre_from);
  s.normal = normalize(between(collider.normal_from, collider.normal_to, v.to));
  s.spin = (v.to - v.from) * collider.spin;
  s.friction = sqrt(collider.friction * v.friction);
  return s;
}

// m, of the particle at hand: how far the last collider that it met has put it out, and what of its steps into colliders the solve has held
// back, outwards (support.glsl). In passes of contacts nothing is, as finalize has counted it.
vec3 last_put_out = vec3(0);
vec3 held = vec3(0);

// Coulomb friction: reduces the tangential part of the motion from x to p relative to a surface that itself moved by `carried`, by `depth`,
// which was corrected along the normal, and by what is held besides.
vec3 with_friction(vec3 x, vec3 p, vec3 carried, vec3 normal, float depth, float friction) {
  last_put_out = depth * normal;
  const float pressed = has_supports ? max(depth + dot(held, normal), 0) : depth;
  const vec3 motion = p - x - carried;
  const vec3 slip = motion - dot(motion, normal) * normal;
  const float len = length(slip);
  return len > 1e-12 ? p - min(1, friction * pressed / len) * slip : p;
}

vec3 out_of_plane(Collider collider, Particle v, vec3 p) {
  const Surface s = surface_at(collider, v);
  const float depth = v.thickness - dot(p - s.point, s.normal);
  if (depth <= 0) return p;
  p += depth * s.normal;
  return with_friction(v.x, p, s.moved + cross(s.spin, p - s.point), s.normal, depth, s.friction);
}

vec3 out_of_sphere(Collider collider, Particle v, vec3 p) {
  const Surface s = surface_at(collider, v);
  const float radius = collider.radius + v.thickness;
  vec3 at = p - s.point;
  if (dot(at, at) >= radius * radius) {
    // Relative to the sphere the particle moved from `start` to `at`. Did it pass through?
    const vec3 start = v.x - (s.point - s.moved);
    const vec3 segment = at - start;
    const float t = clamp(-dot(start, segment) / max(dot(segment, segment), 1e-20), 0, 1);
    const vec3 nearest = start + t * segment;
    if (dot(start, start) < radius * radius || dot(nearest, nearest) >= radius * radius || t == 1) return p;
    at = nearest;
  }
  const float len = length(at);
  const vec3 normal = len > 1e-9 ? at / len : vec3(0, 1, 0);
  const float depth = radius - len;
  p = s.point + radius * normal;
  return with_friction(v.x, p, s.moved + cross(s.spin, radius * normal), normal, depth, s.friction);
}

// A rotation as a unit quaternion, the real part last.
vec3 rotate(vec4 q, vec3 v) {
  const vec3 t = 2 * cross(q.xyz, v);
  return v + q.w * t + cross(q.xyz, t);
}

vec4 inverse_of(vec4 q) { return vec4(-q.xyz, q.w); }

vec4 rotation_at(Collider collider, float fraction) {
  const float angle = fraction * length(collider.spin);
  // Below 1e-4 rad sin(x/2)/x is 1/2 to the last bit.
  const vec4 rotation = vec4((angle > 1e-4 ? fraction * sin(0.5 * angle) / angle : 0.5 * fraction) * collider.spin, cos(0.5 * angle));
  const vec4 q = collider.rotation_from;
  return vec4(rotation.w * q.xyz + q.w * rotation.xyz + cross(rotation.xyz, q.xyz), rotation.w * q.w - dot(rotation.xyz, q.xyz));
}

// A distance or an entry, with its normal. The fraction of an entry is at most 1, or kNever.
struct Hit {
  vec3 normal;   // unit, in the body's axes
  float at;      // a distance (m), or a fraction of the segment
};

const float kNever = 2;

Hit capsule_distance(Collider c, vec3 p) {
  const vec3 d = p - vec3(0, clamp(p.y, -c.half_size.y, c.half_size.y), 0);
  const float len = length(d);
  return Hit(len > 1e-9 ? d / len : vec3(1, 0, 0), len - c.radius);
}

// The first t with |a + t segment| = radius: half a chord before the point that is nearest to 0. This avoids the cancellation of large
// squares in the quadratic formula.
float entry_root(vec3 a, vec3 segment, float radius) {
  const float squared = dot(segment, segment), t = -dot(a, segment) / max(squared, 1e-20);
  const vec3 nearest = a + t * segment;
  const float half_chord = radius * radius - dot(nearest, nearest);
  return squared > 0 && half_chord >= 0 ? t - sqrt(half_chord / squared) : kNever;
}

// The entry into the cylinder, if it is between the ends; otherwise into the sphere at the end beyond which the segment meets the cylinder,
// or beyond which it begins if it runs along the axis.
Hit capsule_entry(Collider c, vec3 a, vec3 segment) {
  const float half_length = c.half_size.y;
  float t = entry_root(vec3(a.x, 0, a.z), vec3(segment.x, 0, segment.z), c.radius);
  const float y = t == kNever ? a.y : a.y + t * segment.y;
  if (abs(y) > half_length) {
    const vec3 from_end = a - vec3(0, sign(y) * half_length, 0);
    t = entry_root(from_end, segment, c.radius);
  }
  if (!(t >= 0 && t < 1)) return Hit(vec3(0), kNever);
  const vec3 p = a + t * segment;
  return Hit((p - vec3(0, clamp(p.y, -half_length, half_length), 0)) / c.radius, t);
}

#include "collide/round_cone.glsl"

Hit box_distance(Collider c, vec3 p) {
  const vec3 q = abs(p) - c.half_size, side = vec3(p.x < 0 ? -1 : 1, p.y < 0 ? -1 : 1, p.z < 0 ? -1 : 1);
  const vec3 outside = max(q, 0);
  const float len = length(outside);
  if (len > 0) return Hit(side * outside / len, len);
  const float deepest = max(q.x, max(q.y, q.z));   // inside: out through the nearest face
  return Hit(side * (q.x == deepest ? vec3(1, 0, 0) : q.y == deepest ? vec3(0, 1, 0) : vec3(0, 0, 1)), deepest);
}

// Slab test: the segment is between the two faces of each axis for an interval; it is inside from the last begin to the first end.
Hit box_entry(Collider c, vec3 a, vec3 segment) {
  const vec3 towards = vec3(segment.x < 0 ? -1 : 1, segment.y < 0 ? -1 : 1, segment.z < 0 ? -1 : 1);
  const vec3 slope = towards / max(abs(segment), 1e-20);
  const vec3 begin = (-towards * c.half_size - a) * slope, end = (towards * c.half_size - a) * slope;
  const float t = max(begin.x, max(begin.y, begin.z));
  if (t < 0 || t >= 1 || t > min(end.x, min(end.y, end.z))) return Hit(vec3(0), kNever);
  return Hit(-towards * (t == begin.x ? vec3(1, 0, 0) : t == begin.y ? vec3(0, 1, 0) : vec3(0, 0, 1)), t);
}

// A body at the substep's start and end.
struct Pose {
  vec4 rotation_from, rotation_to;
  vec3 centre_from, centre_to;
};

Pose pose_of(Collider collider, Surface s, float from, float to) {
  return Pose(rotation_at(collider, from), rotation_at(collider, to), s.point - s.moved, s.point);
}

// A particle in the body's axes: a at the substep's start, b at its end.
struct Relative {
  Pose pose;
  vec3 a, b;
};

vec3 at_start(Pose pose, vec3 x) { return rotate(inverse_of(pose.rotation_from), x - pose.centre_from); }
vec3 at_end(Pose pose, vec3 p) { return rotate(inverse_of(pose.rotation_to), p - pose.centre_to); }

Relative relative_to_body(Collider collider, Surface s, Particle v, vec3 p) {
  const Pose pose = pose_of(collider, s, v.from, v.to);
  return Relative(pose, at_start(pose, v.x), at_end(pose, p));
}

// A particle that entered, and either left again or is past the middle, is kept in front of the tangent plane at its entry: the nearest way
// out would let it pass through. Any other is put out by the nearest way.
vec3 out_of_body(Relative r, Hit here, Hit entry, Particle v, vec3 p, float friction) {
  if (entry.at < 1 && (here.at >= v.thickness || dot(here.normal, entry.normal) <= 0))
    here = Hit(entry.normal, (1 - entry.at) * dot(r.b - r.a, entry.normal));
  const float depth = v.thickness - here.at;
  if (depth <= 0) return p;
  const vec3 local = r.b + depth * here.normal;
  p = r.pose.centre_to + rotate(r.pose.rotation_to, local);
  const vec3 carried = p - (r.pose.centre_from + rotate(r.pose.rotation_from, local));
  return with_friction(v.x, p, carried, rotate(r.pose.rotation_to, here.normal), depth, friction);
}

vec3 out_of_capsule(Collider collider, Particle v, vec3 p) {
  const Surface s = surface_at(collider, v);
  const Relative r = relative_to_body(collider, s, v, p);
  if (has_tapered) {
    const Hit here = round_cone_distance(collider.radius, collider.half_size, r.b);
    return out_of_body(r, here, round_cone_entry(collider.radius, collider.half_size, r.a, r.b - r.a), v, p, s.friction);
  }
  return out_of_body(r, capsule_distance(collider, r.b), capsule_entry(collider, r.a, r.b - r.a), v, p, s.friction);
}

// One that grows comes at the particle by all its faces: the particle keeps its place by them, and moves by what it lags behind.
vec3 out_of_box(Collider collider, vec3 growth, Particle v, vec3 p) {
  const Surface s = surface_at(collider, v);
  Relative r = relative_to_body(collider, s, v, p);
  if (resizes) r.a *= growth;
  return out_of_body(r, box_distance(collider, r.b), box_entry(collider, r.a, r.b - r.a), v, p, s.friction);
}
