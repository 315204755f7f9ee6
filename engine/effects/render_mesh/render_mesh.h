// Render meshes: finer meshes that coarse cloth carries, to be drawn in its place.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

struct RenderMeshLists {
  std::vector<gpu::Carried> carried;   // every vertex of every render mesh
};

namespace buffers {
inline constexpr Buffer carried = own<gpu::Carried, &RenderMeshLists::carried>("carried");
}  // namespace buffers

}  // namespace weft
