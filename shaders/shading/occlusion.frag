// How much of the sky the surroundings of each pixel hide, found from the depth of the picture.
//
// McGuire, Mara and Luebke, "Scalable ambient obscurance" (2012): points on a disc around the pixel are turned back into
// places in the world; each that is near and above the tangent plane occludes a little. Every pixel of a 4 by 4 block
// rotates the disc by another angle, and smooth.frag averages over such a block.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"

layout(set = 0, binding = 2) uniform sampler depth_sampler;
layout(set = 0, binding = 5) uniform texture2D depths;

layout(location = 0) out float out_open;

float depth_at(ivec2 pixel) {
  return texelFetch(sampler2D(depths, depth_sampler), clamp(pixel, ivec2(0), ivec2(frame.size.xy) - 1), 0).r;
}

vec3 place(ivec2 pixel, float depth) {
  vec2 at = 2.0 * (vec2(pixel) + 0.5) * frame.size.zw - 1.0;
  vec3 ray = frame.ray_z.xyz + at.x * frame.ray_x.xyz + at.y * frame.ray_y.xyz;
  return ray * (frame.near_plane / max(depth, 1e-7));  // from the eye
}

// Of the two neighbours along a direction, the one that lies on the same surface is the nearer one.
vec3 slope(ivec2 pixel, ivec2 step, vec3 centre) {
  vec3 forward = place(pixel + step, depth_at(pixel + step)) - centre;
  vec3 backward = centre - place(pixel - step, depth_at(pixel - step));
  return dot(forward, forward) < dot(backward, backward) ? forward : backward;
}

void main() {
  const int kTaps = 14;
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = depth_at(pixel);
  out_open = 1.0;
  if (depth <= 0.0) return;
  vec3 centre = place(pixel, depth);
  vec3 n = normalize(cross(slope(pixel, ivec2(0, 1), centre), slope(pixel, ivec2(1, 0), centre)));
  if (dot(n, centre) > 0.0) n = -n;
  float r = frame.occlusion_radius, r2 = r * r;
  float pixels = r * depth / frame.near_plane * 0.5 * frame.size.y / length(frame.ray_y.xyz);
  if (pixels < 1.0) return;
  pixels = min(pixels, 0.25 * frame.size.y);
  // An ordered pattern of 16 rotations: neighbours differ much, and each block of 4 by 4 has all of them.
  int turn = ((pixel.x & 3) * 4 + (pixel.y & 3)) * 7 & 15;
  float angle = float(turn) * (2.0 * kPi / 16.0);
  // What is flat must not hide itself through the coarseness of depth.
  float bias = 0.0015 * length(centre) + 0.01 * r;
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float share = (float(i) + 0.5) / float(kTaps);
    float around = angle + share * 2.0 * kPi * 7.0;
    ivec2 at = pixel + ivec2(round(share * pixels * vec2(cos(around), sin(around))));
    vec3 v = place(at, depth_at(at)) - centre;
    float near = max(r2 - dot(v, v), 0.0);
    sum += near * near * near * max((dot(v, n) - bias) / (dot(v, v) + 0.01 * r2), 0.0);
  }
  out_open = max(1.0 - 5.0 * sum * r / (r2 * r2 * r2 * float(kTaps)), 0.0);
}
