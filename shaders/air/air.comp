// air: the force of the air on the triangles about a particle, a third of each, with the particle's own velocity. With u the air's velocity
// against it, N a triangle's normal and c = N . u / |u|, the cosine of the angle between them,
//     F = 1/2 rho A |u| ( (C_drag c^2 + C_friction (1 - c^2)) u + C_lift c (|u| N - c u) ):
// drag along the wind, as of a plate between broadside and edge on, and lift across it (Ling 1997; Wejchert and Haumann 1991 have the
// part along N). It does not matter which of its two sides N is of, nothing has an edge where the plate turns through the wind, and F . u
// is never below 0: no triangle gains from the air more than the wind gives. A is the rest area, so that cloth that is stretched is not
// blown further, and stretched the more. N is of triangles that are wider than the mesh's, since the air evens out (engine/effects/air/fans.cpp).
//
// Fetching what lies about a particle is what it costs, and the air is slow to change: it is looked at in every n-th substep, and pushes
// for a time of t = n h. u is that of the velocity that cloth has in the mean over these if gravity alone goes on: before this substep's
// gravity with n = 1. A sheet then falls at its terminal velocity to the second order of t. With S the sum of rho A |u| C / 6 over the
// triangles, C being the most that a part of u can meet, the particle would lose b = t w S of its velocity against the air at most, and if
// b is above 1 that would be turned round, and the more so the faster it is. So the change is divided by sqrt(1 + b^2), with which it
// cannot, whatever wind and rate are; that too is 1 to the second order of t.
//
// In second order in time (bdf2/bdf2.glsl) a push is of 2/3 t, and half as much again comes of it in the substeps after it. The velocity of a
// substep is then by another part of gravity ahead of the mean: at terminal velocity, where pushes and gravity repeat with period n, by
// h g (n/2 + n / (3 (3^n - 1))) instead of h g (n + 1) / 2.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(air_rows)
GATHER_UINT4(air_fans)
GATHER(air_stirred)

#include "motion/force.glsl"

vec3 air_about(uint i) {
  if (air_wave_count + air_field_count == 0 && !has_lee) return air.wind;
  return air.wind + mix(FETCH(air_stirred, 2 * i).xyz, FETCH(air_stirred, 2 * i + 1).xyz, push.fraction_from);
}

// Over h g.
float ahead_of_mean() {
  const float n = float(air_every);
  return is_second_order ? 0.5 * n + n / (3 * (pow(3, n) - 1)) : 0.5 * float(air_every + 1);
}

// Sums over a particle's triangles, a third of each (m^2): A; A (N . u)^2; A (N . u) N.
vec3 u, along_normals = vec3(0);
float area = 0, squares = 0;

// `third`: of a triangle's rest area; a, b: its sides from the particle on.
void add_triangle(float third, vec3 a, vec3 b) {
  const vec3 across = cross(a, b);
  const float squared_length = dot(across, across), along = dot(across, u);
  // A neighbour that is not finite must not spoil this particle.
  const float share = squared_length > 1e-30 && squared_length < 1e20 ? third / squared_length * along : 0;
  along_normals += share * across;
  squares += share * along;
  area += third;
}

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uvec2 row = air_stride > 0 ? uvec2(i * air_stride, air_stride) : FETCH_UINT2(air_rows, i);
  const vec4 x = FETCH(positions, i);
  u = air_about(i) - (FETCH(velocities, i).xyz - ahead_of_mean() * motion.substep * motion.gravity);
  vec3 before = vec3(0);
  for (uint k = row.x; k < row.x + row.y; ++k) {
    const uvec4 pair = FETCH(air_fans, k);
    const vec3 first = FETCH(positions, pair.x).xyz - x.xyz, second = FETCH(positions, pair.z).xyz - x.xyz;
    add_triangle(uintBitsToFloat(pair.y), before, first);
    add_triangle(uintBitsToFloat(pair.w), first, second);
    before = second;
  }
  const float squared_speed = dot(u, u), speed = sqrt(squared_speed);
  const float along_wind = air.friction * area + (air.drag - air.friction - air.lift) * squares / max(squared_speed, 1e-30);
  const float share = float(air_every) * motion.h * x.w * air.half_density * speed, most = (is_second_order ? 1.5 : 1) * share * area * air.most;
  add_velocity(i, (share / sqrt(1 + most * most)) * (along_wind * u + air.lift * along_normals));
}
