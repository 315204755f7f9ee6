// From radiance to the picture. The target is an sRGB format, so the last step, the encoding, is the hardware's.

// Fit of the ACES reference tone curve (Narkowicz 2015), applied to each channel.
vec3 tone_curve(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

// A wide gradient in eight bits shows bands; half a step of noise, the same each time, hides them.
// The noise: interleaved gradient noise (Jimenez 2014).
vec3 dithered(vec3 linear, vec2 pixel) {
  float noise = fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
  // Near the code value c, encoded by about c = x^(1/2.2), one step of 1/255 is 2.2 c^1.2 / 255 of linear light.
  return max(linear + noise / 255.0 * 2.2 * pow(max(linear, vec3(1e-4)), vec3(1.2 / 2.2)), vec3(0));
}

vec4 picture(vec3 radiance, vec2 pixel) { return vec4(dithered(tone_curve(radiance * frame.exposure), pixel), 1.0); }
