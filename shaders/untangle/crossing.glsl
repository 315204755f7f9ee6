// crossing: the triangles that an edge goes through, as the broad phase looks for them. Needs contact/search.glsl and contact/mask.glsl.
//
// Every test is a sign, and where two pairs ask for the same one they get the same answer, whatever the rounding: whether an edge passes
// another on its left is asked in the order of particles. So an edge goes through one of two neighbouring triangles and never through both
// or neither, and contours close. A sign of 0 is positive.

GATHER(positions)
GATHER_UINT4(cluster_faces)
READ_WRITE(uvec2, crossed_triangles)
READ_WRITE(uint, tangled_pairs)

#include "untangle/tangled.glsl"

bool can_move(uint i) { return FETCH(positions, i).w > 0; }

// Whether the line through the origin along d passes the edge from p to q, whose particles are i and j, on its left.
bool passes_left(vec3 d, uint i, vec3 p, uint j, vec3 q) {
  precise const float volume = dot(d, i < j ? cross(p, q) : cross(q, p));
  return (volume >= 0) == (i < j);
}

// Where along the edge from a to a + d it goes through the triangle t (0 to 1); below 0: it does not.
float crossing_of(vec3 a, vec3 d, uvec3 t) {
  const vec3 p = track_of(t.x).at - a, q = track_of(t.y).at - a, r = track_of(t.z).at - a;
  const vec3 n = cross(q - p, r - p);
  const float from = -dot(n, p), to = dot(n, d - p);
  if ((from >= 0) == (to >= 0)) return -1;
  const bool left = passes_left(d, t.x, p, t.y, q);
  if (passes_left(d, t.y, q, t.z, r) != left || passes_left(d, t.z, r, t.x, p) != left) return -1;
  return clamp(from / (from - to), 0, 1);
}

void add_tangled(uint a, uint b) {
  const uint key = key_of(a, b), last = contact_settings.tangled_room - 1;
  for (uint k = 0; k <= last; ++k) {
    const uint found = atomicCompSwap(tangled_pairs[(key + k) & last], 0, key);
    if (found == 0 || found == key) return;
  }
  detection[0].looks = 2;   // there is no room: the set is of no use
}

void search_crossings(uint edge, uvec2 ends, uint cluster) {
  const vec3 a = track_of(ends.x).at, b = track_of(ends.y).at, low = min(a, b), high = max(a, b);
  const bool moves = can_move(ends.x) || can_move(ends.y);
  float first = 2, last = -1;
  uint count = 0;
  uvec2 found = uvec2(WEFT_NONE, 0);
  const NearList near = near_list(cluster, FETCH_UINT(near_clusters, row_of(cluster)));
  const vec3 middle = 0.5 * (low + high), half_sides = (1 + 4 * rounding) * (0.5 * (high - low));
  for (uint k = 0; k < near.count; ++k) {
    const uint other = near.every_one ? k : FETCH_UINT(near_clusters, near.first + k);
    const vec3 its_low = FETCH(cluster_boxes, 2 * other).xyz, its_high = FETCH(cluster_boxes, 2 * other + 1).xyz;
    if (any(greaterThan(its_low, high)) || any(lessThan(its_high, low))) continue;
    const uint end = FETCH(clusters, other + 1).x;
    for (uint face = FETCH(clusters, other).x; face < end; ++face) {
      const vec4 its_middle = FETCH(outlines, 3 * face);
      const vec3 sides = FETCH(outlines, 3 * face + 1).xyz + half_sides + rounding * abs(middle);
      if (any(greaterThan(abs(its_middle.xyz - middle), sides))) continue;
      const uvec3 t = FETCH(cluster_faces, face).xyz;
      if (any(equal(t, uvec3(ends.x))) || any(equal(t, uvec3(ends.y)))) continue;
      if (contact_mask_words > 0 && !meets_other(ends.x, t.x)) continue;
      const float along = crossing_of(a, b - a, t);
      if (along < 0 || !(moves || can_move(t.x) || can_move(t.y) || can_move(t.z))) continue;
      ++count;
      if (along < first || (along == first && face < found.x)) found.x = face;
      if (along > last || (along == last && face < found.y)) found.y = face;
      first = min(first, along);
      last = max(last, along);
      for (uint j = 0; j < 3; ++j) {
        add_tangled(ends.x, t[j]);
        add_tangled(ends.y, t[j]);
      }
    }
  }
  crossed_triangles[edge] = uvec2(found.x, found.y | (count & 1) << 31);
  if (count == 0) return;
  atomicAdd(detection[0].crossings, count);
  detection[0].tangles = Groups(1, 1, 1);
}
