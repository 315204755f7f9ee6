// put_outline: the outline of a primitive, and the box of that, for the search. Needs contact/outline.glsl, contact/cluster.glsl,
// contact/outline_box.glsl and the buffers.

void put_outline(uint primitive, Outline outline, uint cluster) {
  const Box box = box_of(outline);
  const uvec2 packed = pack_box(box_at(cluster), box);
  if (primitive % 2 == 0) outline_boxes[primitive / 2].xy = packed;
  else outline_boxes[primitive / 2].zw = packed;
  outlines[3 * primitive] = vec4(outline.middle, outline.reach);
  outlines[3 * primitive + 1] = vec4(outline.half_sides, 0);
  outlines[3 * primitive + 2] = vec4(outline.trajectory, 0);
}
