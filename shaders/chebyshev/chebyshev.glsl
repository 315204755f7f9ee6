// chebyshev: the Chebyshev semi-iteration over Jacobi's (Golub and Varga 1961; Wang 2015, eq. 9), and its guard. Needs push and
// acceleration.
//     q(k+1) = omega (jacobi(q(k)) - q(k-1)) + q(k-1),    omega = 1, 2 / (2 - rho^2), 4 / (4 - rho^2 omega) ...
// Multipliers are extrapolated like positions, so that they stay those of the iterate: a change c by a Jacobi step becomes
// omega c + (omega - 1) times the last change.
//
// The guard detects divergence from substep to substep. A mode whose violation k iterations multiply by q < -1/3 comes back reversed and
// larger (README, "Stable over-relaxation"), and no motion of cloth reverses in every substep. So when the largest first step that is
// opposite to a substep ago has grown three times in succession, and is a sizable share of the largest step of all, the rest of the
// substep and some more after it are plain Jacobi, which damps every such mode. Where it has been such a share twice, and has doubled, that
// is enough: after the third time a hung sheet was 130 % longer, by chance. A maximum of non-negative floats does not depend on the
// order of threads, so that all threads decide the same.

const float growth = 1.2, fast_growth = 2, share_of_all = 0.4;
const uint in_succession = 3, recovery = 8;   // substeps

// The phase of this substep (0) or of one so many substeps ago, in Acceleration's arrays; 2 is also the next substep's.
uint phase(uint back) { return (((push.flags >> WEFT_PHASE_SHIFT) & 3) + 3 - back) % 3; }

// How many substeps of growth this one counts for.
uint grown() {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) return 0;   // not known yet
  const float reversed = uintBitsToFloat(acceleration[0].reversed[phase(0)]);
  const float before = uintBitsToFloat(acceleration[0].reversed[phase(1)]);
  const float largest = uintBitsToFloat(acceleration[0].largest[phase(0)]);
  if (reversed <= growth * growth * before || reversed <= share_of_all * share_of_all * largest) return 0;
  const float largest_before = uintBitsToFloat(acceleration[0].largest[phase(1)]);
  const bool is_fast = reversed > fast_growth * fast_growth * before && before > share_of_all * share_of_all * largest_before;
  return is_fast ? in_succession : 1;
}

bool steady(bool alarming) { return !alarming && acceleration[0].cooldown[phase(0)] == 0; }

// Evaluated once a thread.
uint has_grown = is_accelerated ? grown() : 0;
bool is_alarming = has_grown > 0 && acceleration[0].streak[phase(0)] + has_grown >= in_succession,
     is_steady = !is_accelerated || steady(is_alarming);
float relaxation = is_steady ? motion.relaxation : 1, omega = is_steady ? push.omega : 1;

// A multiplier (x) and its last change (y) after a Jacobi step by `change`.
vec2 advanced(vec2 multiplier, float change, bool only_pulls) {
  if (!is_accelerated) return vec2(multiplier.x + change, 0);
  float step = omega * change + (omega - 1) * multiplier.y;
  if (only_pulls) step = min(step, -multiplier.x);
  return vec2(multiplier.x + step, step);
}
