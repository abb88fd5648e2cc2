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
#include <span>
#include <vector>

#include <Eigen/Core>

namespace kaz::sim {

class VelocitySolver {
 public:
  static constexpr double kGive = 0.1;

  // Coordinates in which a row is not zero.
  struct Segment {
    int first = 0, length = 0;
  };
  using Impulse = Eigen::Matrix<double, 6, 1>;  // normal, two tangents, two rolling, spin
  struct Point {
    double target = 0;    // m/s, of the normal velocity
    double softness = 0;  // m/s per N s, above 0
    double mu = 0;
    double give = 0;     // m/s per N s, of friction; 0: kGive of what the bodies yield
    double rolling = 0;  // m; 0: no rows for it
    Impulse before = Impulse::Zero();  // of the step before
  };
  struct Bounded {
    int coordinate = 0;
    double sign = 1;      // u = sign * v[coordinate]
    double target = 0;    // m/s or rad/s
    double softness = 0;  // per N s or N m s, above 0
    double least = 0, most = 0;
  };

  // Forgets all rows. `shared`: so many coordinates at the beginning that all others of the tree
  // may be coupled to (those of a free root).
  void begin(int coordinates, int shared);
  // The inertia, lower triangle, zeros until written: coordinate i is coupled to the shared ones if
  // `to_shared`, and to [first, i).
  void couple(int i, int first, bool to_shared);
  double* inertia_row(int i) { return inertia_.data() + at(i, 0); }

  // 3 rows, or 6 with rolling, to be written over `segments` one after the other, row by row. Valid
  // until the next call. Points whose bodies cannot move at all are to be left out.
  double* add_point(const Point& point, std::span<const Segment> segments);
  void add_bounded(const Bounded& row) { bounded_.push_back(row); }

  // After the last row, before what follows.
  void close();
  // out = M x.
  void multiply(const double* x, double* out) const;
  // v: a guess in, the velocities out. `momentum` is p above. Ends with the step that changes no
  // velocity by more than the tolerance, m/s or rad/s.
  void solve(std::span<const double> momentum, std::span<double> v, double tolerance,
             int most_steps);

  std::size_t points() const { return points_.size(); }
  const Impulse& impulse(std::size_t point) const { return points_[point].impulse; }
  // Along its rows, m/s and rad/s, after the step.
  const Impulse& velocity(std::size_t point) const { return points_[point].velocity; }
  double bounded(std::size_t row) const { return bounded_impulse_[row]; }
  int steps() const { return steps_; }
  // Largest change of a velocity in the last step, m/s or rad/s.
  double residual() const { return residual_; }

 private:
  struct Contact {
    Point point;
    std::array<Segment, 4> segments;
    int segment_count = 0, length = 0, rows = 3;
    std::size_t pool = 0;
    double give = 0, moment_give = 0;  // m/s per N s, rad/s per N m s
    double length_t = 0;               // N s, that friction may have in this step of the iteration
    Impulse velocity, change, impulse;
  };
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(j);
  }
  const double* row(const Contact& contact, int r) const {
    return pool_.data() + contact.pool + static_cast<std::size_t>(r * contact.length);
  }
  double along(const Contact& contact, int r, const double* v) const;
  void set_give(Contact& contact);
  static double roll_length(const Contact& contact);
  void impulses(const Contact& contact, const Impulse& u, Impulse& l) const;
  double bounded_impulse(const Bounded& row, double u) const;
  void gradient(std::span<const double> momentum, std::span<const double> v);
  void add_stiffness();
  double change_left() const;
  void add_contact_stiffness(const Contact& contact);
  void add_rows(const Contact& contact, int first, const Eigen::Matrix3d& d);
  void factor();
  void back_solve(double* x) const;
  double slope(double way, std::span<const double> v) const;
  double search(std::span<const double> v) const;

  int size_ = 0, shared_ = 0;
  std::vector<double> inertia_, hessian_, inverse_diagonal_;
  std::vector<int> first_;
  std::vector<char> to_shared_;
  std::vector<double> pool_;
  std::vector<Contact> points_;
  std::vector<Bounded> bounded_;
  std::vector<double> bounded_impulse_;
  std::vector<double> gradient_, change_, inertia_v_, inertia_change_;
  std::vector<double> scratch_;
  double start_slope_ = 0, curve_ = 0;  // of the inertia's part along the change
  int steps_ = 0;
  double residual_ = 0;
};

}  // namespace kaz::sim
