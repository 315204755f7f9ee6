// reaction: what a collider is given for what it gave to a particle. A particle that it moves by d within a substep h has changed its
// momentum by m d / h, so the collider gets J = -m d / h, and r x J about its centre, r from there to the particle: linear and angular
// momentum of cloth and collider together stay what they were.
//
// Sums are of integers, in quanta, each 64 bits in two words: an atomic addition tells what was there before, and with that whether it
// carried. Any order of threads gives the same carries, and the same bits. Needs colliders.

READ_WRITE(Reaction, reactions)

const float kWord = 4294967296.0;                 // 2^32
const float kMostQuanta = 4611686018427387904.0;   // 2^62, of one addition

// Adds x quanta, rounded, to sum k of a collider.
void add_quanta(uint collider, int k, float x) {
  const float size = min(roundEven(abs(x)), kMostQuanta);
  uint high = uint(size / kWord), low = uint(size - float(high) * kWord);
  if (x < 0) {   // two's complement
    low = ~low + 1;
    high = ~high + uint(low == 0);
  }
  if (low != 0) high += uint(atomicAdd(reactions[collider].low[k], low) + low < low);
  if (high != 0) atomicAdd(reactions[collider].high[k], high);
}

// The collider has moved the particle from `before` to `after`.
void react(uint collider, Particle v, vec3 before, vec3 after, float inverse_mass) {
  const vec3 moved = after - before;
  if (!(dot(moved, moved) > 0 && dot(moved, moved) < 1e20 && inverse_mass > 0)) return;
  const vec3 impulse = -(reaction_settings.quanta / inverse_mass) * moved;
  const vec3 angular = cross(after - surface_at(colliders[collider], v).point, impulse);
  for (int k = 0; k < 3; ++k) {
    add_quanta(collider, k, impulse[k]);
    add_quanta(collider, 3 + k, angular[k]);
  }
}
