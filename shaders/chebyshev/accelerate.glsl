// accelerate: Chebyshev's semi-iteration over Jacobi's (Wang 2015, eq. 9), and its guard. Needs push and acceleration.
//     q(k+1) = m (jacobi(q(k)) - q(k-1)) + q(k-1),    m = 1, 2 / (2 - rho^2), 4 / (4 - rho^2 m) ...
// Multipliers are extrapolated as the positions are, so that they stay those of the iterate: a change c of a Jacobi step becomes
// m c + (m - 1) times the last.
//
// The guard: what an acceleration does wrong shows from substep to substep. A mode that k iterations take to q < -1/3 of its violation
// comes back turned round and larger (README, "Stable over-relaxation"), and nothing in the motion of cloth turns round every
// substep. So when the largest first step that points the other way than a substep ago has grown three times on end, and is a share of
// the largest step of all, the rest of the substep and some more after it are plain Jacobi, which damps every such mode. Maxima of non-negative floats do not depend on
// the threads' order, and everybody decides the same from them.

const float growth = 1.2, share_of_all = 0.4;
const uint on_end = 3, recovery = 8;   // substeps

uint turn(uint back) { return (((push.flags >> WEFT_TURN_SHIFT) & 3) + 3 - back) % 3; }

bool grown() {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) return false;   // not known yet
  const float turned = uintBitsToFloat(acceleration[0].turned[turn(0)]);
  const float before = uintBitsToFloat(acceleration[0].turned[turn(1)]);
  const float largest = uintBitsToFloat(acceleration[0].largest[turn(0)]);
  return turned > growth * growth * before && turned > share_of_all * share_of_all * largest;
}

bool steady(bool alarming) { return !alarming && acceleration[0].rest[turn(0)] == 0; }

// Once a thread.
bool is_grown = is_accelerated && grown(), is_alarming = is_grown && acceleration[0].streak[turn(0)] + 1 >= on_end, is_steady = !is_accelerated || steady(is_alarming);
float relaxation = is_steady ? motion.relaxation : 1, omega = is_steady ? push.omega : 1;

// A multiplier (x) and its last change (y) after a Jacobi step by `change`.
vec2 advanced(vec2 multiplier, float change, bool only_pulls) {
  if (!is_accelerated) return vec2(multiplier.x + change, 0);
  float step = omega * change + (omega - 1) * multiplier.y;
  if (only_pulls) step = min(step, -multiplier.x);
  return vec2(multiplier.x + step, step);
}
