// From one simulation's state to another's of a changed scene.
#pragma once

#include <span>
#include <vector>

#include "engine/simulation.h"
#include "engine/snapshot.h"

namespace weft::view {

/// A cloth's or mesh collider's particles that are at work, without those that are spare, and its vertices.
struct Room {
  std::uint32_t first = 0, particles = 0, first_vertex = 0, vertices = 0;
};
/// Of all cloths, then all mesh colliders.
std::vector<Room> rooms_of(const Simulation& simulation);
/// Whether they are of the same meshes, torn alike.
bool are_alike(std::span<const Room> a, std::span<const Room> b);

/// A simulation's state, with what it takes to tell what is whose.
struct State {
  Snapshot snapshot;
  std::vector<Room> rooms;
  double h = 0;   // s, a substep
};

/// `fresh`, of a simulation that has not begun, with what `was` had that fits it: the time, places and velocities, targets of anchors, poses
/// of colliders, gas, skins. What the solver remembers between frames is made anew. Nothing is carried from other meshes, or from one that
/// has torn otherwise: it begins anew.
Snapshot carried(const State& was, State fresh);

}  // namespace weft::view
