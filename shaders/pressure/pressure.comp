// pressure: the impulse of the gas in a closed cloth, and what it gives to the cloth's particles. A workgroup a part of the cloth, of which
// each adds up what all parts have found (pressure_volume), in the same order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(gas_gradients)
READ(Gas, gases)
READ(GasPart, gas_parts)
READ(GasSum, gas_sums)
READ(float, gas_amounts)
WRITE(GasState, gas_states)

#include "motion/force.glsl"
#include "pressure/sum.glsl"
#include "pressure/gas.glsl"

shared float impulse;

void main() {
  const GasPart part = gas_parts[gl_WorkGroupID.x];
  const Gas gas = gases[part.gas];
  vec4 sum = vec4(0);
  for (uint k = gl_LocalInvocationID.x; k < gas.parts; k += gl_WorkGroupSize.x) {
    const GasSum found = gas_sums[gas.first_part + k];
    sum = joined(sum, vec4(found.volume, found.predicted, found.mobility, found.longest));
  }
  sum = sum_of_group(sum);
  if (gl_LocalInvocationID.x == 0) {
    const GasSum whole = GasSum(sum.x, sum.y, sum.z, sum.w, gas_sums[gas.first_part].before);
    const GasStep step = gas_step(gas, gas_amounts[gas.cloth], whole, motion.h);
    impulse = step.impulse;
    if (gl_WorkGroupID.x == gas.first_part) gas_states[part.gas] = step.after;
  }
  barrier();
  for (uint k = gl_LocalInvocationID.x; k < part.count; k += gl_WorkGroupSize.x) {
    const uint i = part.particle + k;
    add_velocity(i, FETCH(positions, i).w * impulse * FETCH(gas_gradients, part.first + k).xyz);
  }
}
