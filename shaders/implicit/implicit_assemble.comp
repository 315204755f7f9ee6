// implicit_assemble: the linear system of an implicit substep (Baraff and Witkin 1998, eq. 6) for the change of the velocities
// against the free flight v* that predict made:
//     (M + h D + h^2 K) dv = h f(x, v*) - h^2 K v*
//
// A spring between i and j, n from j to i, pushes with -k (l - L) n - c (n . u) n, u = v_i - v_j. Its block h^2 K + h D is
// a I + b n n^T: across it a = h^2 k max(0, 1 - L/l), which leaves out what makes the matrix indefinite under compression
// (Choi and Ko 2002), along it a + b = h^2 k + h c. It is stored as sqrt(b) n and a, four numbers instead of nine.
//
// A spring of rest length 0 is linear, of either sign (the bending matrix), and has no direction.
//
// Where colliders constrain a direction (implicit_collide.glsl) the diagonal block becomes S D S + m (I - S), so that its inverse maps free
// directions to free directions.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER(predicted)
GATHER(materials)
GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(springs)
WRITE(vec4, spring_blocks)
WRITE(vec4, inverses)
WRITE(vec4, exchanged)
WRITE(vec4, solve_vectors)
READ_WRITE(Counters, counters)
WRITE(vec4, collider_filters)

#include "implicit/implicit.glsl"
#include "implicit/implicit_collide.glsl"

uint coincident = 0;

// What a particle's springs add up to.
struct Sums {
  vec3 impulse;    // kg m/s: h f - h^2 K v*
  vec3 diagonal;   // kg: xx, yy, zz
  vec3 below;      // kg: yx, zx, zy
};

// The velocity of a kinematic particle is the one that takes it to its target.
vec3 free_flight(uint i, vec4 x) {
  return x.w == 0 ? motion.inverse_h * (FETCH(predicted, i).xyz - x.xyz) : FETCH(velocities, i).xyz;
}

void add_spring(uint other, vec4 spring, vec3 x, vec3 v, uint place, inout Sums sums) {
  const vec4 y = FETCH(positions, other);
  const vec3 d = x - y.xyz, u = v - free_flight(other, y);
  const float squared = dot(d, d);
  const bool has_direction = squared > 1e-20 && spring.x > 0;
  coincident += uint(squared <= 1e-20 && spring.x > 0);
  const float inverse_length = has_direction ? inversesqrt(squared) : 0;
  const vec3 n = inverse_length * d;
  const float excess = 1 - spring.x * inverse_length;
  // No force where the spring is slack, has no direction, or a particle is not finite.
  const bool acts = (spring.x == 0 || has_direction) && !(spring.w != 0 && excess < 0) && squared < 1e20 && dot(u, u) < 1e20;
  const float k = acts ? spring.y : 0, c = acts && has_direction ? spring.z : 0;
  const float across = k * max(excess, 0), along = k - across;
  const float h = motion.h, part = dot(n, u);
  if (acts) sums.impulse -= h * (k * excess * d + c * part * n) + h * h * (across * u + along * part * n);
  const float a = h * h * across;
  const vec3 b = sqrt(max(h * h * along + h * c, 0)) * n;
  sums.diagonal += a + b * b;
  sums.below += b.xxy * b.yzz;
  spring_blocks[place] = vec4(b, a);
}

// The symmetric matrix is written out by its columns.
Sums filtered_system(Sums s, vec4 directions, float mass) {
  const mat3 d = mat3(s.diagonal.x, s.below.x, s.below.y, s.below.x, s.diagonal.y, s.below.z, s.below.y, s.below.z, s.diagonal.z);
  const mat3 filter_matrix = mat3(apply_filter(directions, vec3(1, 0, 0)), apply_filter(directions, vec3(0, 1, 0)),
                                  apply_filter(directions, vec3(0, 0, 1)));
  const mat3 filtered = filter_matrix * d * filter_matrix + mass * (mat3(1) - filter_matrix);
  return Sums(apply_filter(directions, s.impulse), vec3(filtered[0].x, filtered[1].y, filtered[2].z),
              vec3(filtered[0].y, filtered[0].z, filtered[1].z));
}

// The first guess of dv: from the free flight back to the velocity before it.
vec3 guess(uint i, vec3 v) {
  const float damping_factor = FETCH(materials, floatBitsToUint(FETCH(velocities, i).w)).x;
  return (1 / max(damping_factor, 1e-6) - 1) * v - motion.h * motion.gravity;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = FETCH(positions, i);
  const vec3 v = free_flight(i, x);
  const float weight = FETCH(predicted, i).w, mass = weight == 0 ? 0 : 1 / weight;   // heavier where a hand pulls
  Sums sums = Sums(vec3(0), vec3(mass), vec3(0));
  const uvec2 row = FETCH_UINT2(spring_rows, i);
  for (uint q = row.x; q < row.x + row.y; ++q) {
    const uvec4 ends = FETCH(spring_ends, q);
    add_spring(ends.x, FETCH(springs, 4 * q), x.xyz, v, 4 * q, sums);
    add_spring(ends.y, FETCH(springs, 4 * q + 1), x.xyz, v, 4 * q + 1, sums);
    add_spring(ends.z, FETCH(springs, 4 * q + 2), x.xyz, v, 4 * q + 2, sums);
    add_spring(ends.w, FETCH(springs, 4 * q + 3), x.xyz, v, 4 * q + 3, sums);
  }
  if (coincident > 0) atomicAdd(counters[0].coincident, coincident);
  // Kinematic particles take no part, nor do particles that are not finite.
  vec3 start = mass > 0 ? guess(i, v) : vec3(0);
  const bool free = mass > 0 && dot(x.xyz, x.xyz) < 1e20 && dot(start, start) < 1e20;
  Inverse inverse = factor_of(sums.diagonal, sums.below, mass);
  if (has_colliders) {
    ColliderFilter collider = ColliderFilter(vec4(0), vec3(0));
    if (free)
      collider = filter_at(x.xyz, v, FETCH(materials, floatBitsToUint(FETCH(velocities, i).w)), preconditioned(inverse, sums.impulse));
    collider_filters[2 * i] = collider.directions;
    const float stiffness = sums.diagonal.x + sums.diagonal.y + sums.diagonal.z - 3 * mass;
    collider_filters[2 * i + 1] = vec4(collider.change, mass > 0 ? stiffness / mass : 0);
    sums = filtered_system(sums, collider.directions, mass);
    start = apply_filter(collider.directions, start);
    inverse = factor_of(sums.diagonal, sums.below, mass);
  }
  inverses[2 * i] = free ? vec4(inverse.diagonal, mass) : vec4(0);
  inverses[2 * i + 1] = free ? vec4(inverse.below, 0) : vec4(0);
  solve_vectors[i] = vec4(free ? sums.impulse : vec3(0), 0);
  exchanged[i] = vec4(free ? start : vec3(0), 0);
}
