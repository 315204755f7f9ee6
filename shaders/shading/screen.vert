// One triangle that covers the picture, at the far end.
#version 460

layout(location = 0) out vec2 out_at;  // -1 ... 1, downward

void main() {
  out_at = vec2((gl_VertexIndex & 1) * 4 - 1, (gl_VertexIndex & 2) * 2 - 1);
  gl_Position = vec4(out_at, 0.0, 1.0);
}
