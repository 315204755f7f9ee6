// bend_gather: every particle sums the impulses of its bending stencils: dp_i = sum_e w_i K_i dlambda_e (bend/gather.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER(bend_impulses)
GATHER_UINT2(bend_use_rows)
GATHER_UINT4(bend_uses)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#define IMPULSE(k) FETCH(bend_impulses, k)
#define ROW(i) FETCH_UINT2(bend_use_rows, i)
#define USES(k) FETCH(bend_uses, k)
#include "bend/gather.glsl"
