// Symmetric positive definite block matrix of a kinematic tree and free bodies.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/block_matrix.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "sim/body/reduced/small_sums.h"

namespace kaz::sim {
namespace {

// Coordinates of a floating base or a free body.
using Six = Eigen::Matrix<double, 6, 1>;

}  // namespace

void BlockMatrix::begin(int coordinates) {
  if (coordinates != size_) {
    // Nothing is read that has not been written since: of two worlds that take turns in a thread, the smaller
    // uses the memory of the larger.
    size_ = coordinates;
    const std::size_t size = at(size_);
    inertia_.resize(std::max(inertia_.size(), size * size));
    matrix_.resize(inertia_.size());
    inverse_diagonal_.resize(size);
    block_of_.resize(size);
  }
  blocks_.clear();
  couplings_.clear();
}

int BlockMatrix::add_block(int first, int length, int carrier) {
  const int number = static_cast<int>(blocks_.size());
  Block block;
  block.range = {first, length};
  block.carrier = carrier;
  blocks_.push_back(block);
  for (int i = first; i < first + length; ++i) block_of_[at(i)] = number;
  return number;
}

void BlockMatrix::couple(int block_a, int block_b) {
  if (block_a != block_b) couplings_.push_back({block_a, block_b});
}

void BlockMatrix::close() {
  spread_couplings();
  find_islands();
  find_calm();
}

// Symbolic factorisation: eliminating a block couples all its neighbours (fill-in).
void BlockMatrix::spread_couplings() {
  const int count = static_cast<int>(blocks_.size());
  coupled_.assign(at(count) * at(count), 0);
  const auto set = [&](int a, int b) {
    coupled_[at(std::max(a, b)) * at(count) + at(std::min(a, b))] = 1;
  };
  for (int b = 0; b < count; ++b) {
    for (int a = blocks_[at(b)].carrier; a >= 0; a = blocks_[at(a)].carrier) set(b, a);
  }
  for (const Range& pair : couplings_) set(pair.first, pair.length);
  below_.clear();
  for (int b = count - 1; b >= 0; --b) {
    Block& block = blocks_[at(b)];
    block.below = {static_cast<int>(below_.size()), 0};
    for (int a = 0; a < b; ++a) {
      if (!coupled(b, a)) continue;
      below_.push_back(blocks_[at(a)].range);
      ++block.below.length;
      for (int c = 0; c < a; ++c) {
        if (coupled(b, c)) set(a, c);
      }
    }
  }
}

// Connected components by breadth-first search. The blocks of an island are consecutive in `order_`,
// ascending.
void BlockMatrix::find_islands() {
  const int count = static_cast<int>(blocks_.size());
  islands_.clear();
  order_.clear();
  for (Block& block : blocks_) block.island = -1;
  for (int b = 0; b < count; ++b) {
    if (blocks_[at(b)].island >= 0) continue;
    const int number = static_cast<int>(islands_.size());
    const int begin = static_cast<int>(order_.size());
    blocks_[at(b)].island = number;
    order_.push_back(b);
    for (std::size_t next = at(begin); next < order_.size(); ++next) {
      const int here = order_[next];
      for (int other = 0; other < count; ++other) {
        if (blocks_[at(other)].island >= 0) continue;
        if (!coupled(std::max(here, other), std::min(here, other))) continue;
        blocks_[at(other)].island = number;
        order_.push_back(other);
      }
    }
    std::sort(order_.begin() + begin, order_.end());
    islands_.push_back({{begin, static_cast<int>(order_.size()) - begin}, false});
  }
}

// A block is calm if its elimination changes the root's block only and no other block changes it.
void BlockMatrix::find_calm() {
  for (std::size_t b = blocks_.size(); b-- > 0;) {
    Block& block = blocks_[b];
    block.calm = block.calm && block.carrier == 0 && block.below.length == 1;
    if (block.calm) {
      islands_[at(block.island)].calm = true;
      continue;
    }
    for (std::size_t a = 1; a < b; ++a) {
      if (coupled(static_cast<int>(b), static_cast<int>(a))) blocks_[a].calm = false;
    }
  }
}

// out = M x with the lower triangle: each entry M_ij, j < i, contributes to out_i and out_j.
void BlockMatrix::multiply(const Island& island, const double* __restrict x,
                           double* __restrict out) const {
  for (int k = 0; k < island.blocks.length; ++k) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    const int begin = block.range.first, end = begin + block.range.length;
    for (int i = begin; i < end; ++i) {
      const double* m = inertia_.data() + row(i);
      double sum = m[i] * x[i];
      for (int j = begin; j < i; ++j) {
        sum += m[j] * x[j];
        out[j] += m[j] * x[i];
      }
      out[i] = sum;
    }
    for (int a = block.carrier; a >= 0; a = blocks_[at(a)].carrier) {
      const Range& other = blocks_[at(a)].range;
      if (other.length == 6) {
        Eigen::Map<const Six> of(x + other.first);
        Six given = Six::Zero();
        for (int i = begin; i < end; ++i) {
          Eigen::Map<const Six> m(inertia_.data() + row(i) + other.first);
          out[i] += m.dot(of);
          given += x[i] * m;
        }
        Eigen::Map<Six>(out + other.first) += given;
        continue;
      }
      for (int i = begin; i < end; ++i) {
        const double* m = inertia_.data() + row(i) + other.first;
        out[i] += dot(m, x + other.first, other.length);
        add_range(x[i], m, out + other.first, other.length);
      }
    }
  }
}

