// tether: long-range attachment, |p - a| <= reach (Kim, Chentanez, Mueller 2012). Needs predicted.
//
// Anchors do not move in a pass, so a particle can satisfy its tethers one after another, exactly, without averaging. Where two of them
// pull against each other the second would take it out of the first again, so a pair begins with what both have in common:
//
//     a ---c---- b     both balls share a lens about the axis a b, as wide as the circle about c in which the spheres meet.
//      \   |   /       First p comes as near to the axis as that, then within each ball, which does not lead out of the
//         \ p /        other. Without it a sheet between two corners sags: its mean strain was ten times as much.

GATHER_UINT4(tethers)

// What makes d as short as the reach: its way back. Nothing, to the bit, where the tether is slack.
vec3 way_back(vec3 d, float reach) {
  const float squared = dot(d, d);
  return (squared > reach * reach ? reach / sqrt(squared) - 1 : 0) * d;
}

// What brings d = p - a as near to the axis as the lens is wide, where its middle lies between a and b. The way off a taut line
// between two anchors is known well while the lengths along it are not: rounding alone would let a particle sag by a thousandth of
// it. So a lens that rounding could have opened is none.
vec3 way_into_lens(vec3 d, vec3 axis, float reach_a, float reach_b) {
  const float squared = max(dot(axis, axis), 1e-20);
  const float t = 0.5 + 0.5 * (reach_a * reach_a - reach_b * reach_b) / squared;
  const float touching = 2.5e-7;   // of a squared reach
  const float width = max((1 - touching) * reach_a * reach_a - t * t * squared, 0);
  const vec3 off = d - (dot(d, axis) / squared) * axis;
  const float away = dot(off, off);
  return (t > 0 && t < 1 && away > width ? sqrt(width / away) - 1 : 0) * off;
}

vec3 within_tethers(uint i, vec3 p) {
  for (uint k = 0; k < tether_settings.pairs; ++k) {
    const uvec4 pair = FETCH(tethers, i * tether_settings.pairs + k);
    if (pair.x == WEFT_NONE) break;   // it ends the list
    const vec3 a = FETCH(predicted, pair.x).xyz;
    const float reach_a = uintBitsToFloat(pair.y), reach_b = uintBitsToFloat(pair.w);
    const bool both = pair.z != WEFT_NONE;
    const vec3 b = both ? FETCH(predicted, pair.z).xyz : a;
    if (both) p += way_into_lens(p - a, b - a, reach_a, reach_b);
    p += way_back(p - a, reach_a);
    if (both) p += way_back(p - b, reach_b);
  }
  return p;
}
