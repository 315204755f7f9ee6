// A clear sky in closed form, and the frame block that describes it.
//
// Radiance depends on the height y of a direction only: zenith + (horizon - zenith) (1 - y)^4 above, ground below. Its first
// three zonal harmonics, folded with the cosine lobe (Ramamoorthi and Hanrahan 2001), are polynomials: see sky.cpp.
#include "frame.h"

layout(set = 0, binding = 0) uniform FrameBlock { Frame frame; };

const float kPi = 3.14159265;

// What a white matt surface with normal n sends back.
vec3 sky_diffuse(vec3 n) {
  float p2 = 1.5 * n.y * n.y - 0.5;
  return max(frame.ambient[0].rgb + frame.ambient[1].rgb * n.y + frame.ambient[2].rgb * p2, vec3(0));
}

// The sky seen through a lobe of the given width: the border at the horizon widens, and the whole passes into sky_diffuse.
vec3 sky_blurred(vec3 d, float roughness) {
  float up = clamp(d.y, 0.0, 1.0);
  float low = (1.0 - up) * (1.0 - up);
  vec3 above = mix(frame.zenith, frame.horizon, low * low);
  float width = 0.002 + roughness;
  vec3 sharp = mix(frame.ground, above, smoothstep(-width, width, d.y));
  return mix(sharp, sky_diffuse(d), roughness * roughness);
}

// The sky in the picture: with the glow around the sun, which lights nothing since the sun itself does, and in the deeper
// colours that a photograph gives it.
vec3 sky_seen(vec3 d) {
  const float kDeeper = 1.9, kBrighter = 1.5;
  float towards = max(dot(d, frame.to_sun), 0.0);
  float glow = 0.05 * pow(towards, 8.0) + 0.25 * pow(towards, 256.0);
  float up = clamp(d.y, 0.0, 1.0);
  float low = (1.0 - up) * (1.0 - up);
  vec3 sky = mix(frame.zenith, frame.horizon, low * low);
  float grey = dot(sky, vec3(0.2126, 0.7152, 0.0722));
  return kBrighter * max(mix(vec3(grey), sky, kDeeper), vec3(0)) + glow * frame.sun_light;
}
