// turn: gives a patch back the angular momentum that a sweep through its links has changed.
//
// A link's impulses turn nothing about its ends as they are then. But a particle's momentum is that of its step from x, where the substep
// began, to b, where it is, and the next link moves b. What a sweep moves by g changes sum m (b - x) x b by (Dahl and Bargteil 2019, "Global
// momentum preservation for position-based dynamics")
//     dL = sum m x cross g,     as sum m g = 0.
// A rotation by w about the mean c, g_i += w cross (x_i - c), takes it back: I w = -dL, I the tensor of inertia about c. It changes no length
// to first order. A patch with a held particle, or one that a collider holds, hands on its momentum to what holds it, and stays as it is.

const float kHeaviest = 1e20;   // kg, of a patch: with one that is held it is more

// Sums over the patch, by thread: m x and m; m x cross g; m (y2 + z2), m (x2 + z2), m (x2 + y2); m xy, m xz, m yz.
shared vec4 turn_sums[4 * WEFT_PATCH_THREADS];

struct TurnSums {
  vec4 masses;
  vec3 momenta, diagonal, product;
};

void add(inout TurnSums sums, vec3 x, float inverse_mass, vec3 g) {
  const float mass = inverse_mass > 0 ? 1 / inverse_mass : 2 * kHeaviest;
  sums.masses += mass * vec4(x, 1);
  sums.momenta += mass * cross(x, g);
  sums.diagonal += mass * (x.yxx * x.yxx + x.zzy * x.zzy);
  sums.product += mass * (x.xxy * x.yzz);
}

// In an order that does not depend on which thread comes first. All threads call it.
void sum_turns(uint thread, TurnSums sums) {
  turn_sums[4 * thread] = sums.masses;
  turn_sums[4 * thread + 1].xyz = sums.momenta;
  turn_sums[4 * thread + 2].xyz = sums.diagonal;
  turn_sums[4 * thread + 3].xyz = sums.product;
  for (uint others = workgroup / 2; others > 0; others /= 2) {
    barrier();
    if (thread < others)
      for (uint s = 0; s < 4; ++s) turn_sums[4 * thread + s] += turn_sums[4 * (thread + others) + s];
  }
  barrier();
}

struct Turn {
  vec3 centre, angle;   // m, rad
};

Turn turn_of_patch() {
  const float mass = turn_sums[0].w;
  const vec3 centre = turn_sums[0].xyz / mass, dL = turn_sums[1].xyz;
  const vec3 of_centre = mass * (centre.yxx * centre.yxx + centre.zzy * centre.zzy);
  const vec3 diagonal = turn_sums[2].xyz - of_centre, product = turn_sums[3].xyz - mass * (centre.xxy * centre.yzz);
  // What lies on a line has no inertia about it: a little is added, and it does not turn.
  const vec3 d = diagonal + 1e-5 * (diagonal.x + diagonal.y + diagonal.z);
  const vec3 row0 = vec3(d.x, -product.x, -product.y), row1 = vec3(-product.x, d.y, -product.z), row2 = vec3(-product.y, -product.z, d.z);
  const vec3 across = cross(row1, row2);
  const vec3 angle = -(dL.x * across + dL.y * cross(row2, row0) + dL.z * cross(row0, row1)) / dot(row0, across);
  // More than a tenth is no small angle.
  return mass < kHeaviest && dot(angle, angle) < 0.01 ? Turn(centre, angle) : Turn(vec3(0), vec3(0));
}
