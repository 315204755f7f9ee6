// gas: an ideal gas at constant temperature, p V = c (Boyle 1662), in a cloth, against the ambient pressure a. As a pressure of soft
// bodies: Matyka and Ollila 2003; as a constraint on the volume: Mueller et al. 2007, section 4.4.
//
// The gas of a light balloon is far stiffer than a substep h resolves, so its pressure is that of the substep's end. An impulse l (Pa s)
// gives the particles w l grad V, and the volume h W l, with W = sum w |grad V|^2. With V the predicted volume and y that at the end,
//     l / h = c / y - a,   y = V + h W l,
// which is a quadratic equation for y with one root above 0, whatever V is: also for cloth that is crushed or turned inside out. The energy
// a y - c log y is convex, so that this is stable at any step (an implicit step along the gradient: a compliant constraint as in Macklin et
// al. 2016, but of the whole gas law and not of its tangent).
//
// That alone is wrong where cloth is taut: the links, which come after the gas, take back what it has gained, and the gas would always find
// the volume smaller than it may leave it. So V has added to it what all else did to the volume in the last substep after the gas: at
// rest the gas then ends the substep with the volume that there is. Cloth can undo no more than the gas did, so this is limited to
// that: then it neither grows nor is taken for the gas's own where the host moves particles.
//
// No particle is moved further than `most` in a substep, by making the impulse smaller for all: the sum of gradients over a closed cloth
// is 0, and so is that of their moments, so the gas gives no momentum and turns nothing.

struct GasStep {
  float impulse;      // Pa s
  GasState after;
};

// Of the volume: y - V of the equation above, over the gas's own, r being V over it and s = h^2 W p / volume. Of its forms the one that
// takes no difference of near numbers.
float growth(float r, float s, float amount, float ambient) {
  const float b = r + s * ambient, d = r - s * ambient, root = sqrt(d * d + 4 * s * amount);
  return b > 0 ? 2 * s * (amount - ambient * r) / (b + root) : 0.5 * (root - b);
}

// `amount`: of gas, as a multiple of the scene's. Does nothing with sums that are not finite.
GasStep gas_step(Gas gas, float amount, GasSum sum, float h) {
  const float undone = clamp(sum.volume - sum.before.left, -max(sum.before.gained, 0), -min(sum.before.gained, 0));
  const float relative = gas.pressure > 0 ? gas.ambient / gas.pressure : 0;
  const float mobility = h * sum.mobility;   // of the volume: m^3 / (Pa s)
  const float softness = h * mobility * gas.pressure / gas.volume;
  const float gained = gas.volume * growth((sum.predicted + undone) / gas.volume, softness, amount, relative);
  const float most = gas.most / (h * sum.longest), impulse = clamp(gained / mobility, -most, most);
  const float moved = mobility * impulse;
  if (!(sum.longest > 0 && abs(impulse) < 1e30 && abs(sum.predicted + moved) < 1e30)) return GasStep(0, GasState(0, 0));
  return GasStep(impulse, GasState(sum.predicted + moved, moved));
}
