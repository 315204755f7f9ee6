// The air: lift and drag of the triangles of cloth against the moving air.
#pragma once

#include <array>

#include "engine/effects/buffer.h"

namespace weft {

/// How far the air has come, besides the time: the host may change the wind, and move fields.
struct AirState {
  Vec3 wind;                   // m/s
  std::vector<Air::Field> fields;   // relative to the particles' origin
  std::array<double, 3> travelled{};   // m: the wind's way since the start, which carries eddies along

  void pass(double seconds);   // s
};

/// The air of a frame of `seconds` that begins at `time` (s); particles are relative to `origin` (m).
struct MovingAir {
  gpu::Air air;
  std::uint32_t used = 0;   // of waves
  std::array<gpu::AirWave, WEFT_AIR_WAVES> waves{};
  std::array<gpu::AirField, WEFT_AIR_FIELDS> fields{};
};
MovingAir air_of(const Air& air, const AirState& state, double time, double seconds, Vec3 origin);

/// Of each particle its fans (fans.h), one after another, filled up with itself and an area of 0.
struct AirLists {
  PairRows fans;   // entries: (particle, that as float bits)
};

/// Cloths and mesh colliders that have wakes: first triangle, triangles, number of the body (motion/body.glsl), 0.
struct WakeLists {
  std::vector<gpu::uvec4> bodies;
};

/// Substeps from one look at the air to the next, so that it takes no longer than 1/300 s: with the default two.
std::uint32_t air_every(const Cooked& subject);

namespace buffers {
/// Gusts and eddies of the frame.
inline constexpr Buffer air_waves =
    buffer<gpu::AirWave>("air_waves", Lifetime::uploaded, [](const Cooked&) { return std::uint64_t(WEFT_AIR_WAVES); });
/// Of the frame.
inline constexpr Buffer air_fields =
    buffer<gpu::AirField>("air_fields", Lifetime::uploaded, [](const Cooked&) { return std::uint64_t(WEFT_AIR_FIELDS); });
/// Of each particle: first pair, number of pairs.
inline constexpr Buffer air_rows = own<gpu::uvec2, &AirLists::fans, &PairRows::rows>("air_rows");
inline constexpr Buffer air_fans = own<gpu::uvec4, &AirLists::fans, &PairRows::pairs>("air_fans");
/// Two a particle: xyz what the air's velocity differs from the wind by where it is when the frame begins, as it is then, and as it is when the
/// frame ends (m/s).
inline constexpr Buffer air_stirred = scratch<gpu::vec4>("air_stirred", [](const Cooked& s) { return 2 * lengths::particles(s); });
inline constexpr Buffer wake_bodies = own<gpu::uvec4, &WakeLists::bodies>("wake_bodies");
/// Of each of them the disc that it is to the wind: xyz middle, w radius (m).
inline constexpr Buffer wakes =
    scratch<gpu::vec4>("wakes", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<WakeLists>().bodies.size()); });
}  // namespace buffers
}  // namespace weft
