// Ambient light in closed form.
//
// The sky depends on the height y of a direction only, L(y) = Z + (H - Z) (1 - y)^4 above the horizon and G below, so its
// spherical harmonics are Legendre moments m_l = integral of L P_l over -1 ... 1:
//
//     above   integral of (1 - y)^4         1/5      of y (1 - y)^4     1/30     of P_2 (1 - y)^4   -3/35
//             integral of 1                 1        of y               1/2      of P_2              0
//     below   integral of 1                 1        of y              -1/2      of P_2              0
//
// The cosine lobe keeps 1, 2/3 and 1/4 of the first three (Ramamoorthi and Hanrahan, "An efficient representation for
// irradiance environment maps", 2001), so a white matt surface with normal n sends back
//
//     sum over l of (2 l + 1) / 2  m_l  {1, 2/3, 1/4}_l  P_l(n_y).
#include "engine/shading/sky.h"

#include <algorithm>

namespace weft::shading {
namespace {

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// A clear day with thin haze. Upward faces see about (Z + H / 15): close to 1 in luminance.
constexpr Vec3 kZenith{0.60f, 0.84f, 1.22f};
constexpr Vec3 kHorizon{1.90f, 2.12f, 2.40f};

}  // namespace

void set_sky(Frame& frame, const Light& light, Vec3 floor) {
  const float sky = static_cast<float>(light.sky), sun = static_cast<float>(light.sun);
  frame.zenith = sky * kZenith;
  frame.horizon = sky * kHorizon;
  frame.sun_light = sun * light.colour;

  const float towards = length(light.direction);
  frame.to_sun = (-1 / towards) * light.direction;

  // The ground is lit by the sky and, where nothing shades it, by the sun; what stands on it sees about half of it in shade.
  const Vec3 lit = sky * (kZenith + (1.0f / 15) * (kHorizon - kZenith)) + (0.5f * std::max(frame.to_sun.y, 0.0f)) * frame.sun_light;
  frame.ground = times(floor, lit);

  const Vec3 fall = frame.horizon - frame.zenith;
  const Vec3 m0 = frame.zenith + (1.0f / 5) * fall + frame.ground;
  const Vec3 m1 = 0.5f * frame.zenith + (1.0f / 30) * fall - 0.5f * frame.ground;
  const Vec3 m2 = (-3.0f / 35) * fall;
  const auto store = [&](int l, Vec3 v) { frame.ambient[l] = {v.x, v.y, v.z, 0}; };
  store(0, 0.5f * m0);
  store(1, (1.5f * 2 / 3) * m1);
  store(2, (2.5f * 1 / 4) * m2);

  // As an incident-light meter would: white cloth that half faces the sun comes out just below white.
  constexpr float kKey = 0.72f;
  frame.exposure = kKey / std::max(0.7f * sun + sky, 1e-4f);
}

}  // namespace weft::shading
