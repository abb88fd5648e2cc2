// Velocity-level solver: Newton's method, island by island.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/velocity_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kaz::sim {
namespace {

// The line search ends when the slope has fallen to this fraction.
constexpr double kSlopeShare = 1e-3;
constexpr int kSearchSteps = 40;
// change_left() treats coordinates separately and so may underestimate the coupled change.
constexpr double kSafety = 0.05;
// Below this velocity change (m/s or rad/s) and with the same active set the factors are reused.
constexpr double kNear = 1e-3;
constexpr double kMaxExtrapolation = 4;  // in units of the last change

// After this many iterations normal forces and friction radii are solved for together, and where that fails
// along a path. Where there is no solution, as in a jamming wedge, one after the other again, by this much.
constexpr int kPatience = 12;
constexpr double kRelaxed = 0.25;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// The larger value; NaN propagates.
double worse(double a, double b) {
  return a >= b || std::isnan(a) ? a : b;
}

}  // namespace

void VelocitySolver::begin(int coordinates) {
  if (coordinates != matrix_.size()) {
    for (auto* v :
         {&gradient_, &change_, &inertia_v_, &inertia_change_, &requested_before_, &gone_before_})
      v->assign(at(coordinates), 0);
  }
  matrix_.begin(coordinates);
  columns_.clear();
  pairs_.clear();
  points_.clear();
  bounded_.clear();
  ties_.clear();
}

void VelocitySolver::hold(std::span<const double> v) {
  const auto hold_row = [](auto& row, double u) {
    row.target = row.min == 0 ? std::min(row.target, u) : u;
    row.min = std::min(row.min, 0.0);
    row.max = std::max(row.max, 0.0);
  };
  for (Bounded& row : bounded_) hold_row(row, row.sign * v[at(row.coordinate)]);
  for (TieRow& row : ties_) hold_row(row.tie, along(row.tie, v.data()));
}

void VelocitySolver::close() {
  for (Contact& contact : points_) set_give(contact);
  for (TieRow& row : ties_) set_give(row.tie);
  matrix_.close();
  sort_members();
  bounded_impulse_.assign(bounded_.size(), 0);
  calm_yields_.assign(bounded_.size(), 0);
  factored_yields_.assign(bounded_.size(), 0);
  calm_island_ = kNone;
}

// Counting sort of pairs, points, bounded rows and ties by island, stable in the order of the rows.
void VelocitySolver::sort_members() {
  const std::size_t islands = matrix_.islands().size();
  members_.assign(islands, {});
  const auto sort = [&](std::size_t count, auto island_of, std::vector<int>& list, auto end) {
    for (std::size_t i = 0; i < count; ++i) ++(members_[at(island_of(i))].*end);
    int sum = 0;
    for (Members& members : members_) sum = std::exchange(members.*end, sum) + sum;
    // Now the begin offsets, which the next loop advances to the end offsets.
    list.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      list[at((members_[at(island_of(i))].*end)++)] = static_cast<int>(i);
  };
  const auto of_pair = [this](std::size_t i) {
    return matrix_.island_of(pairs_[i].segments.front().first);
  };
  sort(pairs_.size(), of_pair, pair_list_, &Members::pairs);
  sort(
      points_.size(), [&](std::size_t i) { return of_pair(at(points_[i].point.pair)); },
      point_list_, &Members::points);
  sort(
      bounded_.size(), [&](std::size_t i) { return matrix_.island_of(bounded_[i].coordinate); },
      bounded_list_, &Members::bounded);
  sort(
      ties_.size(),
      [&](std::size_t i) {
        const Tie& tie = ties_[i].tie;
        return matrix_.island_of(tie.first[tie.length[0] > 0 ? 0 : 1]);
      },
      tie_list_, &Members::ties);
}

void VelocitySolver::multiply(const double* x, double* out) const {
  for (const BlockMatrix::Island& island : matrix_.islands()) matrix_.multiply(island, x, out);
}

