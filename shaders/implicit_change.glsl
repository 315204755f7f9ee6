// What the solve of an implicit substep found, after all of its iterations (m/s).

layout(constant_id = WEFT_LINEAR_CONSTANT) const uint solver = WEFT_LINEAR_CG;

GATHER(exchanged)
GATHER(krylov)

vec3 change_of(uint i, Linear state, uint particles) {
  return solver == WEFT_LINEAR_JACOBI ? state.next * FETCH(exchanged, state.iterate * particles + i).xyz : FETCH(krylov, particles + i).xyz;
}
