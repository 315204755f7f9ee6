#include "engine/reference/vbd.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/reference/energies.h"

namespace weft::reference {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

// A link is rigid that resists its particles this many times more than their masses do.
constexpr double kRigid = 1e4;

class Descent {
 public:
  Descent(Energies energies, const VbdSettings& settings)
      : energies_(std::move(energies)), settings_(settings), links_(energies_.links.size()) {
    const auto particles = static_cast<std::size_t>(energies_.inverse_masses.size());
    link_uses_.resize(particles);
    bend_uses_.resize(particles);
    for (std::uint32_t k = 0; k < energies_.links.size(); ++k) {
      const LinkEnergy& link = energies_.links[k];
      link_uses_[link.a].push_back({k, link.b});
      link_uses_[link.b].push_back({k, link.a});
      links_[k].augmented = settings.augmented && link.weight > kRigid * link.softness;
      links_[k].stiffness = links_[k].augmented ? least(link) : 1 / link.softness;
    }
    for (std::uint32_t k = 0; k < energies_.bends.size(); ++k)
      for (std::uint32_t j = 0; j < 4; ++j) bend_uses_[energies_.bends[k].particle[j]].push_back({k, j});
    colour();
  }

  std::uint32_t colours() const { return static_cast<std::uint32_t>(colours_.size()); }

  // From `x`, where the step began, with the free motion `y` and a guess in `p`: the step's end in `p`.
  void step(const Positions& x, const Positions& y, Positions& p) {
    for (std::size_t k = 0; k < links_.size(); ++k) {
      Link& link = links_[k];
      if (!link.augmented) continue;
      const LinkEnergy& energy = energies_.links[k];
      link.kept = settings_.kept * ((x.col(energy.a) - x.col(energy.b)).norm() - energy.rest);
      link.lambda *= settings_.kept * settings_.lessened;
      link.stiffness = std::max(settings_.lessened * link.stiffness, least(energy));
    }
    for (std::uint32_t sweep = 0; sweep < settings_.sweeps; ++sweep) {
      for (const auto& colour : colours_)
        for (const std::uint32_t i : colour) p.col(i) += change(i, y, p);
      for (std::size_t k = 0; k < links_.size(); ++k)
        if (links_[k].augmented) renew(links_[k], energies_.links[k], p);
    }
  }

 private:
  struct Use {
    std::uint32_t energy, other;   // of a link: its other end; of a bend: the particle's place in the stencil
  };
  struct Link {
    bool augmented = false;
    double stiffness = 0, lambda = 0, kept = 0;   // kg, kg m, m
  };

  double least(const LinkEnergy& link) const { return settings_.start / link.weight; }

  // Greedy colouring, in the order of the particles.
  void colour() {
    constexpr std::uint32_t kNoColour = UINT32_MAX;
    std::vector<std::uint32_t> colour_of(link_uses_.size(), kNoColour);
    for (std::uint32_t i = 0; i < colour_of.size(); ++i) {
      if (energies_.inverse_masses[i] == 0) continue;
      std::vector<bool> taken(colours_.size() + 1);
      const auto take = [&](std::uint32_t other) {
        if (colour_of[other] != kNoColour) taken[colour_of[other]] = true;
      };
      for (const Use& use : link_uses_[i]) take(use.other);
      for (const Use& use : bend_uses_[i])
        for (const std::uint32_t other : energies_.bends[use.energy].particle) take(other);
      colour_of[i] = static_cast<std::uint32_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
      if (colour_of[i] == colours_.size()) colours_.emplace_back();
      colours_[colour_of[i]].push_back(i);
    }
  }

  // Newton's step in one particle. The negative part of a link's Hessian, under compression, is left out.
  Vector change(std::uint32_t i, const Positions& y, const Positions& p) const {
    const double mass = 1 / energies_.inverse_masses[i];
    Vector force = mass * (y.col(i) - p.col(i));
    Matrix hessian = mass * Matrix::Identity();
    for (const Use& use : link_uses_[i]) {
      const LinkEnergy& energy = energies_.links[use.energy];
      const Link& link = links_[use.energy];
      const Vector d = p.col(i) - p.col(use.other);
      const double length = d.norm();
      const double pull = link.stiffness * (length - energy.rest - link.kept) + link.lambda;
      if (!(length > 1e-10) || (energy.only_pulls && pull <= 0)) continue;
      const Vector n = d / length;
      const double across = std::max(pull / length, 0.0);
      force -= pull * n;
      hessian += across * Matrix::Identity() + (link.stiffness - across) * n * n.transpose();
    }
    for (const Use& use : bend_uses_[i]) {
      const BendEnergy& bend = energies_.bends[use.energy];
      Vector l = Vector::Zero();
      for (int j = 1; j < 4; ++j) l += bend.k[j] * (p.col(bend.particle[j]) - p.col(bend.particle[0]));
      const double k = bend.k[use.other];
      force -= bend.stiffness * k * l;
      hessian += bend.stiffness * k * k * Matrix::Identity();
    }
    return hessian.llt().solve(force);
  }

