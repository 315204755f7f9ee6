// cluster: the box of a cluster, which its members cannot leave before the next detection, and its place in the grid. Needs
// contact/grid.glsl.

struct Box {
  vec3 low, high;   // m
};

struct Place {
  vec3 middle;       // m
  float half_side;   // m, the longest
  uint level, bucket;
};

Place place_of(Box box) {
  precise const vec3 middle = 0.5 * (box.low + box.high), half_sides = 0.5 * (box.high - box.low);
  Place place;
  place.middle = middle;
  place.half_side = max(half_sides.x, max(half_sides.y, half_sides.z));
  place.level = level_of(place.half_side);
  place.bucket = bucket_of(cell_at(place.middle, place.level), place.level);
  return place;
}
