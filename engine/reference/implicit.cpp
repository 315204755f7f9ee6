#include "engine/reference/implicit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>

namespace weft::reference {
namespace {

Vector vector(Vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

Result<ImplicitSystem> ImplicitSystem::create(const Scene& scene, const CookedFabric& fabric) {
  if (scene.solver.method != Method::implicit) return fail("solver.method: the implicit system solves \"implicit\" alone");
  ImplicitSystem system;
  system.settings_ = scene.solver;
  system.gravity_ = vector(scene.gravity);
  system.h_ = fabric.h;
  system.springs_ = fabric.springs;
  system.cloths_ = fabric.cloths;
  const auto particles = static_cast<Eigen::Index>(fabric.positions.size());
  system.positions.resize(3, particles);
  system.velocities.resize(3, particles);
  system.inverse_masses_.resize(particles);
  system.keep_.resize(particles);
  system.thickness_.resize(particles);
  for (Eigen::Index i = 0; i < particles; ++i) {
    const gpu::vec4& x = fabric.positions[static_cast<std::size_t>(i)];
    const gpu::vec4& v = fabric.velocities[static_cast<std::size_t>(i)];
    const gpu::Material& material = fabric.materials[std::bit_cast<std::uint32_t>(v.w)];
    system.positions.col(i) = Vector(x.x, x.y, x.z);
    system.velocities.col(i) = Vector(v.x, v.y, v.z);
    system.inverse_masses_[i] = x.w;
    system.keep_[i] = material.damping_factor;
    system.thickness_[i] = material.thickness;
  }
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& collider = scene.colliders[k];
    if (collider.shape != ColliderShape::plane || !collider.keys.empty())
      return fail("colliders[", k, "]: the implicit system on the CPU meets planes that stand still, and no other colliders");
    system.planes_.push_back({vector(collider.normal).normalized(), vector(collider.centre)});
  }
  system.jacobi_weight = fabric.jacobi_weight;
  system.levels_ = ImplicitLevels::create(fabric);
  return system;
}

ImplicitEquations ImplicitSystem::assemble(std::span<const ImplicitTarget> targets) const {
  const Eigen::Index particles = positions.cols();
  ImplicitEquations equations;
  equations.masses = Eigen::VectorXd::Zero(particles);
  equations.filter.assign(static_cast<std::size_t>(particles), Matrix::Zero());
  equations.diagonal = equations.filter;
  equations.flight = Columns::Zero(3, particles);
  for (Eigen::Index i = 0; i < particles; ++i) {
    if (inverse_masses_[i] == 0) continue;
    equations.masses[i] = 1 / inverse_masses_[i];
    equations.filter[i].setIdentity();
    equations.diagonal[i] = equations.masses[i] * Matrix::Identity();
    equations.flight.col(i) = keep_[i] * (velocities.col(i) + h_ * gravity_);
  }
  for (const ImplicitTarget& target : targets)
    equations.flight.col(target.particle) = (target.position - positions.col(target.particle)) / h_;

  Columns impulse = Columns::Zero(3, particles);   // h f - h^2 K v*
  equations.couplings.reserve(springs_.size());
  for (const ParticleSpring& s : springs_) {
    const Vector u = equations.flight.col(s.a) - equations.flight.col(s.b);
    const SpringTerms terms = spring_terms({s.rest, s.stiffness, s.damping, s.only_pulls}, positions.col(s.a) - positions.col(s.b), u);
    const Matrix block = h_ * h_ * terms.stiffness + h_ * terms.damping;
    const Vector pushed = h_ * terms.force - h_ * h_ * terms.stiffness * u;
    impulse.col(s.a) += pushed;
    impulse.col(s.b) -= pushed;
    equations.diagonal[s.a] += block;
    equations.diagonal[s.b] += block;
    equations.couplings.push_back({s.a, s.b, block});
  }
  if (!planes_.empty()) meet_planes(equations, impulse);
  for (const ClothRange& cloth : cloths_) {
    const auto* first = equations.filter.data() + cloth.first_particle;
    if (std::all_of(first, first + cloth.particles, [](const Matrix& m) { return m.isIdentity(0); })) equations.free.push_back(cloth);
  }
  // Prescribed directions are decoupled, so that the inverse maps free directions to free directions, and the bounds in
  // implicit.h hold.
  equations.inverse.assign(equations.diagonal.size(), Matrix::Zero());
  ImplicitLevels::Blocks blocks{equations.inverse, equations.inverse};   // of particles
  for (std::size_t i = 0; i < equations.diagonal.size(); ++i)
    if (const double mass = equations.masses[static_cast<Eigen::Index>(i)]; mass > 0) {
      const Matrix& s = equations.filter[i];
      const Matrix whole = s * equations.diagonal[i] * s + mass * (Matrix::Identity() - s);
      equations.inverse[i] = whole.inverse();
      blocks.springs[i] = whole - mass * Matrix::Identity();
      blocks.held[i] = (equations.diagonal[i].trace() / mass - 3) * (Matrix::Identity() - s);
    }
  equations.levels = levels_;
  if (levels_) equations.level_blocks = levels_->means_of(blocks);
  equations.right = equations.filtered(std::move(impulse));
  equations.guess = equations.filtered(velocities - equations.flight);
  return equations;
}

// A particle that would end below a plane is put onto it: its free flight gets the speed across the plane that leads there,
// and the filter takes that direction out of its residual. Not where the springs would pull it off, with its neighbours in
// free flight.
void ImplicitSystem::meet_planes(ImplicitEquations& equations, Columns& impulse) const {
  const Columns free = equations.flight;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    if (inverse_masses_[i] == 0) continue;
    const Vector pushed = equations.diagonal[i].ldlt().solve(impulse.col(i));
    for (const Plane& plane : planes_) {
      const double height = plane.normal.dot(positions.col(i) - plane.point) - thickness_[i];
      const double change = -height / h_ - plane.normal.dot(equations.flight.col(i));
      if (change <= 0 || change <= plane.normal.dot(pushed)) continue;
      // In a corner only along the directions that the planes before have left free.
      const Vector left = equations.filter[i] * plane.normal;
      if (left.squaredNorm() < 1e-6) continue;
      equations.flight.col(i) += change / left.squaredNorm() * left;
      equations.filter[i] -= left * left.transpose() / left.squaredNorm();
    }
  }
  // The springs' impulses follow the changed flight.
  const Columns changed = equations.flight - free;
  for (const ImplicitEquations::Coupling& c : equations.couplings) {
    const Vector pushed = c.block * (changed.col(c.a) - changed.col(c.b));
    impulse.col(c.a) -= pushed;
    impulse.col(c.b) += pushed;
  }
}

ImplicitSolution ImplicitSystem::solve(const ImplicitEquations& equations) const {
  ImplicitSolution solution = settings_.linear == Linear::cg ? solve_conjugate_gradients(equations, settings_.iterations)
                                                             : solve_jacobi(equations, settings_.iterations, jacobi_weight);
  equations.keep_momentum(solution.change);
  return solution;
}

void ImplicitSystem::move(const ImplicitEquations& equations, const ImplicitSolution& solution, std::span<const ImplicitTarget> targets) {
  velocities = equations.flight + solution.change;
  positions += h_ * velocities;
  // An unfinished solve may leave below a plane a particle that the springs should have pulled off.
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    for (const Plane& plane : planes_) {
      const double depth = thickness_[i] - plane.normal.dot(positions.col(i) - plane.point);
      if (depth <= 0 || inverse_masses_[i] == 0) continue;
      positions.col(i) += depth * plane.normal;
      velocities.col(i) += depth / h_ * plane.normal;
    }
  for (const ImplicitTarget& target : targets) positions.col(target.particle) = target.position;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    if (inverse_masses_[i] == 0) velocities.col(i).setZero();
  ++report_.steps;
  report_.residual = solution.residual;
  report_.not_converged += solution.residual > kConverged;
  report_.stopped += solution.stopped;
}

void ImplicitSystem::step(std::span<const ImplicitTarget> targets) {
  const ImplicitEquations equations = assemble(targets);
  move(equations, solve(equations), targets);
}

}  // namespace weft::reference