// Gradient g = M v - p - J^T l(J v), in N s and N m s, with updated friction radii. Also stores u, l and
// the active set of every row.
void VelocitySolver::gradient(std::span<const double> momentum, std::span<const double> v) {
  for_each_coordinate([&](std::size_t k) { gradient_[k] = inertia_v_[k] - momentum[k]; });
  for (const int i : its_pairs_) {
    Pair& pair = pairs_[at(i)];
    pair.motion = motion_of(pair, v.data());
    pair.wrench.setZero();
  }
  for (const int i : its_points_) {
    Contact& contact = points_[at(i)];
    Pair& pair = pairs_[at(contact.point.pair)];
    along(contact, pair.motion, contact.velocity);
    set_lengths(contact, relaxation_);
    impulses(contact, contact.velocity, contact.impulse);
    contact.pattern = pattern_of(contact);
    if (contact.impulse[0] > 0) add_wrench(contact, pair.wrench);
  }
  for (const int i : its_pairs_) take_wrench(pairs_[at(i)]);
  for (const int i : its_bounded_) {
    const Bounded& bounded = bounded_[at(i)];
    const std::size_t c = at(bounded.coordinate);
    bounded_impulse_[at(i)] = bounded_impulse(bounded, bounded.sign * v[c]);
    gradient_[c] -= bounded.sign * bounded_impulse_[at(i)];
  }
  take_ties(v);
}

// Jacobi estimate of the remaining velocity change: max |g_k| / M_kk, m/s or rad/s.
double VelocitySolver::change_left() const {
  double largest = 0;
  for_each_coordinate([&](std::size_t k) {
    largest = worse(largest, std::abs(gradient_[k]) / matrix_.inertia(static_cast<int>(k)));
  });
  return largest;
}

// Directional derivative of the convex function at v + length * d with d = change:
// d . (M v - p) + length d . M d - sum l(J v + length J d) . J d.
double VelocitySolver::slope(double length, std::span<const double> v) const {
  double sum = start_slope_ + length * curve_;
  for (const int i : its_points_) sum -= work_along(points_[at(i)], length);
  for (const int i : its_bounded_) {
    const Bounded& bounded = bounded_[at(i)];
    const std::size_t c = at(bounded.coordinate);
    const double change = bounded.sign * change_[c];
    sum -= change * bounded_impulse(bounded, bounded.sign * v[c] + length * change);
  }
  return its_ties_.empty() ? sum : sum - tie_work(length);
}

// Exact line search in [0, 1]: the zero of slope(), which increases monotonically.
double VelocitySolver::search(std::span<const double> v) const {
  const double at_start = slope(0, v);
  const double enough = kSlopeShare * std::abs(at_start);
  double low = 0, of_low = at_start, high = 1, of_high = slope(1, v);
  if (std::abs(of_high) <= enough || of_high < 0) return 1;
  // Illinois method (Dowell & Jarratt, BIT 11, 1971): regula falsi, where the value at an endpoint that was
  // kept twice is halved.
  int stayed = 0;
  for (int i = 0; i < kSearchSteps; ++i) {
    const double length = low - of_low * (high - low) / (of_high - of_low);
    const double here = slope(length, v);
    if (std::abs(here) <= enough) return length;
    if (here < 0) {
      low = length;
      of_low = here;
      if (stayed > 0) of_high /= 2;
      stayed = 1;
    } else {
      high = length;
      of_high = here;
      if (stayed < 0) of_low /= 2;
      stayed = -1;
    }
  }
  return low > 0 ? low : high;
}

// Prepares the parts of the slope that are linear along the change (d . (M v - p), d . M d, J d) and
// returns the step length of the line search.
double VelocitySolver::step_length(std::span<const double> momentum, std::span<const double> v) {
  start_slope_ = 0;
  curve_ = 0;
  for_each_coordinate([&](std::size_t k) {
    start_slope_ += change_[k] * (inertia_v_[k] - momentum[k]);
    curve_ += change_[k] * inertia_change_[k];
  });
  for (const int i : its_pairs_) {
    Pair& pair = pairs_[at(i)];
    pair.change = motion_of(pair, change_.data());
  }
  for (const int i : its_points_) {
    Contact& contact = points_[at(i)];
    along(contact, pairs_[at(contact.point.pair)].change, contact.change);
  }
  set_tie_changes();
  return search(v);
}

