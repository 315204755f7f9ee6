// The bounding box of a cloth's vertices, for culling: one workgroup a cloth.
#version 450
layout(local_size_x = 128) in;
layout(std430, set = 0, binding = 0) readonly buffer Positions { vec4 positions[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Boxes { vec4 boxes[]; };
layout(push_constant) uniform Cloth { uint first, count, cloth; };

shared vec3 low[128], high[128];

void main() {
  const uint k = gl_LocalInvocationIndex;
  vec3 least = positions[first].xyz, most = least;
  for (uint v = k; v < count; v += 128) {
    const vec3 p = positions[first + v].xyz;
    least = min(least, p), most = max(most, p);
  }
  low[k] = least, high[k] = most;
  for (uint half_of_them = 64; half_of_them > 0; half_of_them /= 2) {
    barrier();
    if (k < half_of_them) low[k] = min(low[k], low[k + half_of_them]), high[k] = max(high[k], high[k + half_of_them]);
  }
  if (k == 0) boxes[2 * cloth] = vec4(low[0], 0), boxes[2 * cloth + 1] = vec4(high[0], 0);
}
