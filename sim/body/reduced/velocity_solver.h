// Velocity-level constraint solver. One system of equations contains inertia, motors, joint stops and
// contacts with Coulomb friction.
// SPDX-License-Identifier: Apache-2.0
//
// The unknowns are the velocities v after the step. Every row (motor, stop or contact) is compliant: the
// impulse of a row depends only on the row's velocity u = J v. The solution satisfies
//
//   M v - p - sum J^T l(J v) = 0                    (p: momentum after a step without the rows)
//
//   bounded row   l = clamp((target - u) / softness, min, max)
//   tie           likewise; u is a sum over two ranges of coordinates
//   normal        l_n = max(0, (target - u_n) / softness)
//   friction      l_t = l_t of the last step - u_t / give, projected onto the disc |l_t| <= mu l_n
//
// Friction uses a cone, not a pyramid. Each contact has a tangential spring in series with the friction. The
// stretch of this spring is kept from step to step.
//
// If the radii of the friction discs are fixed, the left side of the first equation is the gradient of a
// convex function of v. The convex function is piecewise smooth, and quadratic where no contact slips.
// Newton's method with an exact line search converges in few iterations, even if many points share a load.
// After each iteration the radii are updated from l_n. The result satisfies Coulomb's law.
// Unlike in convex formulations, friction does not lift a sliding body. If the radii do not converge in a
// dozen iterations, Newton's method continues with the radii as functions of v (coupled_newton.cpp). If
// coupled_newton.cpp does not converge either, the solver increases the friction gradually
// (friction_path.cpp).
//
// All contact points of a pair of bodies act on the same relative motion, which has six components. Therefore
// the solver first sums the stiffness of the points in a 6 x 6 matrix and then maps this matrix to the
// coordinates.
//
// The primal Newton solver follows MuJoCo (Todorov et al., "Computation: solver algorithms"). The regularized
// friction follows Castro et al., "An unconstrained convex formulation of compliant contact", IEEE T-RO
// 39(2), 2023. This solver differs from Castro et al. in two points. The friction limit uses the normal force
// of the current iteration, not the normal force of the previous time step. The stretch of the tangential
// spring is kept, so that sticking contacts do not creep.
//
// This solver has limitations. Even a hard contact yields along the surface: its tangential compliance `give`
// is kGive times the mobility of the bodies. For example, a tangential force of 1 N shifts a ball of 15 g by
// 7 micrometers. If two bodies touch at several points, like a sole and the floor, these points share the
// friction force like parallel springs. Suppose that point A has half the `give` of point B. Then the
// friction force at point A is twice the friction force at point B. At each point, the friction force is
// limited to the radius of the point's friction disc. If friction and normal force amplify each other without
// bound (a jamming wedge between almost massless bodies), the solver may find no solution. The number of
// iterations is bounded, and residual() returns the velocity change in the last iteration.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/body/reduced/block_matrix.h"

namespace kaz::sim {

class VelocitySolver {
 public:
  static constexpr double kGive = 0.1;
  // An equation between velocities is a row with this compliance, relative to the mobility along the row. It
  // yields by this share of the velocity that the row's impulse changes in a step.
  static constexpr double kTieGive = 1e-7;

  using Motion = Eigen::Matrix<double, 6, 1>;   // angular velocity, velocity of the reference point
  using Impulse = Eigen::Matrix<double, 6, 1>;  // normal, two tangents, two rolling, spin
  // A range of coordinates on which a relative motion depends.
  struct Segment {
    int first = 0, length = 0;
    // Selects the contribution of the segment to the relative motion. If `plain` is +1, the contribution is
    // the vector of the segment's six coordinates. If `plain` is -1, the contribution is the negative of this
    // vector. If `plain` is 0, the contribution is J times the segment's coordinates. columns() contains the
    // Jacobian J.
    double plain = 0;
  };
  struct Point {
    int pair = 0;
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();  // columns: normal, two tangents
    // Vector from the pair's reference point to the contact point, m.
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    double target = 0;    // target of the normal velocity, m/s
    double softness = 0;  // m/s per N s, above 0
    double mu = 0;
    // Tangential compliance, m/s per N s. 0: the solver uses give_share times the mobility of the bodies.
    double give = 0, give_share = kGive;
    double rolling = 0;  // rolling resistance, m; 0: no moments
    // Impulse of this contact point in the last step, N s and N m s.
    Impulse before = Impulse::Zero();
  };
  // A row that acts on one coordinate with a bounded impulse.
  struct Bounded {
    int coordinate = 0;
    double sign = 1;          // u = sign * v[coordinate]
    double target = 0;        // m/s or rad/s
    double softness = 0;      // (m/s) per N s or (rad/s) per N m s, above 0
    double min = 0, max = 0;  // N s or N m s
  };