// With an unchanged active set only the friction radii still change, one iteration behind the normal
// forces: the changes converge geometrically and their limit can be extrapolated. Anderson acceleration
// with depth 1 (D. Anderson, J. ACM 12(4), 1965; Aitken's method for vectors): with d the present and d'
// the last Newton change, theta = d . (d - d') / |d - d'|^2, the change becomes d - theta (s' + d - d'), s'
// the last change applied.
void VelocitySolver::accelerate() {
  double product = 0, square = 0;
  for_each_coordinate([&](std::size_t k) {
    const double less = change_[k] - requested_before_[k];
    product += change_[k] * less;
    square += less * less;
  });
  const double theta = square > 0 ? std::clamp(product / square, -kMaxExtrapolation, 0.5) : 0;
  for_each_coordinate([&](std::size_t k) {
    const double requested = change_[k];
    change_[k] -= theta * (gone_before_[k] + requested - requested_before_[k]);
    requested_before_[k] = requested;
    gone_before_[k] = change_[k];
  });
}

int VelocitySolver::iterate(std::span<const double> momentum, std::span<double> v, double tolerance,
                            int max_steps, double relaxed, double& left) {
  const BlockMatrix::Island& island = matrix_.islands()[island_];
  matrix_.multiply(island, v.data(), inertia_v_.data());
  relaxation_ = 1;
  gradient(momentum, v);
  relaxation_ = relaxed;
  left = change_left();
  int steps = 0;
  bool near = false;  // same active set as in the iteration before, and that changed little
  while (steps < max_steps && left > kSafety * tolerance) {
    ++steps;
    // Newton step: (M + J^T D J) d = -g with D = -dl/du.
    if (!near) {
      add_stiffness();
      matrix_.factor(island);
    }
    for_each_coordinate([&](std::size_t k) { change_[k] = -gradient_[k]; });
    matrix_.back_solve(island, change_.data());
    left = 0;
    for_each_coordinate([&](std::size_t k) { left = worse(left, std::abs(change_[k])); });
    if (near) {
      accelerate();
    } else {
      for_each_coordinate(
          [&](std::size_t k) { requested_before_[k] = gone_before_[k] = change_[k]; });
    }
    matrix_.multiply(island, change_.data(), inertia_change_.data());
    const double length = near || left <= tolerance ? 1 : step_length(momentum, v);
    for_each_coordinate([&](std::size_t k) {
      v[k] += length * change_[k];
      inertia_v_[k] += length * inertia_change_[k];
    });
    gradient(momentum, v);
    if (left <= tolerance) break;
    near = left < kNear && length == 1 && !pattern_changed();
  }
  return steps;
}

int VelocitySolver::solve_island(std::span<const double> momentum, std::span<double> v,
                                 double tolerance, int max_steps) {
  double left = 0;
  int steps = iterate(momentum, v, tolerance, std::min(kPatience, max_steps), 1, left);
  if (left > tolerance && steps < max_steps) {
    start_.assign(v.begin(), v.end());
    steps += solve_coupled(momentum, v, tolerance, left);
  }
  if (const int remaining = max_steps - steps; left > tolerance && remaining > 0) {
    std::ranges::copy(start_, v.begin());
    steps += solve_along_path(momentum, v, tolerance, left);
    if (left > tolerance) {
      std::ranges::copy(start_, v.begin());
      steps += iterate(momentum, v, tolerance, remaining, kRelaxed, left);
    }
  }
  residual_ = worse(residual_, left);
  return steps;
}

void VelocitySolver::solve(std::span<const double> momentum, std::span<double> v, double tolerance,
                           int max_steps) {
  steps_ = 0;
  residual_ = 0;
  Members begin;
  for (island_ = 0; island_ < members_.size(); ++island_) {
    const Members& end = members_[island_];
    const auto part = [](const std::vector<int>& list, int from, int to) {
      return std::span(list).subspan(at(from), at(to - from));
    };
    its_pairs_ = part(pair_list_, begin.pairs, end.pairs);
    its_points_ = part(point_list_, begin.points, end.points);
    its_bounded_ = part(bounded_list_, begin.bounded, end.bounded);
    its_ties_ = part(tie_list_, begin.ties, end.ties);
    begin = end;
    steps_ = std::max(steps_, solve_island(momentum, v, tolerance, max_steps));
  }
}

}  // namespace kaz::sim
