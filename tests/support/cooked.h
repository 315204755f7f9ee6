// A scene's fabric.
#pragma once

#include "engine/fabric.h"
#include "tests/support/must.h"

namespace weft {

inline CookedFabric cooked(const Scene& scene) { return must(cook(scene, must(make_meshes(scene)))); }

}  // namespace weft
