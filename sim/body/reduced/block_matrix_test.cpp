// Factors of a system of branches and bodies against dense algebra.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/block_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "shared/base/random.hpp"

namespace kaz::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A root, a trunk with two arms on it, two legs on the root, three free bodies.
struct Blocks {
  int first, length, carrier;
};
constexpr Blocks kBlocks[] = {{0, 6, -1}, {6, 1, 0},   {7, 4, 1},   {11, 3, 1}, {14, 4, 0},
                              {18, 4, 0}, {22, 6, -1}, {28, 6, -1}, {34, 6, -1}};
constexpr int kSize = 40;

class BlockMatrixTest : public testing::Test {
 protected:
  double draw() { return keyed_normal(7, drawn_++, 0); }
  bool carries(int a, int b) const {
    for (int up = kBlocks[b].carrier; up >= 0; up = kBlocks[up].carrier) {
      if (up == a) return true;
    }
    return a == b;
  }
  void add(MatrixXd& to, int a, int b) {
    for (int i = kBlocks[a].first; i < kBlocks[a].first + kBlocks[a].length; ++i) {
      for (int j = kBlocks[b].first; j < kBlocks[b].first + kBlocks[b].length; ++j) {
        if (j > i) continue;
        to(i, j) += i == j ? 20 + draw() : 0.5 * draw();
        to(j, i) = to(i, j);
      }
    }
  }
  void start(const std::vector<std::pair<int, int>>& couples) {
    matrix_.begin(kSize);
    for (const Blocks& block : kBlocks) matrix_.add_block(block.first, block.length, block.carrier);
    inertia_ = MatrixXd::Zero(kSize, kSize);
    for (int b = 0; b < 9; ++b) {
      for (int a = 0; a <= b; ++a) {
        if (carries(a, b)) add(inertia_, b, a);
      }
    }
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j <= i; ++j) matrix_.inertia_row(i)[j] = inertia_(i, j);
    }
    for (const auto& [a, b] : couples) {
      matrix_.couple(a, b);
      matrix_.touch(a);
      matrix_.touch(b);
    }
    matrix_.close();
  }
  // Adds to H what couples, and compares.
  double error(const std::vector<std::pair<int, int>>& couples, bool keep) {
    MatrixXd dense = inertia_;
    for (const auto& [a, b] : couples) add(dense, std::max(a, b), std::min(a, b));
    for (const BlockMatrix::Island& island : matrix_.islands()) {
      matrix_.load(island, keep && island.calm);
      if (island.calm && !keep) matrix_.factor_calm(island);
    }
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j <= i; ++j) {
        if (dense(i, j) != inertia_(i, j)) matrix_.row_of(i)[j] += dense(i, j) - inertia_(i, j);
      }
    }
    VectorXd b(kSize);
    for (int i = 0; i < kSize; ++i) b[i] = draw();
    VectorXd x = b;
    for (const BlockMatrix::Island& island : matrix_.islands()) {
      matrix_.factor(island);
      matrix_.back_solve(island, x.data());
    }
    return (dense * x - b).norm() / b.norm();
  }

  BlockMatrix matrix_;
  MatrixXd inertia_;
  std::uint64_t drawn_ = 0;
};

TEST_F(BlockMatrixTest, SolvesWhatTouches) {
  const std::vector<std::vector<std::pair<int, int>>> cases{
      {},                                // nothing
      {{4, 0}, {5, 0}},                  // both feet on the ground
      {{2, 3}, {6, 2}, {6, 0}},          // hands together, and a ball in one of them
      {{6, 7}, {7, 8}},                  // a stack
      {{4, 6}, {6, 7}, {7, 8}, {8, 5}},  // all in a ring
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    start(cases[i]);
    EXPECT_LT(error(cases[i], false), 1e-12) << i;
    // Once more with other stiffness, and with calm blocks as they were factored.
    EXPECT_LT(error(cases[i], false), 1e-12) << i;
    EXPECT_LT(error(cases[i], true), 1e-12) << i;
  }
}

TEST_F(BlockMatrixTest, IslandsAreWhatIsCoupled) {
  start({{6, 7}});
  ASSERT_EQ(matrix_.islands().size(), 3u);
  EXPECT_EQ(matrix_.islands()[0].blocks.length, 6);
  EXPECT_EQ(matrix_.islands()[1].blocks.length, 2);
  EXPECT_EQ(matrix_.island_of(39), 2);
  EXPECT_TRUE(matrix_.islands()[0].calm);
  // Arms are not: what is left of them stands in the trunk. Nor is the trunk, which that is left in.
  for (const int block : {1, 2, 3}) EXPECT_FALSE(matrix_.calm(block)) << block;
  for (const int block : {4, 5}) EXPECT_TRUE(matrix_.calm(block)) << block;
}

TEST_F(BlockMatrixTest, MultipliesByTheInertia) {
  start({{6, 7}, {4, 0}});
  VectorXd x(kSize), out(kSize);
  for (int i = 0; i < kSize; ++i) x[i] = draw();
  for (const BlockMatrix::Island& island : matrix_.islands())
    matrix_.multiply(island, x.data(), out.data());
  EXPECT_LT((inertia_ * x - out).norm(), 1e-12 * out.norm());
}

}  // namespace
}  // namespace kaz::sim
