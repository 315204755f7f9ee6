#include "engine/reference/errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace weft::reference {
namespace {

Eigen::Vector3d widened(Vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

double sheet_size(const CookedFabric& fabric) {
  const Positions pose = pose_of(fabric, fabric.positions);
  return (pose.rowwise().maxCoeff() - pose.rowwise().minCoeff()).maxCoeff();
}

Positions pose_of(const CookedFabric& fabric, std::span<const gpu::vec4> positions) {
  Positions pose(3, static_cast<Eigen::Index>(cloth_particles(fabric)));
  for (Eigen::Index i = 0; i < pose.cols(); ++i) {
    const gpu::vec4& p = positions[static_cast<std::size_t>(i)];
    pose.col(i) << p.x, p.y, p.z;
  }
  return pose;
}

double pose_error(const Positions& pose, const Positions& reference, double size) {
  assert(pose.cols() == reference.cols());
  return std::sqrt((pose - reference).squaredNorm() / static_cast<double>(pose.cols())) / size;
}

double run_error(const Trajectory& run, const Trajectory& reference, double size) {
  const std::size_t frames = std::min(run.poses.size(), reference.poses.size());
  double squares = 0;
  for (std::size_t k = 0; k < frames; ++k) squares += std::pow(pose_error(run.poses[k], reference.poses[k], size), 2);
  return frames == 0 ? 0 : std::sqrt(squares / static_cast<double>(frames));
}

Errors errors_of(const Trajectory& run, const Trajectory& same_step, const Trajectory& fine_step, double size) {
  return {run_error(run, same_step, size), run_error(same_step, fine_step, size)};
}

Strain measure_strain(const CookedFabric& fabric, const Positions& pose) {
  Strain strain;
  double count = 0;
  for (const StretchLink& link : fabric.links) {
    if (link.only_pulls) continue;
    const double s = std::abs((pose.col(link.a) - pose.col(link.b)).norm() / link.rest - 1);
    strain.mean += s;
    strain.rms += s * s;
    strain.max = std::max(strain.max, s);
    ++count;
  }
  if (count == 0) return {};
  strain.mean /= count;
  strain.rms = std::sqrt(strain.rms / count);
  return strain;
}

Balance balance_of(const CookedFabric& fabric, const Positions& before, const Positions& after, double seconds, Vec3 gravity) {
  Balance balance{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (Eigen::Index i = 0; i < after.cols(); ++i) {
    const float inverse_mass = fabric.positions[static_cast<std::size_t>(i)].w;
    if (inverse_mass == 0) continue;
    const double mass = 1.0 / inverse_mass;
    const Eigen::Vector3d velocity = (after.col(i) - before.col(i)) / seconds;
    balance.momentum += mass * velocity;
    balance.angular_momentum += mass * Eigen::Vector3d(after.col(i)).cross(velocity);
    balance.kinetic += mass / 2 * velocity.squaredNorm();
    balance.height -= mass * widened(gravity).dot(after.col(i));
  }
  for (const StretchLink& link : fabric.links) {
    const double c = (after.col(link.a) - after.col(link.b)).norm() - link.rest;
    if (link.compliance > 0 && !(link.only_pulls && c < 0)) balance.elastic += c * c / (2 * link.compliance);
  }
  for (const gpu::Bend& bend : fabric.bends) {
    Eigen::Vector3d l = Eigen::Vector3d::Zero();
    for (int j = 1; j < 4; ++j) l += bend.k[j] * (after.col(bend.particle[j]) - after.col(bend.particle[0]));
    if (bend.compliance > 0) balance.bending += l.squaredNorm() / (2 * bend.compliance);
  }
  return balance;
}

}  // namespace weft::reference
