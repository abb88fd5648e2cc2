// Velocities after a step: inertia, motors, stops and contacts with Coulomb friction in one solve.
// SPDX-License-Identifier: Apache-2.0
//
// Unknown are the velocities v. Every row, of a motor, a stop or a contact, yields a little: its impulse
// is a function of its velocity u = J v alone. So the answer is where
//
//   M v - p - sum J^T l(J v) = 0                    (p: momentum that the step leaves without rows)
//
//   bounded row   l = clamp((target - u) / softness, least, most)
//   normal        l_n = max(0, (target - u_n) / softness)
//   friction      l_t = l_t of the step before - u_t / give, cut to the length mu l_n: a cone, not a
//                 pyramid, behind a spring whose stretch is kept from step to step
//
// For given lengths mu l_n this is the gradient of a convex function, smooth but for kinks, piecewise
// quadratic where nothing slips. Newton's method with an exact line search finds it in few steps however
// many points share a load; after each step the lengths are taken anew from l_n. That is Coulomb's law as
// it stands: friction does not lift what slips, as it does where the cone itself is made convex.
//
// All points of two bodies that touch act on one motion, that of the one against the other: six numbers.
// So their share of the matrix is first summed up in 6 x 6 and only then brought to the coordinates.
//
// Sources: the primal Newton solver of E. Todorov et al., MuJoCo ("Computation: solver algorithms"); A.
// Castro et al., "An unconstrained convex formulation of compliant contact", IEEE T-RO 39(2), 2023, whose
// regularised friction this is, with the normal force of the iteration instead of that of the last step
// and the stretch kept, so that what sticks does not creep.
//
// Limits: what is hard has a `give` too, kGive of what an impulse does to the bodies if they were free:
// 1 N shifts a ball of 15 g by 7 micrometres, and then no further. Where friction and normal force feed
// each other (a wedge that jams) and the contact is hard, the lengths may need many steps: the most are
// bounded, and what is left is told by residual().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/body/reduced/block_matrix.h"

namespace kaz::sim {

class VelocitySolver {
 public:
  static constexpr double kGive = 0.1;

  using Motion = Eigen::Matrix<double, 6, 1>;  // angular velocity, velocity of a point of reference
  using Impulse = Eigen::Matrix<double, 6, 1>;  // normal, two tangents, two rolling, spin
  // Coordinates that a motion depends on.
  struct Segment {
    int first = 0, length = 0;
    double plain =
        0;  // 1 or -1: six coordinates that are the motion, or its opposite; 0: columns say
  };
  struct Point {
    int pair = 0;
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();  // columns: normal, two tangents
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();        // m, from the pair's point of reference
    double target = 0;                                    // m/s, of the normal velocity
    double softness = 0;                                  // m/s per N s, above 0
    double mu = 0;
    double give = 0;     // m/s per N s, of friction; 0: kGive of what the bodies yield
    double rolling = 0;  // m; 0: no moments
    Impulse before = Impulse::Zero();  // of the step before
  };
  struct Bounded {
    int coordinate = 0;
    double sign = 1;      // u = sign * v[coordinate]
    double target = 0;    // m/s or rad/s
    double softness = 0;  // per N s or N m s, above 0
    double min = 0, max = 0;
  };

  // Forgets all rows. Then the system's blocks and its inertia are to be written to matrix().
  void begin(int coordinates);
  BlockMatrix& matrix() { return matrix_; }

  // The motion of one body against another, over `segments` in rising order of coordinates.
  int add_pair(std::span<const Segment> segments);
  // Six numbers for each coordinate of the segments that are not plain, one after another, zeros until
  // written. Valid until the next pair.
  double* columns(int pair) {
    return columns_.data() + pairs_[static_cast<std::size_t>(pair)].pool;
  }
  void add_point(const Point& point);
  void add_bounded(const Bounded& row) { bounded_.push_back(row); }

  // After the last row, before what follows.
  void close();
  // out = M x.
  void multiply(const double* x, double* out) const;
  // v: a guess in, the velocities out. `momentum` is p above. Ends, for each island by itself, with the
  // step that changes no velocity by more than the tolerance, m/s or rad/s.
  void solve(std::span<const double> momentum, std::span<double> v, double tolerance,
             int max_steps);

