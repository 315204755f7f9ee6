// contact_solve: pushes the sides of a contact apart, C = n . sum w_j p_j - keep >= 0 on the current iterate, and rubs them.
//
// A particle shows each of its contacts its mass times a share s (contact_share.glsl): lambda = -C / sum W_j w_j^2 / s_j,
// dp_j = W_j w_j lambda n. Friction is Coulomb's: the tangential motion u of the pair since the substep's start is taken back by an impulse
// of at most mu lambda, and never by more than there is of it.
//
// A long lever would throw particles about: where only one that hardly moves the closest points can give way, lambda would have
// to be large. No push takes a particle further than the sides lack. All particles of a contact get the same
// impulse, and weights sum to 0, so momentum is kept.
//
// Contacts of one particle meet in integers, whose sum does not depend on the order in which threads come.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(velocities)
GATHER(materials)
GATHER_UINT(contact_lacks)
READ_WRITE(ivec4, contact_sums)

#include "contact/contact_share.glsl"

// Units that the contacts of one particle may add up to; an int holds twice that.
const float kMostUnits = 1073741824;   // 2^30
// A correction is at most a 16th of them, 2^26 units, even where fewer contacts meet: a float's rounding of it is a few units.
const uint kUsualContacts = 16;

float friction_of(uint particle) { return FETCH(materials, floatBitsToUint(FETCH(velocities, particle).w)).y; }

// What the pair can give way to an impulse.
struct Response {
  vec4 particle;    // W_j w_j (1/kg)
  float pair;       // sum W_j w_j^2 / s_j (1/kg), or the longest of a particle's if that is more
  float longest;
  uint most_uses;
};

Response response_of(Touch touch, vec4 inverse_masses) {
  Response response;
  response.particle = inverse_masses * touch.weights;
  const vec4 size = abs(response.particle);
  response.longest = max(max(size.x, size.y), max(size.z, size.w));
  response.pair = 0;
  response.most_uses = 1;
  for (int j = 0; j < 4; ++j) {
    const uint i = touch.pair.particle[j], uses = FETCH_UINT(contact_counts, i), lack = lack_of(touch.weights[j], touch.depth, uses);
    response.most_uses = max(response.most_uses, uses);
    if (response.particle[j] != 0) response.pair += response.particle[j] * touch.weights[j] * (float(FETCH_UINT(contact_lacks, i)) / float(lack));
  }
  response.pair = max(response.pair, response.longest);
  return response;
}

// On side A (kg m). u is the way of the closest points past each other since the substep's start.
vec3 impulse(vec3 n, float depth, vec3 u, float friction, Response response) {
  const float lambda = depth / response.pair;
  const vec3 slip = u - dot(u, n) * n;
  const float len = length(slip);
  return lambda * n - min(friction * lambda / max(len, 1e-20), 1 / response.pair) * slip;
}

void add(uint particle, float response, vec3 units) {
  const ivec3 sum = ivec3(floor(response * units + 0.5));
  if (sum.x != 0) atomicAdd(contact_sums[particle].x, sum.x);
  if (sum.y != 0) atomicAdd(contact_sums[particle].y, sum.y);
  if (sum.z != 0) atomicAdd(contact_sums[particle].z, sum.z);
}

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_TOUCHING]) return;
  const Touch touch = touch_at(place);
  if (!touch.pushes) return;
  const uint a = touch.pair.particle[0], b = touch.pair.particle[1], c = touch.pair.particle[2], d = touch.pair.particle[3];
  const mat4 x = mat4(FETCH(positions, a), FETCH(positions, b), FETCH(positions, c), FETCH(positions, d));
  const Response response = response_of(touch, vec4(x[0].w, x[1].w, x[2].w, x[3].w));
  if (!(response.longest > 0)) return;
  const vec3 start = mat4x3(vec3(0), x[1].xyz - x[0].xyz, x[2].xyz - x[0].xyz, x[3].xyz - x[0].xyz) * touch.weights;
  const float friction = sqrt(friction_of(a) * friction_of(touch.pair.edges ? c : b));
  const vec3 push_apart = impulse(touch.normal.xyz, touch.depth, touch.iterate * touch.weights - start, friction, response);
  // Shortened as a whole, so that momentum is kept, where a sum could overflow.
  const vec3 size = abs(push_apart) * (response.longest / contact_settings.quantum);
  const float most = kMostUnits / float(max(response.most_uses, kUsualContacts));
  const vec3 units = push_apart * (min(1, most / max(1, max(size.x, max(size.y, size.z)))) / contact_settings.quantum);
  add(a, response.particle.x, units);
  add(b, response.particle.y, units);
  add(c, response.particle.z, units);
  add(d, response.particle.w, units);
}
