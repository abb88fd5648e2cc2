// Velocity-level solver: inertia, motors, joint stops and contacts with Coulomb friction in one solve.
// SPDX-License-Identifier: Apache-2.0
//
// The unknowns are the velocities v after the step. Every row (motor, stop or contact) is compliant: its
// impulse is a function of its velocity u = J v alone. The solution satisfies
//
//   M v - p - sum J^T l(J v) = 0                    (p: momentum after the step without the rows)
//
//   bounded row   l = clamp((target - u) / softness, min, max)
//   normal        l_n = max(0, (target - u_n) / softness)
//   friction      l_t = l_t of the last step - u_t / give, projected onto the disc |l_t| <= mu l_n
//
// Friction has a cone, not a pyramid, in series with a spring whose stretch is kept from step to step.
//
// For fixed radii mu l_n this is the gradient of a convex, piecewise smooth function, quadratic where no
// contact slips. Newton's method with an exact line search converges in few iterations, even if many points
// share a load. After each iteration the radii are updated from l_n. This is Coulomb's law without the
// artifact of the convex cone, where friction lifts a sliding body. If the radii do not converge in a dozen
// iterations, Newton's method continues with the radii as functions of v (coupled_newton.cpp). If this fails
// too, the solver follows the path of growing friction (friction_path.cpp).
//
// All contact points of a pair of bodies act on one relative motion of six components. Their stiffness is
// therefore summed in 6 x 6 first and then mapped to the coordinates.
//
// Sources: the primal Newton solver of E. Todorov et al., MuJoCo ("Computation: solver algorithms"), and the
// regularized friction of A. Castro et al., "An unconstrained convex formulation of compliant contact", IEEE
// T-RO 39(2), 2023. In contrast to the latter, the normal force is that of the current iteration, not of the
// last step. In addition the stretch is kept, so that sticking contacts do not creep.
//
// Limits: hard contacts have a tangential compliance `give` too, kGive times the mobility of the bodies. With
// 1 N a ball of 15 g shifts by 7 micrometers and no further. Points that could carry the same friction (a
// sole on the floor) share it like parallel springs: in proportion to 1 / give, within their discs. If
// friction and normal force amplify each other without bound (a jamming wedge between almost massless
// bodies), the solver may find no solution. The number of iterations is bounded, and residual() returns the
// remaining change.
#pragma once

