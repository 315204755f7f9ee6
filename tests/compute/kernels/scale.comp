// value = factor * value + term, for every value.
#version 450

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint factor = 1;
layout(set = 0, binding = 0) buffer VALUES { uint values[]; };
layout(push_constant) uniform Push {
  uint count;
  uint term;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  values[i] = factor * values[i] + push.term;
}
