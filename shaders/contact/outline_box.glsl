// outline_box: the box that an outline cannot leave before the next detection, in grains of its cluster's box, so small that the search
// fetches two at once. Rounded away from its middle. Needs contact/cluster.glsl.
//
// A corner is a word of three fields, each with a bit to spare above it. Where these are set in one word and another is subtracted, those
// stay set whose field was no less (Lamport 1975): a single subtraction compares all three.

const vec3 kGrains = vec3(1023, 1023, 511);
const uint kSpare = 1u << 10 | 1u << 21 | 1u << 31;

uint corner(vec3 grains) {
  const uvec3 g = uvec3(clamp(grains, vec3(0), kGrains));
  return g.x | g.y << 11 | g.z << 22;
}

vec3 grains(Box cluster, vec3 x) { return kGrains * ((x - cluster.low) / (cluster.high - cluster.low)); }

// Of a box: x the lower corner, y the upper one with the spare bits. A 64th of a grain is more than rounding errors are.
uvec2 pack_box(Box cluster, Box box) {
  return uvec2(corner(floor(grains(cluster, box.low) - 1.0 / 64)), corner(ceil(grains(cluster, box.high) + 1.0 / 64)) | kSpare);
}

bool overlap(uvec2 a, uvec2 b) { return (a.y - b.x & b.y - a.x & kSpare) == kSpare; }

Box box_of(Outline outline) {
  const vec3 end = outline.middle + outline.trajectory, size = abs(outline.half_sides) + outline.reach;
  return Box(min(outline.middle, end) - size, max(outline.middle, end) + size);
}
