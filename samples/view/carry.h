// From one simulation's state to another's of a changed scene.
#pragma once

#include "engine/snapshot.h"

namespace weft::view {

/// `fresh`, a snapshot of a simulation that has not begun, with what `was` had that fits it: the time, places and velocities, targets of
/// anchors, poses of colliders, gas, skins. Substeps are of `h_was` and `h` s. What the solver remembers between frames is made anew.
/// Nothing is carried of another number of particles: it begins anew.
Snapshot carried(const Snapshot& was, double h_was, Snapshot fresh, double h);

}  // namespace weft::view
