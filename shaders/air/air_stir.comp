// air_stir: the velocity of gusts and eddies where a particle is, when the frame begins and when it ends. Between, the air pass goes from
// one to the other in a straight line: a sine a wave in every substep would cost more than all else that air does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
READ(AirWave, air_waves)
WRITE(vec4, air_stirred)

vec3 stirred_at(vec3 x, float fraction) {
  vec3 velocity = vec3(0);
  for (uint k = 0; k < air_wave_count; ++k)
    velocity += air_waves[k].velocity * sin(dot(air_waves[k].wave, x) + air_waves[k].phase + fraction * air_waves[k].turn);
  return velocity;
}

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec3 x = FETCH(positions, i).xyz;
  air_stirred[2 * i] = vec4(stirred_at(x, 0), 0);
  air_stirred[2 * i + 1] = vec4(stirred_at(x, 1), 0);
}
