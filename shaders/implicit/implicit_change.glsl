// What the solve of an implicit substep found, after all of its iterations (m/s).

GATHER(exchanged)
GATHER(krylov)

vec3 change_of(uint i, Linear state, uint particles) {
  return linear_solver == WEFT_LINEAR_JACOBI ? state.next * FETCH(exchanged, state.iterate * particles + i).xyz : FETCH(krylov, particles + i).xyz;
}
