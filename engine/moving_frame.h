// A frame that cloth goes with: of a character, a vehicle, a room.
#pragma once

#include "engine/vector.h"

namespace weft {

/// Where such a frame is. It moves by rigid maps.
struct MovingFrame {
  Vec3 place;            // m, of its origin
  Rotation rotation{};
  bool operator==(const MovingFrame&) const = default;
};

}  // namespace weft
