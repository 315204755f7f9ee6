// Writes the group counts of a dispatch that covers push.count values with 64 threads a group, and of none at all when
// the first value is 0.
#version 450

layout(local_size_x = 1) in;
layout(set = 0, binding = 0) readonly buffer VALUES { uint values[]; };
layout(set = 0, binding = 1) writeonly buffer ARGUMENTS { uint groups[3]; };
layout(push_constant) uniform Push {
  uint count;
  uint term;
} push;

void main() {
  groups[0] = (push.count + 63) / 64;
  groups[1] = min(values[0], 1);
  groups[2] = 1;
}
