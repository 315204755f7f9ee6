// Every key of a scene as a widget: the tables that scenes are read by (engine/scene/fields.h), walked by a visitor that draws.
#pragma once

#include <string>
#include <vector>

#include "engine/scene.h"

namespace weft::view {

/// What widgets remember from frame to frame.
struct Tuning {
  unsigned typed_in = 0;             // ImGui's number of the list that is being typed; 0: none
  std::string typed;                 // what it says by now
  std::vector<std::string> faults;   // sentences: lists that cannot be read, with their paths. They stay as they were
};

/// Draws the widgets of all of a scene's keys into the current window. True where a value was changed for good: a box was ticked, or a
/// number or a text was let go of. `scene` then holds it; whether it is a scene that can be is check()'s to say.
bool tune(Scene& scene, Tuning& tuning);

}  // namespace weft::view
