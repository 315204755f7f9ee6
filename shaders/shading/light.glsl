// Light that reaches a surface and what the surface makes of it.
//
// GGX (Walter 2007) with height-correlated Smith visibility (Heitz 2014) and Schlick's Fresnel (1994); fuzz by the Charlie
// sheen (Estevez and Kulla 2017) with Neubelt's visibility (2013); ambient specular by Karis's fit of the environment
// BRDF (2014, after Lazarov 2013). Soft shadows after Fernando (2005).
layout(set = 0, binding = 1) uniform texture2D sun_depths;
layout(set = 0, binding = 2) uniform sampler depth_sampler;
layout(set = 0, binding = 3) uniform samplerShadow compare_sampler;
layout(set = 0, binding = 4) uniform texture2D occlusion_map;

struct Surface {
  vec3 position;      // m
  vec3 normal;        // unit, towards the viewer
  vec3 smooth_normal; // the same without a normal map
  vec3 albedo;
  float roughness;
  float metallic;
  float occlusion;    // 1: open
  float fuzz;         // 0: none
  float transmission;
};

// Points of a disc, evenly: Vogel's spiral (1979).
vec2 disc_point(int i, int count) {
  float angle = float(i) * 2.39996323;
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// The share of the sun that reaches a point: 0 ... 1. Percentage-closer soft shadows: first the mean distance to the blockers, which
// gives the width of the penumbra, then comparisons over that width. `side` is the surface's normal on the sun's side: the point moves
// a little off its surface, and taps beside it are compared with the surface's own plane, so that nothing shadows itself.
float sun_share(vec3 position, vec3 side) {
  const int kSearch = 10, kTaps = 24;
  const float kNarrow = 1.6, kWide = 9.0;  // texels: below, steps show; above, single taps show
  const float kSun = 0.05;                 // m of penumbra a metre of distance: a sun behind thin haze
  const float kSteepest = 4.0;             // m of depth a metre across; what is steeper gets next to no light anyway
  vec4 clip = frame.sun * vec4(position + frame.sun_texel * (1.5 * side + frame.to_sun), 1.0);
  if (any(greaterThan(abs(clip.xy), vec2(0.99)))) return 1.0;
  float texels = float(textureSize(sampler2D(sun_depths, depth_sampler), 0).x);
  vec3 at = vec3(0.5 * texels * (clip.xy + 1.0), min(clip.z, 1.0));
  // How deep the surface's plane gets a texel to the right and a texel down. Both rows have the length 2 / (texels sun_texel).
  vec3 right = vec3(frame.sun[0][0], frame.sun[1][0], frame.sun[2][0]);
  vec3 down = vec3(frame.sun[0][1], frame.sun[1][1], frame.sun[2][1]);
  vec2 across = vec2(dot(side, right), dot(side, down)) * (0.5 * texels * frame.sun_texel);
  vec2 slope = across / max(dot(side, frame.to_sun), 1e-3);
  slope *= min(1.0, kSteepest / max(length(slope), 1e-6)) * frame.sun_texel / frame.sun_depth;

  float sum = 0.0, found = 0.0;
  for (int i = 0; i < kSearch; ++i) {
    vec2 beside = kWide * disc_point(i, kSearch);
    float nearer = at.z + dot(slope, beside) - texture(sampler2D(sun_depths, depth_sampler), (at.xy + beside) / texels).r;
    if (nearer > 0.0) {
      sum += nearer;
      found += 1.0;
    }
  }
  if (found == 0.0) return 1.0;
  float radius = clamp(kSun * sum / found * frame.sun_depth / frame.sun_texel, kNarrow, kWide);
  float lit = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    vec2 beside = radius * disc_point(i, kTaps);
    lit += texture(sampler2DShadow(sun_depths, compare_sampler), vec3((at.xy + beside) / texels, at.z + dot(slope, beside)));
  }
  return lit / float(kTaps);
}

float ggx_distribution(float n_h, float alpha) {
  float d = n_h * n_h * (alpha * alpha - 1.0) + 1.0;
  return alpha * alpha / (kPi * d * d);
}

