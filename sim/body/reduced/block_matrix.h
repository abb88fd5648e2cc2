// Symmetric positive definite block matrix for a kinematic tree and free bodies, with sparse factors.
// SPDX-License-Identifier: Apache-2.0
//
// A block is a group of coordinates. A floating base has one block. Each free body has one block. Each chain
// of joints between two branch points of the kinematic tree has one block. The inertia matrix couples the
// block of a chain to the blocks of the chain's ancestors. Contacts couple the blocks of touching bodies.
// Blocks that are coupled, directly or through other blocks, form an island. Islands are solved
// independently.
//
// Two matrices have this structure: the inertia matrix M, and the matrix H of a Newton iteration. H is M plus
// the stiffness of the solver's rows. H is factored as L^T L from the last coordinate to the first. With this
// order, one branch of the tree adds no nonzero entries (fill-in) to the factors of another branch
// (Featherstone, "Rigid Body Dynamics Algorithms", 6.5). A chain without contacts is called calm if the chain
// is attached to the root and no other chain is attached to this chain. For a calm chain, two results are
// reused until the chain's active set changes: the factors, and the Schur complement in the root's block.
//
// The class allocates no memory once the maximum numbers of coordinates and blocks are reached. All sums have
// a fixed order.
#pragma once

#include <cstddef>
#include <vector>

namespace kaz::sim {

class BlockMatrix {
 public:
  struct Range {
    int first = 0, length = 0;
  };
  struct Island {
    Range blocks;       // range of indices into order_
    bool calm = false;  // true if the island has calm blocks
  };

  // Removes all blocks. The following calls of add_block() must cover each coordinate once, in ascending
  // order.
  void begin(int coordinates);
  // Adds a block and returns the block's index. `carrier` is the index of the parent block, or -1. M couples
  // a block to all ancestors of the block.
  int add_block(int first, int length, int carrier);
  int block_of(int coordinate) const { return block_of_[at(coordinate)]; }
  int island_of(int coordinate) const { return blocks_[at(block_of(coordinate))].island; }
  // Call this function for the blocks of two bodies in contact.
  void couple(int block_a, int block_b);
  // Marks a block as having contacts. A block with contacts is never calm.
  void touch(int block) { blocks_[at(block)].calm = false; }
  // Computes fill-in, islands and calm blocks. Call close() after the last call of add_block(), couple() and
  // touch().
  void close();

  int size() const { return size_; }
  // Returns row i of M (lower triangle). The caller writes the columns of the block that contains row i, and
  // the columns of this block's ancestors.
  double* inertia_row(int i) { return inertia_.data() + row(i); }
  double inertia(int i) const { return inertia_[row(i) + at(i)]; }

  const std::vector<Island>& islands() const { return islands_; }
  // Returns the coordinates of the k-th block of an island.
  const Range& block(const Island& island, int k) const {
    return blocks_[at(order_[at(island.blocks.first + k)])].range;
  }
  bool calm(int block) const { return blocks_[at(block)].calm; }

  // Calls set(i, j, M_ij) for the structurally nonzero entries of an island's lower triangle.
  template <class Set>
  void for_each_inertia(const Island& island, Set set) const {
    for (int k = 0; k < island.blocks.length; ++k) {
      const Block& block = blocks_[at(order_[at(island.blocks.first + k)])];
      const int end = block.range.first + block.range.length;
      for (int i = block.range.first; i < end; ++i) {
        const double* m = inertia_.data() + row(i);
        for (int j = block.range.first; j <= i; ++j) set(i, j, m[j]);
        for (int a = block.carrier; a >= 0; a = blocks_[at(a)].carrier) {
          const Range& other = blocks_[at(a)].range;
          for (int j = other.first; j < other.first + other.length; ++j) set(i, j, m[j]);
        }
      }
    }
  }
  // Computes out = M x for an island's coordinates.
  void multiply(const Island& island, const double* x, double* out) const;
  // Sets H = M for an island. If `keep` is true, the factors of the island's calm blocks are kept.
  void load(const Island& island, bool keep);
  // Returns row i of H (lower triangle). Entries above the diagonal may be written but are never read.
  double* row_of(int i) { return matrix_.data() + row(i); }
  // Computes the factors of the calm blocks. load() can reuse these factors.
  void factor_calm(const Island& island);
  // Computes the factors of the blocks that are not calm. The factors of the calm blocks must already
  // exist.
  void factor(const Island& island);
  // Solves H y = x and overwrites x with the solution y. Call after factor().
  void back_solve(const Island& island, double* x) const;

 private:
  struct Block {
    Range range;
    int carrier = -1, island = -1;
    bool calm = true;
    // Range of below_: coordinates of the earlier blocks that are coupled to this block.
    Range below;
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::size_t row(int i) const { return at(i) * at(size_); }
  bool coupled(int a, int b) const { return coupled_[at(a) * blocks_.size() + at(b)] != 0; }
  void spread_couplings();
  void find_islands();
  void find_calm();
  void factor_block(const Block& block);

  int size_ = 0;
  std::vector<double> inertia_, matrix_, inverse_diagonal_;
  // The root's rows of H after the calm blocks were eliminated. load() can start from these rows.
  std::vector<double> root_kept_;
  std::vector<int> block_of_, order_;
  std::vector<Block> blocks_;
  std::vector<Range> couplings_;  // pairs of blocks from couple()
  // Square matrix, row by row. Suppose that block a comes before block b. If the two blocks are coupled,
  // directly or by fill-in, the element in row b and column a is 1.
  std::vector<char> coupled_;
  std::vector<Range> below_;
  std::vector<Island> islands_;
};

}  // namespace kaz::sim