  // A row on two ranges of coordinates, such as a coupling of two joints: u is the sum of each entry times
  // its coordinate. `entry` lists the first range, then the second; a range may be empty.
  struct Tie {
    static constexpr double kEndless = std::numeric_limits<double>::infinity();
    std::array<int, 2> first{}, length{};
    std::array<double, 12> entry{};
    double target = 0;  // m/s or rad/s
    // As of a bounded row. 0: the solver uses kTieGive times the mobility along the row.
    double softness = 0;
    double min = -kEndless, max = kEndless;  // N s or N m s
  };

  // Removes all rows. After begin(), the caller writes the blocks and the inertia of the system to matrix().
  void begin(int coordinates);
  BlockMatrix& matrix() { return matrix_; }

  // Adds the relative motion of two bodies and returns the index of the pair. At most three of the segments
  // may be non-empty. The segments must be in ascending order of coordinates.
  int add_pair(std::span<const Segment> segments);
  // Returns the Jacobian of the pair. The Jacobian covers only the segments for which Segment::plain is 0.
  // For each coordinate of these segments, the Jacobian has six numbers. All numbers are initially 0. The
  // pointer is valid until the next add_pair().
  double* columns(int pair) {
    return columns_.data() + pairs_[static_cast<std::size_t>(pair)].pool;
  }
  void add_point(const Point& point);
  void add_bounded(const Bounded& row) { bounded_.push_back(row); }
  void add_tie(const Tie& tie);

  // Sets the targets of the bounded rows and ties so that these rows exert no impulse at the velocities v.
  // Rows with a lower bound of 0 only get smaller targets.
  void hold(std::span<const double> v);
  // Call after the last row was added and before multiply() and solve().
  void close();
  // Changes Point::target. solve() may be called again afterward.
  void set_target(std::size_t point, double target) { points_[point].point.target = target; }
  // Computes out = M x.
  void multiply(const double* x, double* out) const;
  // Solves for `v`, which contains the initial guess on entry. `momentum` is the vector p in the first
  // equation of this file. The iteration of an island ends when one iteration changes no velocity by more
  // than `tolerance` (m/s or rad/s). `max_steps` limits the iterations with fixed radii; the fallback
  // methods have their own limits.
  void solve(std::span<const double> momentum, std::span<double> v, double tolerance,
             int max_steps);