  void renew(Link& link, const LinkEnergy& energy, const Positions& p) const {
    const double c = (p.col(energy.a) - p.col(energy.b)).norm() - energy.rest - link.kept;
    link.lambda += link.stiffness * c;
    if (energy.only_pulls && link.lambda < 0) link.lambda = 0;   // slack: nothing to stiffen against
    else link.stiffness = std::min(link.stiffness + settings_.growth * std::abs(c) / (energy.rest * energy.weight), 1 / energy.softness);
  }

  Energies energies_;
  VbdSettings settings_;
  std::vector<Link> links_;
  std::vector<std::vector<Use>> link_uses_, bend_uses_;
  std::vector<std::vector<std::uint32_t>> colours_;
};

}  // namespace

Result<VbdRun> integrate_vbd(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, const VbdSettings& settings) {
  if (!scene.colliders.empty())
    return fail("colliders[0]: vertex block descent has no colliders here; it was given ", scene.colliders.size());
  if (!fabric.hinges.empty())
    return fail("bend_rest: vertex block descent bends cloth about a flat shape; the scene has ", fabric.hinges.size(),
                " hinges about its mesh's");
  if (contacts_on(scene)) return fail("contacts: vertex block descent has none here");
  for (std::size_t c = 0; c < scene.cloths.size(); ++c)
    for (std::size_t a = 0; a < scene.cloths[c].anchors.size(); ++a)
      if (!scene.cloths[c].anchors[a].keys.empty())
        return fail("cloths[", c, "].anchors[", a, "].keys: vertex block descent has no anchors that move here");

  const auto particles = static_cast<Eigen::Index>(fabric.positions.size());
  const double h = fabric.h;
  const auto steps = static_cast<std::uint32_t>(std::lround(1 / (scene.solver.rate * h)));
  const Vector gravity(scene.gravity.x, scene.gravity.y, scene.gravity.z);
  Descent descent(energies_of(fabric, h), settings);
  Eigen::VectorXd damping(particles), moves(particles);
  for (const ClothRange& cloth : fabric.cloths)
    damping.segment(cloth.first_particle, cloth.particles)
        .setConstant(std::exp(-scene.cloths[static_cast<std::size_t>(&cloth - fabric.cloths.data())].fabric.damping * h));
  Positions x(3, particles), v = Positions::Zero(3, particles), before = v;
  for (Eigen::Index i = 0; i < particles; ++i) {
    const gpu::vec4& p = fabric.positions[static_cast<std::size_t>(i)];
    x.col(i) << p.x, p.y, p.z;
    moves[i] = p.w > 0;
  }

  VbdRun run;
  run.colours = descent.colours();
  run.trajectory.frame_seconds = 1 / scene.solver.rate;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::uint32_t step = 0; step < steps; ++step) {
      const Positions y = x + h * (v.colwise() + h * gravity) * damping.cwiseProduct(moves).asDiagonal();
      // The share of gravity that was felt in the step before, 0 at rest and 1 in free fall.
      const Eigen::VectorXd felt =
          ((v - before).transpose() * gravity / (h * std::max(gravity.squaredNorm(), 1e-20))).cwiseMax(0).cwiseMin(1);
      Positions p = x + h * (v + h * gravity * felt.transpose()) * damping.cwiseProduct(moves).asDiagonal();
      descent.step(x, y, p);
      before = v;
      v = (p - x) / h;
      x = p;
      if (!x.allFinite()) return fail("vertex block descent turned non-finite in frame ", frame, ", step ", step);
    }
    run.trajectory.poses.push_back(x);
  }
  return run;
}

}  // namespace weft::reference