float smith_visibility(float n_l, float n_v, float alpha) {
  float a2 = alpha * alpha;
  float view = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2);
  float light = n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
  return 0.5 / max(view + light, 1e-5);
}

float charlie_sheen(float n_h, float n_l, float n_v) {
  const float kInverseAlpha = 1.0 / 0.45;
  float sine = sqrt(max(1.0 - n_h * n_h, 0.0));
  float distribution = (2.0 + kInverseAlpha) * pow(sine, kInverseAlpha) / (2.0 * kPi);
  return distribution / (4.0 * max(n_l + n_v - n_l * n_v, 1e-4));
}

vec3 environment_brdf(vec3 f0, float roughness, float n_v) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
  vec2 scale = vec2(-1.04, 1.04) * a + r.zw;
  return f0 * scale.x + scale.y;
}

vec3 sun_reflected(Surface s, vec3 view, float n_v, vec3 f0, vec3 matt) {
  float n_l = dot(s.normal, frame.to_sun);
  float smooth_l = dot(s.smooth_normal, frame.to_sun);
  // Light from behind shines through a thin cloth, spread evenly.
  float side = smooth_l < 0.0 ? -1.0 : 1.0;
  if (side < 0.0 && s.transmission == 0.0) return vec3(0);
  float share = sun_share(s.position, side * s.smooth_normal);
  if (share == 0.0) return vec3(0);
  vec3 through = s.transmission * matt * clamp(-n_l, 0.0, 1.0);
  if (n_l <= 0.0 || side < 0.0) return share * through * frame.sun_light;
  vec3 halfway = normalize(view + frame.to_sun);
  float n_h = clamp(dot(s.normal, halfway), 0.0, 1.0);
  float v_h = clamp(dot(view, halfway), 0.0, 1.0);
  float alpha = s.roughness * s.roughness;
  vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - v_h, 5.0);
  vec3 specular = ggx_distribution(n_h, alpha) * smith_visibility(n_l, n_v, alpha) * fresnel;
  vec3 sheen = s.fuzz * mix(vec3(1), s.albedo, 0.6) * charlie_sheen(n_h, n_l, n_v);
  // sun_light is what white sends back, pi times less than what arrives.
  return share * n_l * frame.sun_light * ((1.0 - fresnel) * matt + kPi * (specular + sheen));
}

vec3 sky_reflected(Surface s, vec3 view, float n_v, vec3 f0, vec3 matt) {
  vec3 mirrored = reflect(-view, s.normal);
  vec3 diffuse = matt * ((1.0 - s.transmission) * sky_diffuse(s.normal) + s.transmission * sky_diffuse(-s.normal));
  vec3 specular = environment_brdf(f0, s.roughness, n_v) * sky_blurred(mirrored, s.roughness);
  vec3 sheen = s.fuzz * mix(vec3(1), s.albedo, 0.6) * pow(1.0 - n_v, 3.0) * sky_diffuse(s.normal);
  // Light that bounces inside a fold takes the cloth's colour: Jimenez et al. (2016), their cubic in albedo.
  vec3 a = 2.0404 * s.albedo - 0.3324, b = -4.7951 * s.albedo + 0.6417, c = 2.7552 * s.albedo + 0.6903;
  vec3 open = max(vec3(s.occlusion), ((s.occlusion * a + b) * s.occlusion + c) * s.occlusion);
  return diffuse * open + (specular + sheen) * s.occlusion;
}

vec3 reflected(Surface s) {
  vec3 view = normalize(frame.eye - s.position);
  float n_v = max(dot(s.normal, view), 1e-3);
  vec3 f0 = mix(vec3(0.04), s.albedo, s.metallic);
  vec3 matt = s.albedo * (1.0 - s.metallic);
  return sun_reflected(s, view, n_v, f0, matt) + sky_reflected(s, view, n_v, f0, matt);
}

float screen_occlusion() { return texelFetch(sampler2D(occlusion_map, depth_sampler), ivec2(gl_FragCoord.xy), 0).r; }