  std::size_t points() const { return points_.size(); }
  const Impulse& impulse(std::size_t point) const { return points_[point].impulse; }
  // Along its rows, m/s and rad/s, after the step.
  const Impulse& velocity(std::size_t point) const { return points_[point].velocity; }
  double bounded(std::size_t row) const { return bounded_impulse_[row]; }
  // Of the last solve(): most steps of an island, and the largest change of a velocity in its last one.
  int steps() const { return steps_; }
  double residual() const { return residual_; }

 private:
  using Stiffness = Eigen::Matrix<double, 6, 6>;
  struct Pair {
    std::array<Segment, 3> segments;
    int segment_count = 0, length = 0;  // length: of the columns
    std::size_t pool = 0;
    Motion motion, change, wrench;
    Stiffness stiffness;
  };
  struct Contact {
    Point point;
    double hardness = 0;                   // 1 / softness
    double firmness = 0, moment_firm = 0;  // 1 / give, of forces and of moments
    double length_t = 0, length_r = 0;     // N s, N m s: that friction may have in this step
    Impulse velocity, change, impulse;
    std::uint8_t pattern = 0, factored = 0;  // which of its rows act how; and when H was factored
  };
  // Ends of an island's members in the lists below; the beginnings are the ends of the one before.
  struct Members {
    int pairs = 0, points = 0, bounded = 0;
  };

  // contact_rows.cpp
  void set_give(Contact& contact);
  Motion motion_of(const Pair& pair, const double* x) const;
  static void along(const Contact& contact, const Motion& motion, Impulse& u);
  static void set_lengths(Contact& contact, double anew);
  static void impulses(const Contact& contact, const Impulse& u, Impulse& l);
  static std::uint8_t pattern_of(const Contact& contact);
  static double bounded_impulse(const Bounded& row, double u);
  static void add_wrench(const Contact& contact, Motion& wrench);
  void take_wrench(const Pair& pair);
  static void add_point_stiffness(const Contact& contact, Stiffness& k);
  void add_pair_rows(const Pair& pair);
  bool yields(int bounded) const;
  bool calm_rows_changed();
  bool pattern_changed() const;
  void add_stiffness();
  // velocity_solver.cpp
  template <class Do>
  void for_each_coordinate(Do what) const {
    const BlockMatrix::Island& island = matrix_.islands()[island_];
    for (int b = 0; b < island.blocks.length; ++b) {
      const BlockMatrix::Range& range = matrix_.block(island, b);
      for (int i = range.first; i < range.first + range.length; ++i)
        what(static_cast<std::size_t>(i));
    }
  }
  void sort_members();
  void gradient(std::span<const double> momentum, std::span<const double> v);
  double change_left() const;
  double slope(double way, std::span<const double> v) const;
  double search(std::span<const double> v) const;
  double way_along_change(std::span<const double> momentum, std::span<const double> v);
  void foresee();
  int solve_island(std::span<const double> momentum, std::span<double> v, double tolerance,
                   int max_steps);

  BlockMatrix matrix_;
  std::vector<double> columns_;
  std::vector<Pair> pairs_;
  std::vector<Contact> points_;
  std::vector<Bounded> bounded_;
  std::vector<double> bounded_impulse_;
  std::vector<double> gradient_, change_, inertia_v_, inertia_change_;
  std::vector<double> asked_before_,
      gone_before_;  // change_ of the last step, before foresee() and after
  std::vector<double> scratch_;
  // By island.
  std::vector<int> pair_list_, point_list_, bounded_list_;
  std::vector<Members> members_;
  // Of the one that is being solved.
  std::size_t island_ = 0;
  std::span<const int> its_pairs_, its_points_, its_bounded_;
  double start_slope_ = 0, curve_ = 0;  // of the inertia's part along the change
  // Which rows of calm blocks yielded when these were factored, and the island that they are of.
  std::vector<char> calm_yields_, factored_yields_;
  std::size_t calm_island_ = kNone;
  static constexpr std::size_t kNone = ~std::size_t{0};
  double anew_ = 1;  // share of the lengths of friction that is taken anew
  int steps_ = 0;
  double residual_ = 0;
};

}  // namespace kaz::sim
