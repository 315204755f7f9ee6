// sum: what the passes of the gas add up: x, y and z; of w they take the largest.

vec4 joined(vec4 a, vec4 b) { return vec4(a.xyz + b.xyz, max(a.w, b.w)); }

shared vec4 values[gl_WorkGroupSize.x];

// Over a workgroup, all of whose threads must call it; valid for the first thread, which adds alone as in implicit/implicit.glsl.
vec4 sum_of_group(vec4 value) {
  values[gl_LocalInvocationID.x] = value;
  barrier();
  if (gl_LocalInvocationID.x == 0)
    for (uint k = 1; k < gl_WorkGroupSize.x; ++k) value = joined(value, values[k]);
  return value;
}
