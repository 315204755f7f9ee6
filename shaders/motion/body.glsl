// body: the cloth, or after all cloths the mesh collider, that a particle belongs to. Needs velocities and materials.

uint body_of(uint particle) {
  const uint material = floatBitsToUint(FETCH(velocities, particle).w);
  return has_maps ? uint(FETCH(materials, material).w) : material;
}