#include <algorithm>
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

  using Motion = Eigen::Matrix<double, 6, 1>;   // angular velocity, velocity of the reference point
  using Impulse = Eigen::Matrix<double, 6, 1>;  // normal, two tangents, two rolling, spin
  // A range of coordinates that a relative motion depends on.
  struct Segment {
    int first = 0, length = 0;
    // +1, -1: the six coordinates are the motion or its negative. 0: the Jacobian is in columns().
    double plain = 0;
  };
  struct Point {
    int pair = 0;
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();  // columns: normal, two tangents
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();        // m, from the pair's reference point
    double target = 0;                                    // m/s, normal velocity
    double softness = 0;                                  // m/s per N s, above 0
    double mu = 0;
    double give = 0;     // tangential compliance, m/s per N s; 0: kGive times the bodies' mobility
    double rolling = 0;  // rolling resistance, m; 0: no moments
    Impulse before = Impulse::Zero();  // impulse of the last step, N s and N m s
  };
  // Row on one coordinate, with a bounded impulse.
  struct Bounded {
    int coordinate = 0;
    double sign = 1;          // u = sign * v[coordinate]
    double target = 0;        // m/s or rad/s
    double softness = 0;      // (m/s) per N s or (rad/s) per N m s, above 0
    double min = 0, max = 0;  // N s or N m s
  };

  // Removes all rows. The caller then writes the system's blocks and inertia to matrix().
  void begin(int coordinates);
  BlockMatrix& matrix() { return matrix_; }

  // Adds the relative motion of two bodies and returns its index. `segments`: at most three that are not
  // empty, in ascending order of coordinates.
  int add_pair(std::span<const Segment> segments);
  // Jacobian of the pair: six numbers for each coordinate of the segments that are not plain, initially 0.
  // The pointer is valid until the next add_pair().
  double* columns(int pair) {
    return columns_.data() + pairs_[static_cast<std::size_t>(pair)].pool;
  }
  void add_point(const Point& point);
  void add_bounded(const Bounded& row) { bounded_.push_back(row); }

  // Call after the last row and before multiply() and solve().
  void close();
  // out = M x.
  void multiply(const double* x, double* out) const;
  // Solves for `v`, which contains the initial guess. `momentum`: p above. Each island iterates until no
  // velocity changes by more than `tolerance` (m/s or rad/s). `max_steps` limits the iterations with fixed
  // radii; the fallbacks have limits of their own.
  void solve(std::span<const double> momentum, std::span<double> v, double tolerance,
             int max_steps);

  std::size_t points() const { return points_.size(); }
  const Impulse& impulse(std::size_t point) const { return points_[point].impulse; }
  // Relative velocity along the point's rows after the step, m/s and rad/s.
  const Impulse& velocity(std::size_t point) const { return points_[point].velocity; }
  // Impulse of a bounded row, N s or N m s.
  double bounded(std::size_t row) const { return bounded_impulse_[row]; }
  // Over all islands in the last solve(): most iterations, and largest velocity change in the final iteration
  // (m/s or rad/s).
  int steps() const { return steps_; }
  double residual() const { return residual_; }

 private:
  using Stiffness = Eigen::Matrix<double, 6, 6>;
  struct Pair {
    std::array<Segment, 3> segments;
    int segment_count = 0, length = 0;  // length: number of columns
    std::size_t pool = 0;
    Motion motion, change, wrench;
    Stiffness stiffness;
  };
  struct Contact {
    Point point;
    double hardness = 0;                   // 1 / softness
    double firmness = 0, moment_firm = 0;  // 1 / give, for forces and for moments
    double length_t = 0, length_r = 0;  // radii of the friction discs in this iteration, N s, N m s
    Impulse velocity, change, impulse;
    std::uint8_t pattern = 0,
                 factored = 0;  // active set (pattern_of()) now and when H was factored
  };
  // Ends of an island's members in the lists below. They begin where those of the previous island end.
  struct Members {
    int pairs = 0, points = 0, bounded = 0;
  };

  // contact_rows.cpp
  void set_give(Contact& contact);
  Motion motion_of(const Pair& pair, const double* x) const;
  static void along(const Contact& contact, const Motion& motion, Impulse& u);
  static void set_lengths(Contact& contact, double relaxation);
  static void impulses(const Contact& contact, const Impulse& u, Impulse& l);
  static double work_along(const Contact& contact, double length);
  static std::uint8_t pattern_of(const Contact& contact);
  static double bounded_impulse(const Bounded& row, double u) {
    return std::clamp((row.target - u) / row.softness, row.min, row.max);
  }
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
  double slope(double length, std::span<const double> v) const;
  double search(std::span<const double> v) const;
  double step_length(std::span<const double> momentum, std::span<const double> v);
  void accelerate();
  // coupled_newton.cpp
  static void add_coupled_stiffness(const Contact& contact, Stiffness& k);
  void assemble_coupled(std::span<const int> coordinates);
  double merit() const;
  // Solves from v and returns the number of iterations. `left`: velocity change in the last iteration; if
  // above `tolerance`, v is not a solution.
  int solve_coupled(std::span<const double> momentum, std::span<double> v, double tolerance,
                    double& left);
  // friction_path.cpp
  class FrictionPath;
  int solve_along_path(std::span<const double> momentum, std::span<double> v, double tolerance,
                       double& left);
  int iterate(std::span<const double> momentum, std::span<double> v, double tolerance,
              int max_steps, double relaxed, double& left);
  int solve_island(std::span<const double> momentum, std::span<double> v, double tolerance,
                   int max_steps);

  BlockMatrix matrix_;
  std::vector<double> columns_;
  std::vector<Pair> pairs_;
  std::vector<Contact> points_;
  std::vector<Bounded> bounded_;
  std::vector<double> bounded_impulse_;
  std::vector<double> gradient_, change_, inertia_v_, inertia_change_;
  std::vector<double> requested_before_,
      gone_before_;  // change_ of the last iteration before and after accelerate()
  std::vector<double> scratch_;
  // Working memory of solve_coupled(): H, Jacobian of a pair and its product with the stiffness, index of
  // each coordinate in H.
  Eigen::MatrixXd coupled_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_, product_;
  std::vector<Eigen::Index> place_;
  std::vector<double> start_;
  // Members, grouped by island.
  std::vector<int> pair_list_, point_list_, bounded_list_;
  std::vector<Members> members_;
  // The island being solved.
  std::size_t island_ = 0;
  std::span<const int> its_pairs_, its_points_, its_bounded_;
  double start_slope_ = 0, curve_ = 0;  // inertial parts of the slope along the change
  // Active rows of calm blocks when these were factored, and the island to which they belong.
  std::vector<char> calm_yields_, factored_yields_;
  std::size_t calm_island_ = kNone;
  static constexpr std::size_t kNone = ~std::size_t{0};
  double relaxation_ = 1;  // factor on updates of the friction radii
  int steps_ = 0;
  double residual_ = 0;
};

}  // namespace kaz::sim
