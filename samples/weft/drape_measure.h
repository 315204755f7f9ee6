// Cusick's drape coefficient of cloth that hangs over the rim of what holds it.
#pragma once

#include <optional>
#include <span>

#include "engine/fabric.h"

namespace weft::command {

/// The share that a cloth's shadow, straight down, has of what hangs free: (shadow - plate) / (cloth - plate), the plate being the
/// triangles whose corners are all held (Cusick 1968, "The measurement of fabric drape"; ISO 9073-9). 1: it stands out flat; 0: it hangs
/// straight down. `start`: its particles lying flat, w = 0 where they are held. Where folds lie over each other the shadow counts once.
/// None where no triangle is held, where nothing hangs free, and of cloth that stands upright.
std::optional<double> drape_coefficient(const CookedFabric& fabric, const ClothRange& cloth, std::span<const gpu::vec4> start,
                                        std::span<const gpu::vec4> positions);

}  // namespace weft::command
