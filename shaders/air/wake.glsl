// wake: the lee of colliders and of cloth. Behind a body the air has lost a part of its velocity: far behind, the wake is
// that of any body, and keeps itself alike (Pope 2000, 5.4.3, the axisymmetric wake): s behind its middle the deficit falls as s^(-2/3)
// and the width grows as s^(1/3), so that the momentum that the body has taken stays. Nearer than two radii the wake is as it is there:
// all of the velocity is lost on its axis, half of it 0.6 radii off, the width of a body whose coefficient of drag is 1. The radius is that
// of a disc as large as the body is, seen along the wind; of a capsule with two radii by their mean. Cloths and mesh colliders are one such
// disc each (air_wake.comp), and no cloth is in its own lee. These discs may be thin: their wake begins over a tenth of the radius, so that
// cloth that lies on cloth does not go in and out of it at a step.

GATHER_UINT4(wake_bodies)
GATHER(wakes)

// The radius (m) of what a body shows to the wind, which goes along `way` (unit).
float shown_radius(Collider body, uint shape, vec3 way) {
  const float pi = 3.1415927;
  if (shape == 0) return body.radius;
  const vec3 d = rotate(inverse_of(body.rotation_from), way), half_size = body.half_size;
  if (shape == 1) return sqrt(body.radius * (body.radius + 4 / pi * half_size.y * length(d.xz)));
  const vec3 a = 4 * abs(d) * half_size.yzx * half_size.zxy;
  return sqrt((a.x + a.y + a.z) / pi);
}

// The part of the velocity that is lost at d from the body's middle.
float deficit_at(vec3 d, vec3 way, float radius) {
  const float behind = dot(d, way);
  if (behind <= 0 || radius <= 0) return 0;
  const float far = max(behind / (2 * radius), 1), width = 0.6 * radius * pow(far, 1.0 / 3);
  const vec3 off = d - behind * way;
  return pow(far, -2.0 / 3) * exp(-0.6931472 * dot(off, off) / (width * width));
}

float deficit_of_disc(vec3 d, vec3 way, float radius) {
  return min(1, dot(d, way) / max(0.1 * radius, 1e-20)) * deficit_at(d, way, radius);
}

// What is left of the velocity at x, of 1, behind all bodies together, at the frame's start or end; for the cloth `own`.
float lee_at(vec3 x, bool ends, uint own) {
  const float speed = length(air.wind);
  if (speed == 0) return 1;
  const vec3 way = air.wind / speed;
  float left = 1;
  if (spheres + capsules + boxes > 0)
    for (uint k = planes; k < planes + spheres + capsules + boxes; ++k) {
      const uint shape = k < planes + spheres ? 0 : k < planes + spheres + capsules ? 1 : 2;
      const Collider body = collider_at(k, ends ? 1 : 0);
      left *= 1 - deficit_at(x - (ends ? body.centre_to : body.centre_from), way, shown_radius(body, shape, way));
    }
  if (wake_count > 0)
    for (uint k = 0; k < wake_count; ++k) {
      const vec4 disc = FETCH(wakes, k);
      if (FETCH(wake_bodies, k).z != own) left *= 1 - deficit_of_disc(x - disc.xyz, way, disc.w);
    }
  return left;
}
