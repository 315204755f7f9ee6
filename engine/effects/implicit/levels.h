// Coarse levels as a preconditioner of the method implicit. Internal.
#pragma once

#include "engine/fabric.h"

namespace weft::effects {

/// Makes ImplicitLevels of LevelLists and springs, of scenes that have both.
void grip_levels(CookedFabric& fabric);

}  // namespace weft::effects
