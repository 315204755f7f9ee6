// air_stir: what the air's velocity where a particle is differs from the wind by, in gusts, eddies, fields and the lee of bodies, when the frame begins and when it ends. Between, the air pass goes from
// one to the other in a straight line: a sine a wave in every substep would cost more than all else that air does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER(materials)
READ(AirWave, air_waves)
READ(AirField, air_fields)
WRITE(vec4, air_stirred)

#include "collide/collide.glsl"
#include "collide/size.glsl"
#include "air/wake.glsl"
#include "motion/body.glsl"

vec3 stirred_at(vec3 x, float fraction) {
  vec3 velocity = vec3(0);
  for (uint k = 0; k < air_wave_count; ++k)
    velocity += air_waves[k].velocity * sin(dot(air_waves[k].wave, x) + air_waves[k].phase + fraction * air_waves[k].turn);
  return velocity;
}

// A round turbulent jet (Pope 2000, 5.1): in its core as fast as in the nozzle, then slower with the distance, a Gaussian across that widens.
vec3 jet_at(vec3 d, AirField field) {
  const float speed = length(field.velocity);
  const vec3 way = field.velocity / max(speed, 1e-20);
  const float along = dot(d, way), across = length(d - along * way);
  if (along < 0) return vec3(0);
  const float half_width = max(field.radius, 0.094 * along), far = across / half_width;
  return min(1, 5.8 * 2 * field.radius / max(along, 1e-20)) * exp(-0.6931472 * far * far) * field.velocity;
}

// A vortex of Lamb and Oseen: the core turns as one, and outside the velocity falls with the distance. It is fastest at the radius of its core.
vec3 vortex_at(vec3 d, AirField field) {
  const float speed = length(field.velocity);
  const vec3 axis = field.velocity / max(speed, 1e-20), out_of = d - dot(d, axis) * axis;
  const float squared = dot(out_of, out_of) / (field.radius * field.radius);
  // (1 - exp(-a s)) / s, which goes to a in the middle.
  const float turn = squared > 1e-4 ? (1 - exp(-1.256431 * squared)) / squared : 1.256431;
  return 1.397953 * speed / field.radius * turn * cross(axis, out_of);
}

vec3 field_at(vec3 x, AirField field) {
  const vec3 d = x - field.centre;
  if (field.shape == WEFT_AIR_JET) return jet_at(d, field);
  if (field.shape == WEFT_AIR_VORTEX) return vortex_at(d, field);
  const float outside = field.shape == WEFT_AIR_BOX ? length(max(abs(d) - field.half_sides, 0)) : max(length(d) - field.radius, 0);
  return (outside <= 0 ? 1 : 1 - smoothstep(0, max(field.falloff, 1e-6), outside)) * field.velocity;
}

vec3 fields_at(vec3 x) {
  vec3 velocity = vec3(0);
  for (uint k = 0; k < air_field_count; ++k) velocity += field_at(x, air_fields[k]);
  return velocity;
}

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec3 x = FETCH(positions, i).xyz, still = fields_at(x);
  vec3 begins = still + stirred_at(x, 0), ends = still + stirred_at(x, 1);
  if (has_lee) {   // of what moves there all together
    const uint own = wake_count > 0 ? body_of(i) : 0;
    begins = lee_at(x, false, own) * (air.wind + begins) - air.wind;
    ends = lee_at(x, true, own) * (air.wind + ends) - air.wind;
  }
  air_stirred[2 * i] = vec4(begins, 0);
  air_stirred[2 * i + 1] = vec4(ends, 0);
}
