// tether: long-range attachment, |p - a| <= max_distance (Kim, Chentanez, Mueller 2012). Needs predicted.
//
// Anchors do not move in a pass, so a particle satisfies a tether exactly, by itself, and its tethers one after another, without averaging.
// Where two tethers pull against each other the second projection would violate the first again. So tethers are taken in pairs, and a pair
// begins with a projection towards the intersection of its two balls:
//
//     a ---c---- b     The intersection is a lens about the axis a b, as wide as the circle about c in which the spheres intersect.
//      \   |   /       First p is brought as near to the axis as this radius, then into each ball, which does not lead out of the
//         \ p /        other. Without the first step a sheet between two corners sags: its mean strain was ten times as much.

// They know nothing of bodies: an anchor behind one pulls straight through it, by metres where cloth lags far behind, and what leads around
// is drowned. With contacts a particle may go no farther than its displacement bound, and tethers take up no more than a part of it. The
// part is a measured one (engine/README.md, "Tethers along geodesics"): with less cloth that hangs stretches, with more it hooks on meshes.

GATHER_UINT4(tethers)

const float tether_share = meets_meshes ? 0.05 : 0.1;   // of the displacement bound, in a pass

// The correction that makes d = p - a as short as the max distance. Exactly 0 where the tether is slack.
vec3 correction(vec3 d, float max_distance) {
  const float squared = dot(d, d);
  return (squared > max_distance * max_distance ? max_distance / sqrt(squared) - 1 : 0) * d;
}

// The correction that brings p, d = p - a, as near to the axis as the lens is wide, where its middle lies between a and b. Between two
// anchors a taut line's lens has almost no width, which rounding errors of the squared lengths could open to a thousandth of the length,
// and the particle would sag by that. So `rounding` is subtracted: a lens that could be rounding error counts as closed.
vec3 correction_to_lens(vec3 d, vec3 axis, float max_a, float max_b) {
  const float squared = max(dot(axis, axis), 1e-20);
  const float t = 0.5 + 0.5 * (max_a * max_a - max_b * max_b) / squared;
  const float rounding = 2.5e-7;   // relative to a squared max distance
  const float width = max((1 - rounding) * max_a * max_a - t * t * squared, 0);
  const vec3 off = d - (dot(d, axis) / squared) * axis;
  const float away = dot(off, off);
  return (t > 0 && t < 1 && away > width ? sqrt(width / away) - 1 : 0) * off;
}

// `way`, or as much of it as has this length.
vec3 at_most(float most, vec3 way) {
  const float squared = dot(way, way);
  return squared > most * most ? (most / sqrt(squared)) * way : way;
}

vec3 within_tethers(uint i, vec3 p) {
  const vec3 before = p;
  for (uint k = 0; k < tether_pairs; ++k) {
    const uvec4 pair = FETCH(tethers, i * tether_pairs + k);
    if (pair.x == WEFT_NONE) break;   // it ends the list
    const vec3 a = FETCH(predicted, pair.x).xyz;
    const float max_a = uintBitsToFloat(pair.y), max_b = uintBitsToFloat(pair.w);
    const bool both = pair.z != WEFT_NONE;
    const vec3 b = both ? FETCH(predicted, pair.z).xyz : a;
    if (both) p += correction_to_lens(p - a, b - a, max_a, max_b);
    p += correction(p - a, max_a);
    if (both) p += correction(p - b, max_b);
  }
  return has_contacts ? before + at_most(tether_share * bound_of(i), p - before) : p;
}
