// The solution of an implicit substep, dv, after all of its iterations (m/s).

GATHER(exchanged)
GATHER(solve_vectors)

vec3 change_of(uint i, Linear state, uint particles) {
  return linear_solver == WEFT_LINEAR_JACOBI ? state.next * FETCH(exchanged, state.iterate * particles + i).xyz
                                             : FETCH(solve_vectors, particles + i).xyz;
}
