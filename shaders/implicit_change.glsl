// What the solve of an implicit substep found, after all of its iterations. Needs implicit_jacobi.glsl.

layout(constant_id = WEFT_LINEAR_CONSTANT) const uint solver = WEFT_LINEAR_CG;

GATHER(exchanged)
GATHER(krylov)

// Of all threads of a workgroup, which must all call it.
Linear solved() {
  const uint iterations = push.iteration;
  Linear state = linear[iterations % 2];
  if (solver == WEFT_LINEAR_JACOBI) state = judged(state, sum_of_groups((iterations + 1) % 2), iterations);
  return state;
}

// m/s
vec3 change_of(uint i, Linear state, uint particles) {
  return solver == WEFT_LINEAR_JACOBI ? state.next * FETCH(exchanged, state.iterate * particles + i).xyz : FETCH(krylov, particles + i).xyz;
}
