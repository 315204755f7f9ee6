// A sparse Cholesky factor of a symmetric matrix of 3 x 3 blocks, one row and one column of blocks a particle.
//
// Eigen orders (minimum degree, over particles), analyses and factorises. Solving is done here: all three columns of a particle
// have the same rows below, so a block is nine numbers and one index, where Eigen's own solver has nine of each and takes several
// times as long. The reference solves some twenty times a time step and factorises seldom.
//
// Blocks below the diagonal are stored in single precision, which halves the memory to read. The factor is only a preconditioner: a
// relative error of 6e-8 in it leaves the preconditioner symmetric and positive definite, and close to the inverse.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace weft::reference {

class BlockFactor {
 public:
  /// `pairs`: the pairs of particles that have a block, either way round; diagonal blocks are implied.
  BlockFactor(std::uint32_t particles, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);

  /// Sets the matrix to zero. Then symmetric blocks are added, for a pair (a, b) once, either way round.
  void clear();
  void add(std::uint32_t a, std::uint32_t b, const Eigen::Matrix3d& block);
  /// False where the matrix is not positive definite.
  bool factorise();

  /// Nearly A^-1 r, a column a particle: exactly the inverse of a positive definite matrix close to A.
  Eigen::Matrix3Xd solve(const Eigen::Matrix3Xd& r) const;

 private:
  using Matrix = Eigen::SparseMatrix<double>;

  std::vector<std::uint32_t> place_;     // of a particle in the order of elimination
  std::vector<Eigen::Triplet<double>> entries_;
  std::size_t pattern_ = 0;              // number of entries_ that are zeros, one at every pair, so that the pattern never changes
  Matrix matrix_;
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
  bool analysed_ = false;
  // The factor's columns of blocks: the inverse of the diagonal block, and the blocks below.
  std::vector<Eigen::Matrix3d> diagonal_;
  std::vector<std::uint32_t> first_;     // columns + 1
  std::vector<std::uint32_t> rows_;
  std::vector<Eigen::Matrix3f> blocks_;
};

}  // namespace weft::reference
