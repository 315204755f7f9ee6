// Every key of a scene as a widget: the tables that scenes are read by (engine/scene/fields.h), walked by a visitor that draws.
#pragma once

#include "engine/scene.h"

namespace weft::view {

/// Draws the widgets of all of a scene's keys into the current window. True where a value was changed for good: a box was ticked, or a
/// number was let go of. `scene` then holds it; whether it is a scene that can be is check()'s to say.
bool tune(Scene& scene);

}  // namespace weft::view
