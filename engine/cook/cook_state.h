// The state of cooking that effects share: the scene, the arrays as they grow, and the current cloth. Internal.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/cook/parts.h"

namespace weft::cooking {

struct ClothInput {
  const weft::Cloth& cloth;
  const Mesh& mesh;
  std::span<const AnchorChoice> anchors;
  const Factors& factors;
  const Mesh* render_mesh = nullptr;   // that the cloth carries
  std::size_t first_link = 0, first_bend = 0;   // of the cloth, in the fabric's lists
};

class CookState {
 public:
  explicit CookState(const Scene& scene);
  /// Of cloth that is cooked.
  CookState(const Scene& scene, const CookedFabric& fabric) : scene_(scene), fabric_(fabric) {}

  const Scene& scene() const { return scene_; }
  CookedFabric& fabric() { return fabric_; }
  /// Whether lists keep their lengths whoever is held: then they have places for those that are.
  bool may_pin() const { return scene_.pins > 0; }
  /// Of the current cloth: point -> particle.
  std::span<const std::uint32_t> particle_of() const { return particle_of_; }
  void set_particles(std::vector<std::uint32_t> particle_of) { particle_of_ = std::move(particle_of); }

  /// s / alpha = omega / h^2 (1/s^2), h being solve_step, for s in the step omega / (W + s) with which a single iteration corrects a constraint.
  /// Over-relaxation applies to the masses that Jacobi splits, W, and not to the cloth's compliance alpha: omega / (W + s) =
  /// 1 / (W / omega + alpha / h^2).
  double softening() const;

  template <class... Parts>
  void note(const weft::Cloth& cloth, const Parts&... parts) {
    fabric_.notes.push_back(fail(cloth.name, ": ", parts..., ".").message);
  }

  /// Whether the current cloth has coarse levels, which serve for far links, and what they leave of its stiffness.
  bool has_levels = false;
  double own_part = 1;
  /// Strands over particles, round by round, until they are laid out.
  struct StrandOfParticles {
    struct Link {
      std::uint32_t link, next;   // of the fabric; the particle that it leads to
    };
    std::uint32_t start;
    std::vector<Link> links;
  };
  std::array<std::vector<StrandOfParticles>, 2> strands;
  /// The tethers of each particle, until they are laid out.
  std::vector<std::vector<gpu::Tether>> tethers;

 private:
  const Scene& scene_;
  CookedFabric fabric_;
  std::vector<std::uint32_t> particle_of_;
};

}  // namespace weft::cooking
