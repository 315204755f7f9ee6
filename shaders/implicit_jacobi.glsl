// Where damped Jacobi is. Dispatch k reads one of the three iterates and writes the next; what it summed up is known from
// dispatch k + 1 on, which therefore judges the one before it. Needs implicit.glsl with SUMS.
//
//   k = 0   reads the guess: sums b . guess, guess . A guess, b . D^-1 b; writes none
//   k = 1   reads the guess, times how far along it the answer is nearest; writes iterate 1
//   k > 1   reads iterate (k - 1) % 3, writes k % 3, where the one of three dispatches before lies: it is there until then
//
// In the norm r . D^-1 r the residual falls in every iteration where Jacobi converges. Where it has grown the solve is
// broken off with the iterate before that.
Linear judged(Linear before, vec4 sums, uint k) {
  Linear now = before;
  if (k == 0) return Linear(0, 0, 0, 0, 1, 0, 0);
  now.next = 1;
  if (k == 1) {
    now.first = now.squared = sums.z;
    now.next = now.step = sums.y > 0 ? sums.x / sums.y : 0;
    return now;
  }
  if (before.done != 0) {
    now.next = before.next;
    return now;
  }
  now.iterate = (k - 1) % 3;
  if (k > 2 && !(sums.z <= before.squared)) {
    now.iterate = k % 3;
    now.next = k == 3 ? before.step : 1;
    now.done = 2;
    return now;
  }
  now.squared = sums.z;
  return now;
}
