// The host engine's gameplay: a beam that carries a curtain to and fro, and a ball that swings through it.
//
// Times are the game's clock, in seconds; where things are depends on nothing else, so every run shows the same.
#pragma once

#include "engine/scene.h"

namespace host {

inline constexpr float kBallRadius = 0.28f;                      // m
inline constexpr weft::Vec3 kBeamSize{1.8f, 0.05f, 0.05f};       // m
inline constexpr weft::Vec2 kCurtainSize{1.6f, 1.5f};            // m
inline constexpr std::uint32_t kBall = 0;                        // its collider in cloth_scene

weft::Vec3 beam(double time);
weft::Vec3 ball(double time);

/// What Weft is told at `time`: a curtain under the beam, held along its top edge, the ball and the floor.
weft::Scene cloth_scene(double time);

}  // namespace host
