// Velocity-level solver: rows on two ranges of coordinates.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "sim/body/reduced/velocity_solver.h"

namespace kaz::sim {
namespace {

std::size_t tie_index(int i) {
  return static_cast<std::size_t>(i);
}

// Calls what(coordinate, entry) for the entries of a tie.
template <class What>
void for_each_tie_entry(const VelocitySolver::Tie& tie, What what) {
  const double* entry = tie.entry.data();
  for (std::size_t range = 0; range < 2; ++range) {
    for (int k = 0; k < tie.length[range]; ++k) what(tie.first[range] + k, *entry++);
  }
}

}  // namespace

void VelocitySolver::add_tie(const Tie& tie) {
  const auto each_block = [&](auto what) {
    for_each_tie_entry(tie, [&](int coordinate, double) { what(matrix_.block_of(coordinate)); });
  };
  each_block([&](int a) {
    matrix_.touch(a);
    each_block([&](int b) {
      if (a < b) matrix_.couple(a, b);
    });
  });
  ties_.emplace_back().tie = tie;
}

// Mobility along the row: sum_k entry_k^2 / M_kk (diagonal of M only).
void VelocitySolver::set_give(Tie& tie) const {
  if (tie.softness > 0) return;
  double mobility = 0;
  for_each_tie_entry(tie,
                     [&](int k, double entry) { mobility += entry * entry / matrix_.inertia(k); });
  tie.softness = kTieGive * mobility;
}

double VelocitySolver::along(const Tie& tie, const double* x) {
  double sum = 0;
  for_each_tie_entry(tie, [&](int k, double entry) { sum += entry * x[k]; });
  return sum;
}

// Velocities and impulses of the island's ties at v; g -= J^T l.
void VelocitySolver::take_ties(std::span<const double> v) {
  for (const int i : its_ties_) {
    TieRow& row = ties_[tie_index(i)];
    row.velocity = along(row.tie, v.data());
    row.impulse = tie_impulse(row.tie, row.velocity);
    for_each_tie_entry(
        row.tie, [&](int k, double entry) { gradient_[tie_index(k)] -= entry * row.impulse; });
  }
}

void VelocitySolver::set_tie_changes() {
  for (const int i : its_ties_)
    ties_[tie_index(i)].change = along(ties_[tie_index(i)].tie, change_.data());
}

// Impulses at `length` of the present change, times that change.
double VelocitySolver::tie_work(double length) const {
  double sum = 0;
  for (const int i : its_ties_) {
    const TieRow& row = ties_[tie_index(i)];
    sum += row.change * tie_impulse(row.tie, row.velocity + length * row.change);
  }
  return sum;
}

template <class Add>
void VelocitySolver::for_each_tie_stiffness(Add add) const {
  for (const int number : its_ties_) {
    const TieRow& row = ties_[tie_index(number)];
    if (!yields(row)) continue;
    for_each_tie_entry(row.tie, [&](int i, double of_i) {
      const double hard = of_i / row.tie.softness;
      for_each_tie_entry(row.tie, [&](int j, double of_j) {
        if (j <= i) add(i, j, hard * of_j);
      });
    });
  }
}

void VelocitySolver::add_tie_stiffness() {
  for (const int i : its_ties_) ties_[tie_index(i)].factored = yields(ties_[tie_index(i)]);
  for_each_tie_stiffness([this](int i, int j, double k) { matrix_.row_of(i)[j] += k; });
}

void VelocitySolver::add_coupled_ties() {
  for_each_tie_stiffness([this](int i, int j, double k) {
    const Eigen::Index a = place_[tie_index(i)], b = place_[tie_index(j)];
    coupled_(a, b) += k;
    if (a != b) coupled_(b, a) += k;
  });
}

}  // namespace kaz::sim
