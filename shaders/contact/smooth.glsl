// smooth: whether the cloth about a cluster is so smooth, until the next detection, that no two places of the cluster and of those that it
// touches in the mesh can meet, unless they are neighbours (engine/effects/contact/smooth.h has the derivation).
//
// Deformation gradients are linear in the particles' places and the least eigenvalue of a symmetric matrix is concave, so on trajectories
// both ends bound it. A particle is within the clearance of its trajectory at a place up to a step behind (pair.glsl): seen in the plane of F
// it is off by r at most, and that changes a triangle's gradient, along a unit vector u, by no more than r sum |grad b_k . u|, for the
// three barycentric coordinates b_k, which sum to one: by 2 r times the largest |grad b_k|.

GATHER_UINT4(cluster_surroundings)
GATHER_UINT(clusters_around)
GATHER_UINT4(clusters)
GATHER_UINT4(cluster_faces)

mat3 gradient_of(uint row) {
  return mat3(LATEST(cluster_motions, row).xyz, LATEST(cluster_motions, row + 1).xyz, LATEST(cluster_motions, row + 2).xyz);
}

// The two orthonormal directions nearest to two directions that are of one length, about.
mat2x3 orthonormal(mat2x3 m) {
  const vec3 a = normalize(m[0]), b = normalize(m[1]), sum = normalize(a + b), difference = normalize(a - b);
  return inversesqrt(2) * mat2x3(sum + difference, sum - difference);
}

float least_eigenvalue(mat2 m) {
  const float half_difference = 0.5 * (m[0][0] - m[1][1]), off = 0.5 * (m[0][1] + m[1][0]);
  return 0.5 * (m[0][0] + m[1][1]) - sqrt(half_difference * half_difference + off * off);
}

// Directions without a length are not a number, and no eigenvalue is then found to be large enough.
bool is_smooth(uint cluster) {
  const uvec4 around = FETCH(cluster_surroundings, cluster);
  if (around.x == around.z) return false;
  const uvec3 t = FETCH(cluster_faces, FETCH(clusters, cluster).x).xyz;
  const vec3 at = FETCH(rest, t.x).xyz, side = normalize(FETCH(rest, t.y).xyz - at), other = FETCH(rest, t.z).xyz - at;
  const mat2x3 plane = mat2x3(side, normalize(other - dot(other, side) * side));
  const mat2x3 frame = orthonormal((gradient_of(WEFT_MOTION * cluster) + gradient_of(WEFT_MOTION * cluster + 3)) * plane);
  const mat3x2 to_frame = transpose(frame);
  const float wanted = uintBitsToFloat(around.w);
  for (uint k = around.x; k < around.z; ++k) {
    const uint row = WEFT_MOTION * FETCH_UINT(clusters_around, k);
    const vec3 normal = vec3(LATEST(cluster_motions, row + 3).w, LATEST(cluster_motions, row + 4).w, LATEST(cluster_motions, row + 5).w);
    const float off = LATEST(cluster_motions, row).w + length(to_frame * normal) * LATEST(cluster_motions, row + 7).x;
    const float slope = LATEST(cluster_motions, row + 1).w, clearance = LATEST(cluster_motions, row + 2).w;
    const vec4 trajectory = LATEST(cluster_motions, row + 6);
    const float behind = (length(to_frame * trajectory.xyz) + trajectory.w) * per_substep();
    const float least = min(least_eigenvalue(to_frame * (gradient_of(row) * plane)),
                            least_eigenvalue(to_frame * (gradient_of(row + 3) * plane)));
    if (!(least - off - 2 * slope * (clearance + behind) >= wanted)) return false;
  }
  return true;
}

// Whether two clusters share a particle, if one of them has surroundings: without, neither is smooth, and nobody asks.
bool touch(uint a, uint b) {
  const uvec4 around_a = FETCH(cluster_surroundings, a), around_b = FETCH(cluster_surroundings, b);
  const bool by_a = around_a.x != around_a.y;
  const uvec4 around = by_a ? around_a : around_b;
  const uint sought = by_a ? b : a;
  for (uint k = around.x; k < around.y; ++k)
    if (FETCH_UINT(clusters_around, k) == sought) return true;
  return false;
}
