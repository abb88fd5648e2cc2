// Velocity-level solver: the path of solutions from no friction to all of it.
// SPDX-License-Identifier: Apache-2.0
//
// With friction coefficients t mu and rolling resistances t rho the solutions of
//
//   F(v, t) = 0      (F: coupled_newton.cpp)
//
// are curves in the space of (v, t). At t = 0 there is one solution, the minimum of a convex function; the
// curve that begins there is followed until t = 1. It may turn back in t (a grasp that with more friction
// jams in another way), so t is an unknown like v, and the curve's parameter is its length: pseudo-arclength
// continuation (H. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", 1977; E.
// Allgower & K. Georg, "Introduction to Numerical Continuation Methods", 1990, chapters 2 and 6). On each
// piece of F the direction along the curve is
//
//   (v', t') = sign(det H) (-H^-1 dF/dt, 1) / |...|        H = dF/dv, not symmetric
//
// The determinant's sign, positive at t = 0, says which way is ahead, also across the edges between pieces,
// at which the direction jumps (B. Eaves & H. Scarf, "The solution of systems of piecewise linear
// equations", Mathematics of Operations Research 1(1), 1976).
#include <algorithm>
#include <array>
#include <limits>

#include <Eigen/LU>

#include "sim/body/reduced/velocity_solver.h"

namespace kaz::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Lengths along the curve, of (v, t) in m/s, rad/s and 1: of the first step, the longest, the shortest, and
// of that behind an edge.
constexpr double kFirst = 0.05, kLongest = 0.5, kShortest = 1e-7, kBehindEdge = 1e-4;
constexpr double kOnTheWay = 1e-7;    // exactness of v, m/s or rad/s
constexpr double kAtEnd = 1e-9;       // of t
constexpr double kDifference = 1e-6;  // of t, for dF/dt
constexpr int kAtStart = 100;         // Newton steps for the convex function; a dozen are usual
constexpr int kCorrections = 8;       // Newton steps back to the curve
constexpr int kMaxSteps = 1000;       // Newton steps in all

}  // namespace

// (v, t) of an island, and what depends on it. Values divided by M_kk, so of velocities.
class VelocitySolver::FrictionPath {
 public:
  FrictionPath(VelocitySolver& solver, std::span<const double> momentum, std::span<double> v)
      : solver_(solver), momentum_(momentum), v_(v) {
    solver_.for_each_coordinate(
        [&](std::size_t k) { coordinates_.push_back(static_cast<int>(k)); });
    n_ = static_cast<Index>(coordinates_.size());
    for (const int i : solver_.its_points_) {
      const Point& point = solver_.points_[at(i)].point;
      whole_.push_back({point.mu, point.rolling});
    }
    slopes_.resize(n_, n_ + 1);
  }
  ~FrictionPath() { set_friction(1); }
  FrictionPath(const FrictionPath&) = delete;
  FrictionPath& operator=(const FrictionPath&) = delete;

  // On failure `left` is infinite, since v is then the solution for less friction.
  int follow(double tolerance, double& left) {
    set_friction(0);
    int steps = solver_.iterate(momentum_, v_, kOnTheWay, kAtStart, 1, left);
    VectorXd z = place(0);
    differentiate(z, evaluate(z));
    VectorXd along = direction();
    double length = kFirst;
    while (steps < kMaxSteps) {
      VectorXd there = z + length * along;
      if (!correct(there, along, length, steps)) {
        length /= 4;
        if (length >= kShortest) continue;
        // An edge at which the curve turns sharply: on in the direction of the piece beyond it.
        const VectorXd beyond = z + 10 * kShortest * along;
        differentiate(beyond, evaluate(beyond));
        along = direction();
        length = kBehindEdge;
        ++steps;
        continue;
      }
      if (there[n_] > 1 + kAtEnd) {  // a shorter step, until one ends at 1
        length *= std::clamp((1 - z[n_]) / (there[n_] - z[n_]), 0.1, 0.9);
        if (length >= kShortest) continue;
      }
      if (there[n_] >= 1 - kAtEnd) {
        set_friction(1);
        set_velocity(there);
        return steps + solver_.solve_coupled(momentum_, v_, tolerance, left);
      }
      z = there;
      differentiate(z, evaluate(z));
      along = direction();
      length = std::min(kLongest, 2 * length);
    }
    left = std::numeric_limits<double>::infinity();
    return steps;
  }

