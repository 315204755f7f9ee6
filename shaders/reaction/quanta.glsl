// quanta: sums of impulses. They are of integers, in quanta, each 64 bits in two words: an atomic addition tells what was there before, and
// with that whether it carried. Any order of threads gives the same carries, and the same bits.

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

