#include "engine/reference/block_factor.h"

#include <Eigen/OrderingMethods>

namespace weft::reference {

BlockFactor::BlockFactor(std::uint32_t particles, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) : place_(particles) {
  std::vector<Eigen::Triplet<double>> graph;
  for (std::uint32_t i = 0; i < particles; ++i) graph.emplace_back(i, i, 1);
  for (const auto& [a, b] : pairs) {
    graph.emplace_back(a, b, 1);
    graph.emplace_back(b, a, 1);
  }
  Matrix neighbours(particles, particles);
  neighbours.setFromTriplets(graph.begin(), graph.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(neighbours, order);
  for (std::uint32_t k = 0; k < particles; ++k) place_[static_cast<std::size_t>(order.indices()[k])] = k;
  matrix_.resize(3 * static_cast<Eigen::Index>(particles), 3 * static_cast<Eigen::Index>(particles));
  for (std::uint32_t i = 0; i < particles; ++i) add(i, i, Eigen::Matrix3d::Zero());
  for (const auto& [a, b] : pairs) add(a, b, Eigen::Matrix3d::Zero());
  pattern_ = entries_.size();
}

void BlockFactor::clear() { entries_.resize(pattern_); }

void BlockFactor::add(std::uint32_t a, std::uint32_t b, const Eigen::Matrix3d& block) {
  const auto [column, row] = std::minmax(place_[a], place_[b]);
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t j = 0; j < (row == column ? i + 1 : 3); ++j) entries_.emplace_back(3 * row + i, 3 * column + j, block(i, j));
}

bool BlockFactor::factorise() {
  matrix_.setFromTriplets(entries_.begin(), entries_.end());
  if (!analysed_) factor_.analyzePattern(matrix_);
  analysed_ = true;
  factor_.factorize(matrix_);
  if (factor_.info() != Eigen::Success) return false;
  const auto& lower = factor_.matrixL().nestedExpression();
  const auto columns = static_cast<Eigen::Index>(place_.size());
  diagonal_.assign(place_.size(), Eigen::Matrix3d::Zero());
  first_.assign(1, 0);
  rows_.clear();
  blocks_.clear();
  for (Eigen::Index k = 0; k < columns; ++k) {
    // The three columns begin with the diagonal block's lower half, and then run through the same rows.
    for (int j = 0; j < 3; ++j) {
      std::size_t at = first_.back();
      for (Matrix::InnerIterator entry(lower, 3 * k + j); entry; ++entry) {
        if (entry.row() < 3 * (k + 1)) {
          diagonal_[static_cast<std::size_t>(k)](entry.row() - 3 * k, j) = entry.value();
          continue;
        }
        if (j == 0 && entry.row() % 3 == 0) {
          rows_.push_back(static_cast<std::uint32_t>(entry.row() / 3));
          blocks_.emplace_back(Eigen::Matrix3f::Zero());
        }
        blocks_[at](entry.row() % 3, j) = static_cast<float>(entry.value());
        at += entry.row() % 3 == 2;
      }
    }
    first_.push_back(static_cast<std::uint32_t>(rows_.size()));
    Eigen::Matrix3d& diagonal = diagonal_[static_cast<std::size_t>(k)];
    diagonal = Eigen::Matrix3d(diagonal.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity()));
  }
  return true;
}

Eigen::Matrix3Xd BlockFactor::solve(const Eigen::Matrix3Xd& r) const {
  Eigen::Matrix3Xd x(3, r.cols());
  for (std::size_t i = 0; i < place_.size(); ++i) x.col(place_[i]) = r.col(static_cast<Eigen::Index>(i));
  const auto columns = static_cast<Eigen::Index>(place_.size());
  for (Eigen::Index k = 0; k < columns; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Eigen::Vector3d solved = diagonal_[at] * x.col(k);
    x.col(k) = solved;
    for (std::uint32_t e = first_[at]; e < first_[at + 1]; ++e) x.col(rows_[e]).noalias() -= blocks_[e].cast<double>() * solved;
  }
  for (Eigen::Index k = columns - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    Eigen::Vector3d sum = x.col(k);
    for (std::uint32_t e = first_[at]; e < first_[at + 1]; ++e) sum.noalias() -= blocks_[e].cast<double>().transpose() * x.col(rows_[e]);
    x.col(k).noalias() = diagonal_[at].transpose() * sum;
  }
  Eigen::Matrix3Xd solved(3, r.cols());
  for (std::size_t i = 0; i < place_.size(); ++i) solved.col(static_cast<Eigen::Index>(i)) = x.col(place_[i]);
  return solved;
}

}  // namespace weft::reference
