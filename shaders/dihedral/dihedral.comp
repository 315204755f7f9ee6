// dihedral: bending about a rest angle, for cloth with folds and curves of its own. Writes the impulses of every dihedral element;
// dihedral_gather sums them by particle.
//
//        2        The edge (0, 1), the hinge, and its opposite vertices. The arms r2, r3 lead from the hinge to these, at right angles
//       /|        to it: their feet are at the fractions s2 and s3 from 0 to 1. With the unit edge e the dihedral angle, 0 where flat, is
//      / | r2          phi = atan2(-e . (r2 x r3), -r2 . r3),
//     0--+---1    and its gradients (Bridson, Marino, Fedkiw 2003, "Simulation of clothing with folds and wrinkles")
//      \ | r3          g2 = -(e x r2) / |r2|^2,  g3 = (e x r3) / |r3|^2,  g0 = (s2 - 1) g2 + (s3 - 1) g3,  g1 = -s2 g2 - s3 g3.
//       \|        They sum to 0, and so do their moments: momentum is conserved. No pose of the two triangles is singular, not even flat
//        3        or closed; only a triangle without a height has no angle, and then the element does nothing.
//
// XPBD on C = phi - phi_rest (Macklin et al. 2016, eq. 18). The sine and the cosine of C follow from those of phi and of phi_rest, so that
// C comes out between -pi and pi: the cloth returns by the shorter way, through the closed pose if need be. Subtracted angles would make
// the energy C^2 / 2 alpha jump at the closed pose; this way it has no jump in any pose, and no state beyond the pose has to be kept.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
READ(Hinge, hinges)
READ_WRITE(vec4, hinge_impulses)

// An edge below `shortest` counts as ends at one place (engine/fabric.cpp), and a height of the size of its rounding error has no
// direction.
const float shortest = 1e-8, rounded = 1e-6;   // m; relative to the distance of the vertex

struct Dihedral {
  float c;                  // rad, C
  vec3 g0, g1, g2, g3;      // 1/m
  bool usable;
};

Dihedral dihedral_of(Hinge element) {
  // Only differences enter, so that the distance from the origin costs no precision.
  const vec3 origin = FETCH(predicted, element.particle[0]).xyz;
  const vec3 edge = FETCH(predicted, element.particle[1]).xyz - origin;
  const vec3 d2 = FETCH(predicted, element.particle[2]).xyz - origin, d3 = FETCH(predicted, element.particle[3]).xyz - origin;
  const float squared = dot(edge, edge), inverse = 1 / max(squared, shortest * shortest);
  const vec3 e = sqrt(inverse) * edge;
  const float s2 = inverse * dot(edge, d2), s3 = inverse * dot(edge, d3);
  const vec3 r2 = d2 - s2 * edge, r3 = d3 - s3 * edge;
  const float height2 = dot(r2, r2), height3 = dot(r3, r3);
  const float least2 = max(rounded * rounded * dot(d2, d2), shortest * shortest);
  const float least3 = max(rounded * rounded * dot(d3, d3), shortest * shortest);
  const float sine = -dot(e, cross(r2, r3)), cosine = -dot(r2, r3);
  Dihedral b;
  b.c = atan(sine * element.rest_cosine - cosine * element.rest_sine, cosine * element.rest_cosine + sine * element.rest_sine);
  b.g2 = cross(r2, e) / max(height2, least2);
  b.g3 = cross(e, r3) / max(height3, least3);
  b.g0 = (s2 - 1) * b.g2 + (s3 - 1) * b.g3;
  b.g1 = -s2 * b.g2 - s3 * b.g3;
  // Comparisons with NaN are false.
  b.usable = squared > shortest * shortest && height2 > least2 && height3 > least3 && squared + dot(d2, d2) + dot(d3, d3) < 1e20;
  return b;
}

float change_of_lambda(Hinge element, Dihedral b, float lambda) {
  const float weight = element.weight[0] * dot(b.g0, b.g0) + element.weight[1] * dot(b.g1, b.g1) + element.weight[2] * dot(b.g2, b.g2) +
                       element.weight[3] * dot(b.g3, b.g3);
  const float alpha = element.compliance * motion.inverse_h2;
  return -motion.relaxation * (b.c + alpha * lambda) / max(weight + motion.relaxation * alpha, 1e-20);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Hinge element = hinges[i];
  const Dihedral b = dihedral_of(element);
  const float lambda = (push.flags & WEFT_FIRST_ITERATION) != 0 ? 0 : hinge_impulses[4 * i].w;
  const float change = change_of_lambda(element, b, lambda);
  // A particle that is not finite must not spoil the others.
  const float largest = abs(change) * max(max(length(b.g0), length(b.g1)), max(length(b.g2), length(b.g3)));
  const bool good = b.usable && largest < 1e10 && abs(change) < 1e20;
  hinge_impulses[4 * i] = good ? vec4(change * b.g0, lambda + change) : vec4(0, 0, 0, lambda);
  hinge_impulses[4 * i + 1] = good ? vec4(change * b.g1, 0) : vec4(0);
  hinge_impulses[4 * i + 2] = good ? vec4(change * b.g2, 0) : vec4(0);
  hinge_impulses[4 * i + 3] = good ? vec4(change * b.g3, 0) : vec4(0);
}
