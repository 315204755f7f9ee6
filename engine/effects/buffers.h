// The headers of all buffers.
#pragma once

#include "engine/effects/anchor/anchor.h"
#include "engine/effects/bend/bend.h"
#include "engine/effects/chebyshev/chebyshev.h"
#include "engine/effects/collide/collide.h"
#include "engine/effects/contact/contact.h"
#include "engine/effects/dihedral/dihedral.h"
#include "engine/effects/gauss_seidel/gauss_seidel.h"
#include "engine/effects/implicit/implicit.h"
#include "engine/effects/level/level.h"
#include "engine/effects/motion/motion.h"
#include "engine/effects/spring/spring.h"
#include "engine/effects/strand/strand.h"
#include "engine/effects/stretch/stretch.h"
#include "engine/effects/surface/surface.h"
#include "engine/effects/tether/tether.h"
#include "engine/effects/triangle/triangle.h"
