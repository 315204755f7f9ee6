// dihedral_gather: every particle sums the impulses of its dihedral elements: dp_i = sum_e w_i grad_i dlambda_e (bend/gather.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER(hinge_impulses)
GATHER_UINT2(hinge_use_rows)
GATHER_UINT4(hinge_uses)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#define IMPULSE(k) FETCH(hinge_impulses, k)
#define ROW(i) FETCH_UINT2(hinge_use_rows, i)
#define USES(k) FETCH(hinge_uses, k)
#include "bend/gather.glsl"
