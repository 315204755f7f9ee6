// Writes the group counts of a dispatch that covers push.count values with 64 threads a group.
#version 450

layout(local_size_x = 1) in;
layout(set = 0, binding = 1) writeonly buffer ARGUMENTS { uint groups[3]; };
layout(push_constant) uniform Push {
  uint count;
  uint term;
} push;

void main() {
  groups[0] = (push.count + 63) / 64;
  groups[1] = 1;
  groups[2] = 1;
}
