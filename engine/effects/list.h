// Every effect there is. Within a stage of a frame their passes run in this order.
//
// An effect is a folder of this name: its passes and reference kernels in shaders/, its declaration and its cooking in
// engine/effects/, its tests in tests/effects/. C++ makes the table of effects from this list (effects.h), and CMake the
// list of folders to build.
#pragma once

#define WEFT_EFFECTS(EFFECT) \
  EFFECT(anchor) \
  EFFECT(level) \
  EFFECT(strand) \
  EFFECT(stretch) \
  EFFECT(gauss_seidel) \
  EFFECT(shift) \
  EFFECT(bend) \
  EFFECT(dihedral) \
  EFFECT(spring) \
  EFFECT(implicit) \
  EFFECT(chebyshev) \
  EFFECT(tether) \
  EFFECT(collide) \
  EFFECT(support) \
  EFFECT(reaction) \
  EFFECT(triangle) \
  EFFECT(inertia) \
  EFFECT(motion) \
  EFFECT(bdf2) \
  EFFECT(grab) \
  EFFECT(air) \
  EFFECT(pressure) \
  EFFECT(tear) \
  EFFECT(contact) \
  EFFECT(untangle) \
  EFFECT(skin) \
  EFFECT(motion_constraint) \
  EFFECT(surface) \
  EFFECT(render_mesh)
