// Averages the occlusion over one 4 by 4 block of its pattern, leaving out what lies at another depth.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"

layout(set = 0, binding = 2) uniform sampler depth_sampler;
layout(set = 0, binding = 5) uniform texture2D depths;
layout(set = 0, binding = 6) uniform texture2D rough_occlusion;

layout(location = 0) out float out_open;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = ivec2(frame.size.xy) - 1;
  float centre = texelFetch(sampler2D(depths, depth_sampler), pixel, 0).r;
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), last);
      float depth = texelFetch(sampler2D(depths, depth_sampler), at, 0).r;
      // Depth is near / z, so a ratio of depths is one of distances.
      float same = max(1.0 - 30.0 * abs(depth / max(centre, 1e-7) - 1.0), 0.001);
      sum += same * texelFetch(sampler2D(rough_occlusion, depth_sampler), at, 0).r;
      weight += same;
    }
  }
  out_open = sum / weight;
}
