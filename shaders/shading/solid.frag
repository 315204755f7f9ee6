// Floor and colliders: one colour each; a floor has a faint pattern and passes into the horizon.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"
#include "light.glsl"
#include "tone.glsl"

layout(push_constant) uniform Push { Solid solid; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_plane;
layout(location = 0) out vec4 out_colour;

// Tiles with joints, averaged over the pixel: the integral of each pattern over its width, so that nothing flickers far away.
float tiles(vec2 at) {
  vec2 width = max(fwidth(at), vec2(1e-5));
  vec2 triangle = abs(fract(at * 0.5) * 2.0 - 1.0);
  vec2 side = clamp((triangle - 0.5) / width, -0.5, 0.5);
  float checker = 2.0 * side.x * side.y * 2.0;  // -1 ... 1
  vec2 from_joint = abs(fract(at - 0.5) - 0.5);
  const float kJoint = 0.012;
  vec2 covered = clamp((kJoint - from_joint) / width + 0.5, 0.0, 1.0) * min(vec2(1), 2.0 * kJoint / width);
  float joint = max(covered.x, covered.y);
  float near = clamp(1.0 - 1.5 * max(width.x, width.y), 0.0, 1.0);
  return (1.0 + 0.045 * near * checker) * (1.0 - 0.18 * near * joint);
}

void main() {
  Surface s;
  s.position = in_position;
  s.normal = normalize(in_normal);
  s.smooth_normal = s.normal;
  s.albedo = solid.colour;
  if (solid.cell > 0.0) s.albedo *= tiles(in_plane / solid.cell);
  s.roughness = solid.roughness;
  s.metallic = 0.0;
  s.occlusion = screen_occlusion();
  s.fuzz = 0.0;
  s.transmission = 0.0;
  vec3 radiance = reflected(s);
  if (solid.shape == WEFT_SHAPE_PLANE) {
    vec3 ray = in_position - frame.eye;
    float far = length(ray) / frame.fade;
    vec3 horizon = sky_seen(normalize(vec3(ray.x, 0.0, ray.z) + vec3(1e-6, 0, 0)));
    radiance = mix(horizon, radiance, exp(-far * far));
  }
  out_colour = picture(radiance, gl_FragCoord.xy);
}
