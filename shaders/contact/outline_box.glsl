// outline_box: the box that an outline cannot leave before the next detection, in 65,535ths of its cluster's box: the search fetches it at
// once. Rounded away from its middle. Needs contact/cluster.glsl.

const float kGrains = 65535;

vec3 grains(Box cluster, vec3 x) { return kGrains * ((x - cluster.low) / (cluster.high - cluster.low)); }

uvec3 grains_below(Box cluster, vec3 x) { return uvec3(clamp(floor(grains(cluster, x)) - 1, 0, kGrains)); }
uvec3 grains_above(Box cluster, vec3 x) { return uvec3(clamp(ceil(grains(cluster, x)) + 1, 0, kGrains)); }

Box box_of(Outline outline) {
  const vec3 end = outline.middle + outline.trajectory, size = abs(outline.half_sides) + outline.reach;
  return Box(min(outline.middle, end) - size, max(outline.middle, end) + size);
}