 private:
  void set_friction(double t) {
    std::size_t k = 0;
    for (const int i : solver_.its_points_) {
      Point& point = solver_.points_[at(i)].point;
      point.mu = t * whole_[k][0];
      // Not 0, which means a point without moments.
      point.rolling = whole_[k][1] > 0 ? std::max(t, 1e-12) * whole_[k][1] : 0;
      ++k;
    }
  }
  VectorXd place(double t) const {
    VectorXd z(n_ + 1);
    for (Index k = 0; k < n_; ++k) z[k] = v_[at(coordinates_[at(k)])];
    z[n_] = t;
    return z;
  }
  void set_velocity(const VectorXd& z) {
    for (Index k = 0; k < n_; ++k) v_[at(coordinates_[at(k)])] = z[k];
  }

  // F at z; the solver's rows are then those of z.
  VectorXd evaluate(const VectorXd& z) {
    set_friction(std::max(z[n_], 0.0));
    set_velocity(z);
    solver_.relaxation_ = 1;
    solver_.matrix_.multiply(solver_.matrix_.islands()[solver_.island_], v_.data(),
                             solver_.inertia_v_.data());
    solver_.gradient(momentum_, v_);
    VectorXd f(n_);
    for (Index k = 0; k < n_; ++k) f[k] = solver_.gradient_[at(coordinates_[at(k)])] / inertia(k);
    return f;
  }
  // slopes_ = [dF/dv, dF/dt] at z, where F is `f` and the rows are those of z.
  void differentiate(const VectorXd& z, const VectorXd& f) {
    solver_.assemble_coupled(coordinates_);
    for (Index k = 0; k < n_; ++k) slopes_.row(k).head(n_) = solver_.coupled_.row(k) / inertia(k);
    VectorXd further = z;
    further[n_] += kDifference;
    slopes_.col(n_) = (evaluate(further) - f) / kDifference;
  }
  // By slopes_, of length 1.
  VectorXd direction() const {
    const Eigen::PartialPivLU<MatrixXd> lu(slopes_.leftCols(n_));
    double sign = static_cast<double>(lu.permutationP().determinant());
    for (Index k = 0; k < n_; ++k) sign *= lu.matrixLU()(k, k) < 0 ? -1 : 1;
    VectorXd along(n_ + 1);
    along.head(n_) = -lu.solve(slopes_.col(n_));
    along[n_] = 1;
    return along * (sign / along.norm());
  }
  // Newton's method from z back to the curve, in the plane through z across `along`. False: it leaves the
  // neighbourhood of z, or does not converge.
  bool correct(VectorXd& z, const VectorXd& along, double length, int& steps) {
    const VectorXd ahead = z;
    MatrixXd all(n_ + 1, n_ + 1);
    VectorXd rest(n_ + 1);
    for (int i = 0; i < kCorrections; ++i) {
      ++steps;
      const VectorXd f = evaluate(z);
      differentiate(z, f);
      all << slopes_, along.transpose();
      rest << f, along.dot(z - ahead);
      const VectorXd change = all.partialPivLu().solve(rest);
      z -= change;
      if (!((z - ahead).norm() <= length)) return false;
      if (change.lpNorm<Eigen::Infinity>() < kOnTheWay) return true;
    }
    return false;
  }
  double inertia(Index k) const { return solver_.matrix_.inertia(coordinates_[at(k)]); }

  VelocitySolver& solver_;
  std::span<const double> momentum_;
  std::span<double> v_;
  std::vector<int> coordinates_;
  Index n_ = 0;
  std::vector<std::array<double, 2>> whole_;  // of each point: mu, rolling
  MatrixXd slopes_;
};

int VelocitySolver::solve_along_path(std::span<const double> momentum, std::span<double> v,
                                     double tolerance, double& left) {
  return FrictionPath(*this, momentum, v).follow(tolerance, left);
}

}  // namespace kaz::sim
