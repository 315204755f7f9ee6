#include "engine/reference/time_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weft::reference {
namespace {

// A sum counts as zero when it is below the rounding of its terms, of a few operations each.
constexpr double kRounded = 4 * std::numeric_limits<double>::epsilon();

// Ends closer than this (m) have no direction; the engine leaves such a link out too.
constexpr double kCoincident = 1e-10;

// A Newton step need not solve its system better than the next one can use.
constexpr double kForcing = 1e-3;

// The factor is renewed after a linear solve with more iterations than this. A new factor costs as much as a few dozen iterations.
constexpr std::uint32_t kMostWithOldFactor = 40;
constexpr std::uint32_t kMostGradients = 1000;

// Pairs of particles that have a block in the factor.
std::vector<std::pair<std::uint32_t, std::uint32_t>> factored_pairs(const Energies& energies) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const LinkEnergy& link : energies.links)
    if (link.part == Preconditioned::whole) pairs.emplace_back(link.a, link.b);
  for (const BendEnergy& bend : energies.bends)
    for (int i = 1; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        if (bend.part == Preconditioned::whole && bend.particle[i] != bend.particle[j])
          pairs.emplace_back(bend.particle[i], bend.particle[j]);
  return pairs;
}

}  // namespace

TimeStep::TimeStep(Energies energies)
    : energies_(std::move(energies)),
      masses_(energies_.inverse_masses.size()),
      factor_(static_cast<std::uint32_t>(masses_.size()), factored_pairs(energies_)) {
  for (Eigen::Index i = 0; i < masses_.size(); ++i) masses_[i] = energies_.inverse_masses[i] > 0 ? 1 / energies_.inverse_masses[i] : 1;
  now_.u = Positions::Zero(3, masses_.size());
  now_.lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(energies_.links.size()));
  before_ = now_;
}

void TimeStep::begin(const Positions& free_motion) {
  y_ = free_motion;
  State same = now_, further{2 * now_.u - before_.u, 2 * now_.lambda - before_.lambda};
  before_ = std::move(now_);
  // The guess with the lower potential: with long steps extrapolation overshoots, and a link that it turned over would stay so.
  now_ = evaluate(further).potential < evaluate(same).potential ? std::move(further) : std::move(same);
}

// l of a bending stencil, and the size of its terms. Summed from differences, so that it is the same wherever the cloth is.
TimeStep::Curl TimeStep::curl(const BendEnergy& bend, const Positions& u) const {
  Curl curl{Eigen::Vector3d::Zero(), 0};
  const std::uint32_t first = bend.particle[0];
  for (int j = 1; j < 4; ++j) {
    const Eigen::Vector3d d = (y_.col(bend.particle[j]) - y_.col(first)) + (u.col(bend.particle[j]) - u.col(first));
    curl.l += bend.k[j] * d;
    curl.terms += std::abs(bend.k[j]) * d.norm();
  }
  return curl;
}

