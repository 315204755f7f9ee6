// The method implicit: implicit Euler on springs, one linear system a substep (Baraff and Witkin 1998).
#pragma once

#include <algorithm>

#include "engine/effects/level/level.h"
#include "engine/effects/spring/spring.h"

namespace weft {

/// Whether nothing holds a cloth.
inline bool is_free(const CookedFabric& fabric, const ClothRange& cloth) {
  const auto particles = std::span(fabric.positions).subspan(cloth.first_particle, cloth.particles);
  return std::ranges::all_of(particles, [](const gpu::vec4& x) { return x.w > 0; });
}

/// Coarse levels as a preconditioner (shaders/implicit/mean.glsl).
struct ImplicitLevels {
  std::vector<float> grips;   // 1/kg, of each of LevelLists::nodes: g of mean.glsl; below 0: it is held
};

namespace buffers {
inline constexpr Buffer level_grips = own<float, &ImplicitLevels::grips>("level_grips");
/// The mean residual over the mass of what each node carries (m/s).
inline constexpr Buffer level_residuals =
    scratch<gpu::vec4>("level_residuals", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// Four a node: S of mean.glsl (kg), xx yy zz; yx zx zy; and likewise H.
inline constexpr Buffer level_blocks =
    scratch<gpu::vec4>("level_blocks", [](const Cooked& s) { return 4 * std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// The change that each node and those that carry it ask for (m/s).
inline constexpr Buffer level_changes =
    scratch<gpu::vec4>("level_changes", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });
/// A spring's 3x3 block u u^T + a I in this substep: xyz u (kg^1/2), w a (kg).
inline constexpr Buffer spring_blocks = scratch<gpu::vec4>("spring_blocks", lengths::spring_places);
/// Two a particle: the inverse of the Cholesky factor of its diagonal block (kg^-1/2), xx yy zz, w mass (kg; 0: held); yx zx
/// zy, w unused.
inline constexpr Buffer inverses = scratch<gpu::vec4>("inverses", [](const Cooked& s) { return 2 * lengths::particles(s); });
/// Vectors that a particle's neighbours read in the solve (m/s). Conjugate gradients: the preconditioned residual; Jacobi:
/// the last three iterates.
inline constexpr Buffer exchanged = scratch<gpu::vec4>(
    "exchanged", [](const Cooked& s) { return (s.scene.solver.linear == Linear::jacobi ? 3 : 1) * lengths::particles(s); });
/// Vectors that only the particle itself reads: the residual r (kg m/s); with conjugate gradients also the solution dv (m/s),
/// the product A z (kg m/s), the search direction p (m/s) and its image A p (kg m/s).
inline constexpr Buffer solve_vectors = scratch<gpu::vec4>(
    "solve_vectors", [](const Cooked& s) { return (s.scene.solver.linear == Linear::jacobi ? 1 : 5) * lengths::particles(s); });
/// Partial sums of the dot products, one a workgroup (implicit.glsl).
inline constexpr Buffer partial_sums = scratch<gpu::vec4>("partial_sums", lengths::particles);
/// Scalars of the linear solve; `arrived` is 0 between dispatches.
inline constexpr Buffer linear =
    buffer<gpu::Linear>("linear", Lifetime::scratch, lengths::one, [](const Cooked&) { return made(std::vector<gpu::Linear>(1)); });
/// Free cloths, whose momentum the solve must not change, and the drift that it gave them (m/s).
inline constexpr Buffer free_cloths = buffer<gpu::FreeCloth>(
    "free_cloths", Lifetime::scratch, [](const Cooked& s) { return std::uint64_t(s.fabric.materials.size()); },
    [](const Cooked& s) {
      std::vector<gpu::FreeCloth> cloths(s.fabric.materials.size());
      for (std::size_t k = 0; k < s.fabric.cloths.size(); ++k)
        if (is_free(s.fabric, s.fabric.cloths[k])) cloths[k] = {s.fabric.cloths[k].first_particle, s.fabric.cloths[k].particles, {0, 0, 0}};
      return made(cloths);
    });
/// Two a particle: what colliders decide of a substep (implicit_collide.glsl).
inline constexpr Buffer collider_filters =
    scratch<gpu::vec4>("collider_filters", [](const Cooked& s) { return 2 * lengths::particles(s); });
}  // namespace buffers
}  // namespace weft
