// Twin of anchor: a held particle goes straight and evenly from where it was at the frame's start to its target.
#pragma once

#include "shaders/relax.ref.h"

namespace weft::reference {

/// `fraction`: of the frame, at the substep's end.
inline Vector anchor_at(const Vector& from, const Vector& to, double fraction) { return from + fraction * (to - from); }

}  // namespace weft::reference