  std::size_t points() const { return points_.size(); }
  // Index into matrix().islands().
  int island_of(std::size_t point) const {
    const Pair& pair = pairs_[static_cast<std::size_t>(points_[point].point.pair)];
    return matrix_.island_of(pair.segments.front().first);
  }
  const Impulse& impulse(std::size_t point) const { return points_[point].impulse; }
  // Returns the relative velocity of two bodies at a contact point after the step. The first three
  // components are velocities (m/s) along the normal and two tangents. The last three components are angular
  // velocities (rad/s) about the two tangents and the normal. If Point::rolling is 0, the angular velocities
  // are set to 0.
  const Impulse& velocity(std::size_t point) const { return points_[point].velocity; }
  // Returns the impulse of a bounded row, N s or N m s.
  double bounded(std::size_t row) const { return bounded_impulse_[row]; }
  // Returns the impulse of a tie, N s or N m s.
  double tie(std::size_t row) const { return ties_[row].impulse; }
  // steps() returns the number of iterations of the last solve(). residual() returns the velocity change in
  // the final iteration (m/s or rad/s). Both steps() and residual() return the largest value of all islands.
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
    double hardness = 0;  // 1 / softness
    // `firmness` is the inverse of the tangential compliance. `moment_firm` is the inverse of the compliance
    // for rolling and spin.
    double firmness = 0, moment_firm = 0;
    double length_t = 0, length_r = 0;  // radii of the friction discs in this iteration, N s, N m s
    Impulse velocity, change, impulse;
    // The member `pattern` is the present active set (pattern_of()). The member `factored` is the active set
    // at the last factorization of H.
    std::uint8_t pattern = 0, factored = 0;
  };
  struct TieRow {
    Tie tie;
    double velocity = 0, change = 0, impulse = 0;
    bool factored =
        false;  // whether the impulse was between the bounds at the last factorization of H
  };
  // An island owns one range of elements in each of pair_list_, point_list_, bounded_list_ and tie_list_. For
  // each of these ranges, the struct Members contains the index after the last element. Each range begins at
  // the end of the previous island's range.
  struct Members {
    int pairs = 0, points = 0, bounded = 0, ties = 0;
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
  // tie_rows.cpp
  void set_give(Tie& tie) const;
  static double along(const Tie& tie, const double* x);
  static double tie_impulse(const Tie& tie, double u) {
    return std::clamp((tie.target - u) / tie.softness, tie.min, tie.max);
  }
  static bool yields(const TieRow& row) {
    return row.impulse > row.tie.min && row.impulse < row.tie.max;
  }
  void take_ties(std::span<const double> v);
  double tie_work(double length) const;
  void set_tie_changes();
  // Calls add(i, j, K_ij), i >= j, for the stiffness of the island's ties that yield.
  template <class Add>
  void for_each_tie_stiffness(Add add) const;
  void add_tie_stiffness();
  void add_coupled_ties();
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
  // Solves the equations with the initial guess v and returns the number of iterations. `left` receives the
  // velocity change in the last iteration. If `left` is above `tolerance`, v is not a solution.
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
  std::vector<TieRow> ties_;
  std::vector<double> gradient_, change_, inertia_v_, inertia_change_;
  // The vector requested_before_ is the Newton step of the previous iteration. The vector gone_before_ is the
  // step after accelerate() has modified the Newton step. If the previous iteration did not call
  // accelerate(), the two vectors are equal.
  std::vector<double> requested_before_, gone_before_;
  std::vector<double> scratch_;
  // Working memory of solve_coupled(): H, the Jacobian of a pair, the product of Jacobian and stiffness, and
  // the index of each coordinate in H.
  Eigen::MatrixXd coupled_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_, product_;
  std::vector<Eigen::Index> place_;
  std::vector<double> start_;
  // Indices of pairs, points, bounded rows and ties, grouped by island.
  std::vector<int> pair_list_, point_list_, bounded_list_, tie_list_;
  std::vector<Members> members_;
  // The island being solved.
  std::size_t island_ = 0;
  std::span<const int> its_pairs_, its_points_, its_bounded_, its_ties_;
  // The function slope() computes a sum. The terms for inertia and momentum in this sum add up to:
  // start_slope_ + length * curve_.
  double start_slope_ = 0, curve_ = 0;
  // Element i describes bounded row i at the last factorization of a matrix. The element is 1 if the row's
  // impulse was between Bounded::min and Bounded::max, else 0. For calm_yields_, the matrix consists of the
  // calm blocks of the island calm_island_. For factored_yields_, the matrix is H.
  std::vector<char> calm_yields_, factored_yields_;
  std::size_t calm_island_ = kNone;
  static constexpr std::size_t kNone = ~std::size_t{0};
  // Each iteration computes a target for each friction radius. The target is proportional to the contact's
  // normal impulse. Then the radius changes by relaxation_ times the difference between the target and the
  // old radius. If relaxation_ is 1, the radius becomes equal to the target.
  double relaxation_ = 1;
  int steps_ = 0;
  double residual_ = 0;
};

}  // namespace kaz::sim