void BlockMatrix::load(const Island& island, bool keep) {
  for (int k = 0; k < island.blocks.length; ++k) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    if (keep && block.calm) continue;
    const int begin = block.range.first;
    const bool kept = keep && begin == 0;  // the root
    for (int i = begin; i < begin + block.range.length; ++i) {
      const double* from =
          kept ? root_kept_.data() + at(i) * at(block.range.length) : inertia_.data() + row(i);
      double* to = matrix_.data() + row(i);
      for (int b = 0; b < block.below.length; ++b) {
        const Range& below = below_[at(block.below.first + b)];
        std::fill_n(to + below.first, below.length, 0.0);
      }
      for (int a = block.carrier; a >= 0; a = blocks_[at(a)].carrier) {
        const Range& other = blocks_[at(a)].range;
        std::copy_n(from + other.first, other.length, to + other.first);
      }
      std::copy(from + begin, from + i + 1, to + begin);
    }
  }
}

// Factors H = L^T L of a block, from its last row to its first: L_kk = sqrt(H_kk), L_ki = H_ki / L_kk, then
// the rank-one update H_ij -= L_ki L_kj of all rows before k.
void BlockMatrix::factor_block(const Block& block) {
  const Range* below = below_.data() + block.below.first;
  const Range* end = below + block.below.length;
  for (int k = block.range.first + block.range.length - 1; k >= block.range.first; --k) {
    double* of_k = matrix_.data() + row(k);
    const double root = std::sqrt(of_k[k]);
    const double inverse = 1 / root;
    of_k[k] = root;
    inverse_diagonal_[at(k)] = inverse;
    const int first = block.range.first;
    for (int i = first; i < k; ++i) of_k[i] *= inverse;
    for (const Range* r = below; r < end; ++r) {
      for (int i = r->first; i < r->first + r->length; ++i) of_k[i] *= inverse;
    }
    for (int i = first; i < k; ++i) {
      double* of_i = matrix_.data() + row(i);
      for (int j = first; j <= i; ++j) of_i[j] -= of_k[i] * of_k[j];
      for (const Range* r = below; r < end; ++r)
        add_range(-of_k[i], of_k + r->first, of_i + r->first, r->length);
    }
    // Writes above the diagonal as well; those entries are never read.
    for (const Range* r = below; r < end; ++r) {
      for (int i = r->first; i < r->first + r->length; ++i) {
        double* of_i = matrix_.data() + row(i);
        for (const Range* s = below; s <= r; ++s)
          add_range(-of_k[i], of_k + s->first, of_i + s->first, s->length);
      }
    }
  }
}

void BlockMatrix::factor_calm(const Island& island) {
  if (!island.calm) return;
  for (int k = island.blocks.length; k-- > 0;) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    if (block.calm) factor_block(block);
  }
  const int root = blocks_.front().range.length;
  root_kept_.resize(at(root) * at(root));
  for (int i = 0; i < root; ++i)
    std::copy_n(matrix_.data() + row(i), root, root_kept_.data() + at(i) * at(root));
}

void BlockMatrix::factor(const Island& island) {
  for (int k = island.blocks.length; k-- > 0;) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    if (!block.calm) factor_block(block);
  }
}

// Solves L^T y = x from the last row to the first, then L x = y from the first to the last.
void BlockMatrix::back_solve(const Island& island, double* __restrict x) const {
  for (int k = island.blocks.length; k-- > 0;) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    const int begin = block.range.first, end = begin + block.range.length;
    for (int i = end - 1; i >= begin; --i) {
      const double* h = matrix_.data() + row(i);
      const double xi = x[i] * inverse_diagonal_[at(i)];
      x[i] = xi;
      for (int j = begin; j < i; ++j) x[j] -= xi * h[j];
    }
    for (int b = 0; b < block.below.length; ++b) {
      const Range& below = below_[at(block.below.first + b)];
      if (below.length == 6) {
        Six taken = Six::Zero();
        for (int i = begin; i < end; ++i)
          taken += x[i] * Eigen::Map<const Six>(matrix_.data() + row(i) + below.first);
        Eigen::Map<Six>(x + below.first) -= taken;
        continue;
      }
      for (int i = begin; i < end; ++i)
        add_range(-x[i], matrix_.data() + row(i) + below.first, x + below.first, below.length);
    }
  }
  for (int k = 0; k < island.blocks.length; ++k) {
    const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
    const int begin = block.range.first, end = begin + block.range.length;
    for (int b = 0; b < block.below.length; ++b) {
      const Range& below = below_[at(block.below.first + b)];
      if (below.length == 6) {
        const Six of = Eigen::Map<const Six>(x + below.first);
        for (int i = begin; i < end; ++i)
          x[i] -= of.dot(Eigen::Map<const Six>(matrix_.data() + row(i) + below.first));
        continue;
      }
      for (int i = begin; i < end; ++i)
        x[i] -= dot(matrix_.data() + row(i) + below.first, x + below.first, below.length);
    }
    for (int i = begin; i < end; ++i) {
      const double* h = matrix_.data() + row(i);
      double sum = x[i];
      for (int j = begin; j < i; ++j) sum -= h[j] * x[j];
      x[i] = sum * inverse_diagonal_[at(i)];
    }
  }
}

}  // namespace kaz::sim