// The residual of a state. Sets the multipliers of slack links to 0.
TimeStep::Residual TimeStep::evaluate(State& state) const {
  Residual residual;
  residual.frames.reserve(energies_.links.size());
  residual.force = state.u * masses_.asDiagonal();
  residual.potential = 0.5 * residual.force.cwiseProduct(state.u).sum();
  Eigen::VectorXd terms = Eigen::VectorXd::Zero(masses_.size());   // kg m, the size of a particle's force terms
  double asked = 0;                                                // m, the largest correction that a link asks for
  for (std::size_t e = 0; e < energies_.links.size(); ++e) {
    const LinkEnergy& link = energies_.links[e];
    double& lambda = state.lambda[static_cast<Eigen::Index>(e)];
    // y does not change during a step, so its rounding does not either.
    const Eigen::Vector3d d = (y_.col(link.a) - y_.col(link.b)) + (state.u.col(link.a) - state.u.col(link.b));
    const double length = d.norm(), c = length - link.rest;
    const double value = c + link.softness * lambda;
    const bool pulls = !link.only_pulls || lambda - value / (link.weight + link.softness) < 0;
    const bool active = pulls && length > kCoincident;
    if (!active) lambda = 0;
    const Eigen::Vector3d normal = active ? Eigen::Vector3d(d / length) : Eigen::Vector3d::Zero();
    residual.frames.push_back({normal, length, active ? value : 0, active});
    residual.force.col(link.a) -= lambda * normal;
    residual.force.col(link.b) += lambda * normal;
    terms[link.a] += std::abs(lambda);
    terms[link.b] += std::abs(lambda);
    if (active && !(link.only_pulls && c < 0)) residual.potential += c * c / (2 * link.softness);
    if (active && std::abs(value) > kRounded * link.rest)
      asked = std::max(asked, std::abs(value) * link.weight / (link.weight + link.softness));
    else
      residual.frames.back().value = 0;
  }
  for (const BendEnergy& bend : energies_.bends) {
    const auto [l, size] = curl(bend, state.u);
    residual.potential += 0.5 * bend.stiffness * l.squaredNorm();
    for (int j = 0; j < 4; ++j) {
      residual.force.col(bend.particle[j]) += bend.stiffness * bend.k[j] * l;
      terms[bend.particle[j]] += bend.stiffness * std::abs(bend.k[j]) * size;
    }
  }
  residual.size = asked;
  for (Eigen::Index i = 0; i < masses_.size(); ++i) {
    if (energies_.inverse_masses[i] == 0) residual.force.col(i).setZero();
    const double force = residual.force.col(i).norm();
    if (force > kRounded * terms[i]) residual.size = std::max(residual.size, force / masses_[i]);
  }
  return residual;
}

// The matrix of a Newton step times p. `projected` leaves out the negative part, which links under compression have.
Positions TimeStep::apply(const Residual& at, const Eigen::VectorXd& lambda, const Positions& p, bool projected) const {
  Positions result = p * masses_.asDiagonal();
  for (std::size_t e = 0; e < energies_.links.size(); ++e) {
    const LinkFrame& frame = at.frames[e];
    if (!frame.active) continue;
    const LinkEnergy& link = energies_.links[e];
    const double pull = -lambda[static_cast<Eigen::Index>(e)] / frame.length;   // of the geometric part, kg
    const double across = projected ? std::max(pull, 0.0) : pull;
    const Eigen::Vector3d d = p.col(link.a) - p.col(link.b);
    const Eigen::Vector3d product = ((1 / link.softness - across) * frame.normal.dot(d)) * frame.normal + across * d;
    result.col(link.a) += product;
    result.col(link.b) -= product;
  }
  for (const BendEnergy& bend : energies_.bends) {
    const auto [p0, p1, p2, p3] = bend.particle;
    const Eigen::Vector3d l =
        bend.k[1] * (p.col(p1) - p.col(p0)) + bend.k[2] * (p.col(p2) - p.col(p0)) + bend.k[3] * (p.col(p3) - p.col(p0));
    for (int j = 0; j < 4; ++j) result.col(bend.particle[j]) += bend.stiffness * bend.k[j] * l;
  }
  for (Eigen::Index i = 0; i < masses_.size(); ++i)
    if (energies_.inverse_masses[i] == 0) result.col(i) = p.col(i);
  return result;
}

// Factorises the preconditioner: the projected matrix without the parts that `Preconditioned` leaves out.
void TimeStep::factorise(const Residual& at, const Eigen::VectorXd& lambda) {
  const auto held = [&](std::uint32_t i) { return energies_.inverse_masses[i] == 0; };
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  factor_.clear();
  for (Eigen::Index i = 0; i < masses_.size(); ++i)
    factor_.add(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i), masses_[i] * identity);
  for (std::size_t e = 0; e < energies_.links.size(); ++e) {
    const LinkEnergy& link = energies_.links[e];
    const LinkFrame& frame = at.frames[e];
    if (!frame.active || link.part == Preconditioned::left_out) continue;
    const double across = std::max(-lambda[static_cast<Eigen::Index>(e)] / frame.length, 0.0);
    const Eigen::Matrix3d block = (1 / link.softness - across) * frame.normal * frame.normal.transpose() + across * identity;
    for (const std::uint32_t end : {link.a, link.b})
      if (!held(end)) factor_.add(end, end, block);
    if (link.part == Preconditioned::whole && !held(link.a) && !held(link.b)) factor_.add(link.a, link.b, -block);
  }
  for (const BendEnergy& bend : energies_.bends)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j)
        if (const std::uint32_t a = bend.particle[i], b = bend.particle[j];
            !held(a) && !held(b) && (a == b || bend.part == Preconditioned::whole))
          factor_.add(a, b, (a == b && i != j ? 2 : 1) * bend.stiffness * bend.k[i] * bend.k[j] * identity);
  factorised_ = factor_.factorise();
}

