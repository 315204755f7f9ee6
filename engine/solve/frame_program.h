// The structure of a frame, in one place: walked to list dispatches, to count them, and to refuse too many.
//
//     frame_begin
//     for each substep:
//       substep_begin   force   detect
//       [assemble   linear x iterations]                 the method implicit, which then has a single iteration
//       for each iteration:   iteration   contacts   contact x contact iterations
//       slide x 2
//       substep_end
//     frame_end
#pragma once

#include <cstdint>
#include <span>

#include "engine/effects/effect.h"

namespace weft {

struct FrameShape {
  std::uint32_t iterations = 1;           // of a substep; of its solve, with the method implicit
  std::uint32_t contact_iterations = 1;   // of contacts, in each of them
  bool implicit = false;
  std::uint32_t solver_iterations() const { return implicit ? 1 : iterations; }
};

inline FrameShape shape_of(const Scene& scene) {
  return {scene.solver.iterations, scene.contacts.iterations, scene.solver.method == Method::implicit};
}

/// Where in a frame a stage runs. `iteration` counts those of the solve in Stage::linear, else those of the substep.
struct Moment {
  Stage stage;
  std::uint32_t substep = 0, iteration = 0;
};

template <class Visit>
void walk_frame(const FrameShape& shape, std::uint32_t substeps, Visit&& visit) {
  visit(Moment{Stage::frame_begin});
  for (std::uint32_t s = 0; s < substeps; ++s) {
    visit(Moment{Stage::substep_begin, s});
    visit(Moment{Stage::force, s});
    visit(Moment{Stage::detect, s});
    if (shape.implicit) {
      visit(Moment{Stage::assemble, s});
      for (std::uint32_t k = 0; k < shape.iterations; ++k) visit(Moment{Stage::linear, s, k});
    }
    for (std::uint32_t k = 0; k < shape.solver_iterations(); ++k) {
      visit(Moment{Stage::iteration, s, k});
      visit(Moment{Stage::contacts, s, k});
      for (std::uint32_t c = 0; c < shape.contact_iterations; ++c) visit(Moment{Stage::contact, s, k});
    }
    for (std::uint32_t k = 0; k < WEFT_SLIDES; ++k) visit(Moment{Stage::slide, s, k});
    visit(Moment{Stage::substep_end, s});
  }
  visit(Moment{Stage::frame_end});
}

/// How often a stage runs in a frame.
inline std::uint64_t runs_of(Stage stage, const FrameShape& shape, std::uint32_t substeps) {
  // All substeps are alike.
  std::uint64_t runs[2] = {0, 0};
  for (const std::uint32_t n : {0u, 1u}) walk_frame(shape, n, [&](const Moment& moment) { runs[n] += moment.stage == stage; });
  return runs[0] + substeps * (runs[1] - runs[0]);
}

}  // namespace weft
