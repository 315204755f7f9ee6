// Motion: the prediction by free flight, and the finalize pass for iterations that no other pass can finalize.
#include "engine/effects/motion/motion.h"

#include <algorithm>

#include "engine/effects/effect.h"

namespace weft {

std::vector<gpu::vec4> iterates_at(const std::vector<gpu::vec4>& positions, const CookedFabric& fabric) {
  std::vector<gpu::vec4> iterates = positions;
  for (std::size_t i = 0; i < iterates.size(); ++i) iterates[i].w = fabric.iterate_weights[i];
  return iterates;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::positions,    &buffers::velocities, &buffers::predicted,
                                      &buffers::next_iterate, &buffers::materials,  &buffers::counters};

constexpr Pass kPasses[] = {
    {.name = "predict", .stage = Stage::frame_begin, .threads = threads::particles, .with_contacts = "+watch"},
    // Only where no other pass can finalize the iteration (engine/solve/plan.cpp).
    {.name = "finalize", .stage = Stage::iteration, .threads = threads::particles, .changes = Changes::iterate, .can_finalize = true},
};

Contents uniforms(const Cooked& s) {
  const double h = solve_step(s.scene, s.fabric);
  const SolverSettings& solver = s.scene.solver;
  gpu::Motion motion{};
  motion.h = static_cast<float>(h);
  motion.inverse_h = static_cast<float>(1 / h);
  motion.inverse_h2 = static_cast<float>(1 / (h * h));
  motion.substep = static_cast<float>(s.fabric.h);
  motion.inverse_substep = static_cast<float>(1 / s.fabric.h);
  motion.relaxation = static_cast<float>(solver.method == Method::implicit ? s.fabric.jacobi_weight : relaxation_of(s.scene));
  motion.gravity = {s.scene.gravity.x, s.scene.gravity.y, s.scene.gravity.z};
  return made(std::vector{motion});
}

// Whether some body has several.
bool vary(const std::vector<gpu::Material>& materials) {
  const auto same_body = [](const gpu::Material& a, const gpu::Material& b) { return a.body == b.body; };
  return std::ranges::adjacent_find(materials, same_body) != materials.end();
}

}  // namespace

constinit const Effect motion{
    .name = "motion",
    .called_for = [](const Scene&, const CookedFabric&) { return true; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          constants[gpu::constant::has_maps] = vary(s.fabric.materials);
          constants[gpu::constant::is_iterated] = s.scene.solver.iterations > 1 && s.scene.solver.method != Method::implicit;
        },
    .slice = {"motion", uniforms},
    .reference = Reference::modelled,
};

}  // namespace effects
}  // namespace weft