bool TimeStep::solve_linear(const Residual& at, const Eigen::VectorXd& lambda, const Positions& rhs, bool projected, double enough,
                            Positions& du) {
  const auto dot = [](const Positions& a, const Positions& b) { return a.cwiseProduct(b).sum(); };
  const auto size = [&](const Positions& r) { return (r.colwise().norm().transpose().array() / masses_.array()).maxCoeff(); };
  du = Positions::Zero(3, rhs.cols());
  Positions r = rhs, z = factor_.solve(r), p = z;
  double rho = dot(r, z);
  for (gradients_ = 0; gradients_ < kMostGradients && size(r) > enough; ++gradients_) {
    const Positions q = apply(at, lambda, p, projected);
    const double curvature = dot(p, q);
    if (!(curvature > 0)) return false;
    const double step = rho / curvature;
    du += step * p;
    r -= step * q;
    z = factor_.solve(r);
    const double next = dot(r, z);
    p = z + (next / rho) * p;
    rho = next;
  }
  return true;
}

bool TimeStep::solve(double tolerance, double scale, std::uint32_t most_steps) {
  Residual at = evaluate(now_);
  for (std::uint32_t step = 0;; ++step) {
    const double target = tolerance * std::max(scale, now_.u.colwise().norm().maxCoeff());
    if (at.size <= target) return true;
    if (step == most_steps || !std::isfinite(at.size)) return false;
    ++newton_steps_;
    if (!factorised_ || gradients_ > kMostWithOldFactor) factorise(at, now_.lambda);
    if (!factorised_) return false;

    Positions rhs = -at.force;
    for (std::size_t e = 0; e < energies_.links.size(); ++e) {
      const LinkEnergy& link = energies_.links[e];
      const Eigen::Vector3d pull = at.frames[e].value / link.softness * at.frames[e].normal;
      rhs.col(link.a) -= pull;
      rhs.col(link.b) += pull;
    }
    for (Eigen::Index i = 0; i < masses_.size(); ++i)
      if (energies_.inverse_masses[i] == 0) rhs.col(i).setZero();
    Positions du;
    const double enough = std::max(kForcing * at.size, 0.1 * target);
    if (!solve_linear(at, now_.lambda, rhs, false, enough, du)) solve_linear(at, now_.lambda, rhs, true, enough, du);
    Eigen::VectorXd dlambda = Eigen::VectorXd::Zero(now_.lambda.size());
    for (std::size_t e = 0; e < energies_.links.size(); ++e) {
      const LinkEnergy& link = energies_.links[e];
      const LinkFrame& frame = at.frames[e];
      if (frame.active)
        dlambda[static_cast<Eigen::Index>(e)] = -(frame.value + frame.normal.dot(du.col(link.a) - du.col(link.b))) / link.softness;
    }

    // Step halving. A whole step can raise the potential of a stiff link, by its curvature, though it is nearer to the solution
    // (Maratos effect), so a decrease of either measure is enough.
    double length = 1;
    for (int halvings = 0;; ++halvings, length *= 0.5) {
      State next{now_.u + length * du, now_.lambda + length * dlambda};
      Residual there = evaluate(next);
      if (there.size < at.size || there.potential < at.potential) {
        now_ = std::move(next);
        at = std::move(there);
        break;
      }
      if (halvings == 20) return false;
    }
  }
}

}  // namespace weft::reference
