// The method implicit: the linear system of a substep and its solve (Baraff and Witkin 1998).
#pragma once

#include "engine/effects/spring/spring.h"

namespace weft {

namespace buffers {
/// A spring's 3x3 block in this substep: xyz u, w a of u u^T + a I (kg).
inline constexpr Buffer spring_blocks = scratch<gpu::vec4>("spring_blocks", lengths::spring_places);
/// Inverse Cholesky factor of the diagonal block: xx yy zz, mass (kg; 0: held); yx zx zy, unused.
inline constexpr Buffer inverses = scratch<gpu::vec4>("inverses", [](const Cooked& s) { return 2 * lengths::particles(s); });
/// What particles tell each other in a solve: preconditioned residuals, or Jacobi's last three iterates (m/s).
inline constexpr Buffer exchanged = scratch<gpu::vec4>("exchanged", [](const Cooked& s) { return (s.scene.solver.linear == Linear::jacobi ? 3 : 1) * lengths::particles(s); });
/// Residual (kg m/s); of conjugate gradients also change (m/s), product, search direction, its image.
inline constexpr Buffer krylov = scratch<gpu::vec4>("krylov", [](const Cooked& s) { return (s.scene.solver.linear == Linear::jacobi ? 1 : 5) * lengths::particles(s); });
/// Sums of workgroups (implicit.glsl).
inline constexpr Buffer partial_sums = scratch<gpu::vec4>("partial_sums", lengths::particles);
/// Where the solve is; nothing has arrived between dispatches.
inline constexpr Buffer linear = buffer<gpu::Linear>("linear", Lifetime::scratch, lengths::one, [](const Cooked&) { return made(std::vector<gpu::Linear>(1)); });
/// Cloths whose momentum a solve must not change, and the drift that it gave them.
inline constexpr Buffer free_cloths = buffer<gpu::FreeCloth>("free_cloths", Lifetime::scratch, [](const Cooked& s) { return std::uint64_t(s.fabric.materials.size()); }, [](const Cooked& s) {
  std::vector<gpu::FreeCloth> cloths(s.fabric.materials.size());
  for (std::size_t k = 0; k < s.fabric.cloths.size(); ++k)
    if (s.fabric.cloths[k].anchors == 0) cloths[k] = {s.fabric.cloths[k].first_particle, s.fabric.cloths[k].particles, {0, 0, 0}};
  return made(cloths);
});
/// Two a particle: what colliders decide of a substep (implicit_wall.glsl).
inline constexpr Buffer walls = scratch<gpu::vec4>("walls", [](const Cooked& s) { return 2 * lengths::particles(s); });
}  // namespace buffers
}  // namespace weft
