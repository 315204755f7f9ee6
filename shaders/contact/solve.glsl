// solve: what contact_solve does for an active contact that penetrates. Needs contact/contact_share.glsl, reaction/mesh.glsl, and
// PENETRATIONS(i), the sum of particle i's.

// Units that the corrections of one particle may add up to; an int holds twice that.
const float kMostUnits = 1073741824;   // 2^30
// A correction is at most a 16th of them, 2^26 units, even with fewer contacts: rounding it to a float costs a few units at most.
const uint kUsualContacts = 16;

float friction_of(uint particle) { return FETCH(materials, floatBitsToUint(FETCH(velocities, particle).w)).y; }

// How the pair responds to an impulse.
struct Response {
  vec4 particle;    // W_j w_j (1/kg)
  float pair;       // sum W_j w_j^2 / s_j (1/kg), at least `longest`
  float longest;    // the largest |W_j w_j| (1/kg)
  uint most_uses;   // the largest number of contacts of one of its particles
};

Response response_of(ActiveContact contact, vec4 inverse_masses) {
  Response response;
  response.particle = inverse_masses * contact.weights;
  const vec4 size = abs(response.particle);
  response.longest = max(max(size.x, size.y), max(size.z, size.w));
  response.pair = 0;
  response.most_uses = 1;
  for (int j = 0; j < 4; ++j) {
    const uint i = contact.pair.particle[j], uses = FETCH_UINT(contact_counts, i);
    const uint penetration = penetration_of(contact.weights[j], contact.depth, uses);
    response.most_uses = max(response.most_uses, uses);
    if (response.particle[j] != 0)
      response.pair += response.particle[j] * contact.weights[j] * (float(PENETRATIONS(i)) / float(penetration));
  }
  response.pair = max(response.pair, response.longest);
  return response;
}

// On side A (kg m). u is the motion of the closest points relative to each other since the substep's start.
vec3 impulse(vec3 n, float depth, vec3 u, float friction, Response response) {
  const float lambda = depth / response.pair;
  const vec3 slip = u - dot(u, n) * n;
  const float len = length(slip);
  return lambda * n - min(friction * lambda / max(len, 1e-20), 1 / response.pair) * slip;
}

ivec3 add(uint particle, float response, vec3 units) {
  const ivec3 sum = ivec3(floor(response * units + 0.5));
  if (sum.x != 0) atomicAdd(contact_sums[particle].x, sum.x);
  if (sum.y != 0) atomicAdd(contact_sums[particle].y, sum.y);
  if (sum.z != 0) atomicAdd(contact_sums[particle].z, sum.z);
  return sum;
}

// What the particles of cloth were given, of x their places and inverse masses.
void tell_mesh(ActiveContact contact, mat4 x, ivec3 given[4]) {
  const uint mesh = mesh_of(contact.pair);
  if (mesh == 0) return;
  const vec3 origin = ITERATE(contact.pair.particle[0]).xyz - centre_of_mesh(mesh);
  vec3 impulse = vec3(0), angular = vec3(0);
  for (int j = 0; j < 4; ++j) {
    if (!(x[j].w > 0)) continue;
    touch(contact.pair.particle[j], mesh);
    const vec3 own = opposite_of(contact_settings.quantum * vec3(given[j]), x[j].w);
    impulse += own;
    angular += cross(origin + contact.iterate[j], own);
  }
  give_mesh(mesh, impulse, angular);
}

void solve_contact(uint candidate) {
  const ActiveContact contact = active_contact(candidate);
  const uint a = contact.pair.particle[0], b = contact.pair.particle[1], c = contact.pair.particle[2], d = contact.pair.particle[3];
  const mat4 x = mat4(FETCH(positions, a), FETCH(positions, b), FETCH(positions, c), FETCH(positions, d));
  const Response response = response_of(contact, vec4(x[0].w, x[1].w, x[2].w, x[3].w));
  if (!(response.longest > 0)) return;
  const vec3 start = mat4x3(vec3(0), x[1].xyz - x[0].xyz, x[2].xyz - x[0].xyz, x[3].xyz - x[0].xyz) * contact.weights;
  const bool is_taken_back = untangles && contact.pair.separation == WEFT_UNTANGLED;
  const float friction = is_taken_back ? 0 : sqrt(friction_of(a) * friction_of(contact.pair.edges ? c : b));
  const vec3 on_a = impulse(contact.normal.xyz, contact.depth, contact.iterate * contact.weights - start, friction, response);
  // Where a sum could overflow the whole impulse is scaled down, so that momentum is conserved.
  const vec3 size = abs(on_a) * (response.longest / contact_settings.quantum);
  const float most = kMostUnits / float(max(response.most_uses, kUsualContacts));
  const vec3 units = on_a * (min(1, most / max(1, max(size.x, max(size.y, size.z)))) / contact_settings.quantum);
  const ivec3 given[4] = ivec3[4](add(a, response.particle.x, units), add(b, response.particle.y, units), add(c, response.particle.z, units),
                                  add(d, response.particle.w, units));
  if (first_mesh_body > 0) tell_mesh(contact, x, given);
}
