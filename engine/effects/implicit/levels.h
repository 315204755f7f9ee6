// Coarse levels as a preconditioner of the method implicit. Internal.
#pragma once

#include "engine/cook/cook_state.h"

namespace weft::effects {

/// Makes ImplicitLevels of LevelLists and springs, where the method is implicit.
void grip_levels(cooking::CookState& state);

}  // namespace weft::effects
