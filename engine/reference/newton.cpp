// The reference solver: time steps of implicit Euler, each solved to its end (time_step.h). Gravity and drag act before a
// step as they do in the engine, v <- exp(-c h) (v + h g), so that both take the same steps and only their solvers differ.
#include <cmath>

#include "engine/effects/effect.h"
#include "engine/reference/time_step.h"

namespace weft::reference {
namespace {

Result<std::uint32_t> steps_a_frame(const Scene& scene, double h) {
  const double steps = 1 / (scene.solver.rate * h);
  if (!(h > 0) || !(steps > 0.5) || !(steps < 1e9) || std::abs(steps - std::round(steps)) > 1e-6 * steps)
    return fail("a step of ", h, " s does not divide a frame of ", 1 / scene.solver.rate, " s into whole steps");
  return static_cast<std::uint32_t>(std::lround(steps));
}

Positions anchor_places(const Scene& scene, const CookedFabric& fabric, double time) {
  const std::vector<Vec3> targets = anchor_targets(scene, fabric, time);
  Positions places(3, static_cast<Eigen::Index>(targets.size()));
  for (std::size_t k = 0; k < targets.size(); ++k) places.col(static_cast<Eigen::Index>(k)) << targets[k].x, targets[k].y, targets[k].z;
  return places;
}

}  // namespace

Result<Trajectory> integrate_newton(const Scene& scene, const CookedFabric& fabric, std::uint32_t frames, const NewtonSettings& settings,
                                    const Progress& progress) {
  if (const std::string fault = reference_fault(scene, fabric); !fault.empty()) return fail(fault);
  const auto steps = steps_a_frame(scene, settings.h);
  if (!steps) return fail(steps.why());

  const auto particles = static_cast<Eigen::Index>(fabric.positions.size());
  const double h = settings.h;
  const Eigen::Vector3d gravity(scene.gravity.x, scene.gravity.y, scene.gravity.z);
  TimeStep problem(energies_of(fabric, h));
  Positions x(3, particles), v = Positions::Zero(3, particles);
  Eigen::VectorXd damping(particles);
  for (const ClothRange& cloth : fabric.cloths)
    damping.segment(cloth.first_particle, cloth.particles)
        .setConstant(std::exp(-scene.cloths[static_cast<std::size_t>(&cloth - fabric.cloths.data())].fabric.damping * h));
  for (Eigen::Index i = 0; i < particles; ++i) {
    const gpu::vec4& p = fabric.positions[static_cast<std::size_t>(i)];
    x.col(i) << p.x, p.y, p.z;
  }
  Positions from(3, static_cast<Eigen::Index>(fabric.anchors.size()));
  for (std::size_t k = 0; k < fabric.anchors.size(); ++k) from.col(static_cast<Eigen::Index>(k)) = x.col(fabric.anchors[k].particle);

  Trajectory trajectory;
  trajectory.frame_seconds = 1 / scene.solver.rate;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const Positions to = anchor_places(scene, fabric, (frame + 1) / scene.solver.rate);
    for (std::uint32_t step = 0; step < *steps; ++step) {
      v = (v.colwise() + h * gravity) * damping.asDiagonal();
      Positions y = x + h * v;
      const double fraction = static_cast<double>(step + 1) / *steps;
      for (Eigen::Index k = 0; k < from.cols(); ++k)
        y.col(fabric.anchors[static_cast<std::size_t>(k)].particle) = from.col(k) + fraction * (to.col(k) - from.col(k));
      problem.begin(y);
      trajectory.not_converged += !problem.solve(settings.tolerance, h * h * gravity.norm(), settings.most_steps);
      const Positions& u = problem.displacement();
      x = y + u;
      // Not (x' - x) / h, whose rounding would enter the velocity.
      v += u / h;
      for (const AnchorTarget& anchor : fabric.anchors) v.col(anchor.particle).setZero();
      if (!x.allFinite()) return fail("the reference turned non-finite in frame ", frame, ", step ", step);
      if (progress && !progress((frame + fraction) / frames)) return fail("the reference was stopped in frame ", frame, " of ", frames);
    }
    trajectory.poses.push_back(x);
    from = to;
  }
  trajectory.newton_steps = problem.newton_steps();
  return trajectory;
}

}  // namespace weft::reference
