// tangled: the pairs of particles that lie on what goes through each other, an end of the edge and a corner of the triangle. They are a set
// of keys with open addressing, 0 an empty place, and what is in it does not depend on the order of threads. No contact comes between them,
// or it would hold what is to come apart; between all others contacts go on, or cloth that is taken back would crumple through itself.

// Mixed as MurmurHash3 ends (Appleby 2011).
uint key_of(uint a, uint b) {
  uint key = min(a, b) * 0x9e3779b1u ^ max(a, b) * 0x85ebca6bu;
  key = (key ^ key >> 15) * 0xc2b2ae35u;
  return max(1, key ^ key >> 13);
}
