// primitive: a thread's primitive, triangle or edge, and its place in the grid.

#include "contact/grid.glsl"

GATHER_UINT4(triangles)
GATHER_UINT2(edges)

struct Place {
  vec3 middle, half_sides;
  float half_side;   // m, the longest
  uint kind, level, bucket;
};

Sweep sweep_of_primitive(uint primitive) {
  if (primitive >= contact_settings.triangles) {
    const uvec2 edge = FETCH_UINT2(edges, primitive - contact_settings.triangles);
    return sweep_of(track_of(edge.x), track_of(edge.y), FETCH(rest, edge.x).w);
  }
  const uvec4 face = FETCH(triangles, primitive);
  return sweep_of(track_of(face.x), track_of(face.y), track_of(face.z), FETCH(rest, face.x).w);
}

// A primitive as it was at the detection, and one trajectory for all of it. `away` bounds the error of that: how far one of its points may
// be from there, plus half of its thickness.
struct Outline {
  vec3 half_sides;   // m: half of an edge; half of a triangle's box
  float away;        // m
  vec3 trajectory;         // m
  float step;        // m: what its fastest particle moves in a substep
};

Outline outline_of(vec3 half_size, vec3 middle, vec3 trajectory, float strays, float thickness, Sweep sweep) {
  // The search (search.glsl) assumes that it is half its trajectory behind the middle of its box.
  return Outline(half_size, distance(middle_of(sweep), middle + 0.5 * trajectory) + strays + sweep.clearance + 0.5 * thickness, trajectory,
                 sweep.step);
}

Outline outline_of_edge(uint edge) {
  const uvec2 e = FETCH_UINT2(edges, edge);
  const Track a = track_of(e.x), b = track_of(e.y);
  const float thickness = FETCH(rest, e.x).w;
  return outline_of(0.5 * (b.at - a.at), 0.5 * (a.at + b.at), 0.5 * (a.trajectory + b.trajectory),
                    0.5 * distance(a.trajectory, b.trajectory), thickness, sweep_of(a, b, thickness));
}

Outline outline_of_triangle(uint triangle) {
  const uvec4 t = FETCH(triangles, triangle);
  const Track a = track_of(t.x), b = track_of(t.y), c = track_of(t.z);
  const vec3 low = min(min(a.at, b.at), c.at), high = max(max(a.at, b.at), c.at);
  const vec3 trajectory = (a.trajectory + b.trajectory + c.trajectory) / 3;
  const float thickness = FETCH(rest, t.x).w;
  return outline_of(0.5 * (high - low), 0.5 * (low + high), trajectory,
                    max(max(distance(a.trajectory, trajectory), distance(b.trajectory, trajectory)), distance(c.trajectory, trajectory)),
                    thickness, sweep_of(a, b, c, thickness));
}

Place place_of(uint primitive) {
  const Sweep sweep = sweep_of_primitive(primitive);
  Place place;
  place.middle = middle_of(sweep);
  place.half_sides = half_sides(sweep);
  place.half_side = max(place.half_sides.x, max(place.half_sides.y, place.half_sides.z));
  place.kind = primitive >= contact_settings.triangles ? of_edges : of_triangles;
  place.level = level_of(place.half_side);
  place.bucket = bucket_of(cell_at(place.middle, place.level), place.level, place.kind);
  return place;
}
