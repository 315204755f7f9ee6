// primitive: a thread's primitive, triangle or edge, and its place in the grid.

#include "grid.glsl"

GATHER_UINT4(triangles)
GATHER_UINT2(edges)

struct Place {
  vec3 middle, half_sides;
  float half_side;   // m, the longest
  uint kind, level, slot;
};

Sweep sweep_of_primitive(uint primitive) {
  if (primitive >= push.triangles) {
    const uvec2 edge = FETCH_UINT2(edges, primitive - push.triangles);
    return sweep_of(track_of(edge.x), track_of(edge.y), FETCH(rest, edge.x).w);
  }
  const uvec4 face = FETCH(triangles, primitive);
  return sweep_of(track_of(face.x), track_of(face.y), track_of(face.z), FETCH(rest, face.x).w);
}

// An edge on its way: half of it at the detection, about the middle of its box, and how far its particles can get from those two
// places, the distance that it keeps included (m).
vec4 rod_of(uint edge, vec3 middle) {
  const uvec2 e = FETCH_UINT2(edges, edge);
  const Track a = track_of(e.x), b = track_of(e.y);
  const float thickness = FETCH(rest, e.x).w;
  const vec3 half_edge = 0.5 * (b.at - a.at);
  const vec3 low = middle - half_edge, high = middle + half_edge;
  const float away = max(max(distance(a.at, low), distance(end_of(a), low)), max(distance(b.at, high), distance(end_of(b), high)));
  return vec4(half_edge, away + sweep_of(a, b, thickness).clearance + 0.5 * thickness);
}

Place place_of(uint primitive) {
  const Sweep sweep = sweep_of_primitive(primitive);
  Place place;
  place.middle = middle_of(sweep);
  place.half_sides = half_sides(sweep);
  place.half_side = max(place.half_sides.x, max(place.half_sides.y, place.half_sides.z));
  place.kind = primitive >= push.triangles ? of_edges : of_triangles;
  place.level = level_of(place.half_side);
  place.slot = slot_of(cell_at(place.middle, place.level), place.level, place.kind);
  return place;
}
