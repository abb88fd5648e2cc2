// Velocity-level solver: Newton's method on friction and normal forces together.
// SPDX-License-Identifier: Apache-2.0
//
// The iteration of velocity_solver.cpp holds the friction radii mu l_n fixed in each Newton step. Where
// friction feeds the normal force that bounds it (a ball that slips between two fingers), the radii
// converge slowly or not at all. Here they are part of the function whose zero is sought:
//
//   F(v) = M v - p - sum J^T l(J v)
//   l_t = projection of (l_t before - u_t / give) onto the disc mu l_n(u_n)
//
// F is piecewise smooth. Its derivative H is not symmetric, since friction that slips along t depends on
// the normal velocity: -dl_t/du_n = mu / softness t. Each iteration solves H d = -F and halves d until sum
// F_k^2 / M_kk falls (semismooth Newton with a line search on a merit function: F. Facchinei & J.-S. Pang,
// "Finite-Dimensional Variational Inequalities and Complementarity Problems", 2003, chapter 8). Dense: a
// step in twenty needs it, and two or three iterations are enough.
//
// The merit function may have a local minimum that is no zero, where many contacts change between sticking,
// slipping and open: then friction_path.cpp.
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "sim/body/reduced/velocity_solver.h"

namespace kaz::sim {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSteps = 24, kHalvings = 24;
// Share of the decrease that the derivative promises, which a shortened step must reach (Armijo).
constexpr double kMinDecrease = 1e-4;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Slopes of l = projection of f = before - u / give onto a disc, both of two components.
struct DiscSlopes {
  Matrix2d of_velocity = Matrix2d::Zero();  // -dl/du
  Vector2d of_radius = Vector2d::Zero();    // dl / d radius
};

DiscSlopes disc_slopes(const Vector2d& f, double firmness, double radius) {
  DiscSlopes slopes;
  const double force = f.norm();
  if (force <= radius) {
    slopes.of_velocity = firmness * Matrix2d::Identity();
    return slopes;
  }
  const Vector2d along = f / force;
  slopes.of_velocity =
      firmness * radius / force * (Matrix2d::Identity() - along * along.transpose());
  slopes.of_radius = along;
  return slopes;
}

}  // namespace

// Adds -d wrench / d motion of a point, 6 x 6 about the pair's point of reference, not symmetric; wrench
// and motion as in add_wrench() and along().
void VelocitySolver::add_coupled_stiffness(const Contact& contact, Stiffness& k) {
  const Point& point = contact.point;
  // u = s motion, wrench += s^T l, for normal and tangents.
  Eigen::Matrix<double, 3, 6> s;
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = point.basis.col(i);
    s.row(i) << point.arm.cross(axis).transpose(), axis.transpose();
  }
  const DiscSlopes slip =
      disc_slopes(point.before.segment<2>(1) - contact.velocity.segment<2>(1) * contact.firmness,
                  contact.firmness, contact.length_t);
  Matrix3d d = Matrix3d::Zero();
  d(0, 0) = contact.hardness;
  d.bottomLeftCorner<2, 1>() = point.mu * contact.hardness * slip.of_radius;
  d.bottomRightCorner<2, 2>() = slip.of_velocity;
  k += s.transpose() * d * s;
  if (point.rolling == 0) return;
  // Moments about the tangents (rolling) and the normal (spinning).
  Matrix3d axes;
  axes << point.basis.col(1).transpose(), point.basis.col(2).transpose(),
      point.basis.col(0).transpose();
  const Vector3d f = point.before.tail<3>() - contact.velocity.tail<3>() * contact.moment_firm;
  const DiscSlopes roll = disc_slopes(f.head<2>(), contact.moment_firm, contact.length_r);
  const bool spins = std::abs(f[2]) > contact.length_r;
  Matrix3d r = Matrix3d::Zero();
  r.topLeftCorner<2, 2>() = roll.of_velocity;
  r(2, 2) = spins ? 0 : contact.moment_firm;
  const Vector3d of_radius(roll.of_radius[0], roll.of_radius[1],
                           spins ? std::copysign(1.0, f[2]) : 0.0);
  k.topLeftCorner<3, 3>() += axes.transpose() * r * axes;
  k.topRows<3>() += axes.transpose() * of_radius * (point.rolling * contact.hardness) * s.row(0);
}

// H = M + J^T D J of the island in the order of `coordinates`, which ascend.
void VelocitySolver::assemble_coupled(std::span<const int> coordinates) {
  const auto n = static_cast<Index>(coordinates.size());
  place_.resize(at(matrix_.size()));
  for (Index k = 0; k < n; ++k) place_[at(coordinates[at(k)])] = k;
  coupled_.setZero(n, n);
  matrix_.for_each_inertia(matrix_.islands()[island_], [&](int i, int j, double m) {
    coupled_(place_[at(i)], place_[at(j)]) = coupled_(place_[at(j)], place_[at(i)]) = m;
  });
  for (const int i : its_pairs_) pairs_[at(i)].stiffness.setZero();
  for (const int i : its_points_) {
    const Contact& contact = points_[at(i)];
    if (contact.impulse[0] > 0)
      add_coupled_stiffness(contact, pairs_[at(contact.point.pair)].stiffness);
  }
  for (const int i : its_pairs_) {
    const Pair& pair = pairs_[at(i)];
    const double* column = columns_.data() + pair.pool;
    jacobian_.setZero(6, n);
    for (int s = 0; s < pair.segment_count; ++s) {
      const Segment& segment = pair.segments[at(s)];
      for (int k = 0; k < segment.length; ++k) {
        auto to = jacobian_.col(place_[at(segment.first + k)]);
        if (segment.plain != 0) {
          to = segment.plain * Motion::Unit(k);
          continue;
        }
        to = Eigen::Map<const Motion>(column);
        column += 6;
      }
    }
    product_.noalias() = pair.stiffness.lazyProduct(jacobian_);
    coupled_.noalias() += jacobian_.transpose() * product_;
  }
  for (const int i : its_bounded_) {
    if (!yields(i)) continue;
    const Index k = place_[at(bounded_[at(i)].coordinate)];
    coupled_(k, k) += 1 / bounded_[at(i)].softness;
  }
  add_coupled_ties();
}

// Merit function, J: sum F_k^2 / M_kk.
double VelocitySolver::merit() const {
  double sum = 0;
  for_each_coordinate([&](std::size_t k) {
    sum += gradient_[k] * gradient_[k] / matrix_.inertia(static_cast<int>(k));
  });
  return sum;
}

int VelocitySolver::solve_coupled(std::span<const double> momentum, std::span<double> v,
                                  double tolerance, double& left) {
  const BlockMatrix::Island& island = matrix_.islands()[island_];
  std::vector<int> coordinates;
  for_each_coordinate([&](std::size_t k) { coordinates.push_back(static_cast<int>(k)); });
  const auto n = static_cast<Index>(coordinates.size());
  Eigen::VectorXd f(n), d(n), start(n);
  // With relaxation 1 gradient() takes the radii from the present normal forces: it is F.
  relaxation_ = 1;
  const auto evaluate = [&] {
    matrix_.multiply(island, v.data(), inertia_v_.data());
    gradient(momentum, v);
    return merit();
  };
  double before = evaluate();
  for (int step = 1; step <= kSteps; ++step) {
    assemble_coupled(coordinates);
    for (Index k = 0; k < n; ++k) {
      f[k] = gradient_[at(coordinates[at(k)])];
      start[k] = v[at(coordinates[at(k)])];
    }
    d = -coupled_.partialPivLu().solve(f);
    left = d.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(left)) return step;
    double length = 1, now = 0;
    for (int i = 0; i <= kHalvings; ++i, length /= 2) {
      for (Index k = 0; k < n; ++k) v[at(coordinates[at(k)])] = start[k] + length * d[k];
      now = evaluate();
      // The merit function's derivative along d is -2 of its value.
      if (left <= tolerance || now <= (1 - 2 * kMinDecrease * length) * before) break;
    }
    if (left <= tolerance) return step;
    before = now;
  }
  return kSteps;
}

}  // namespace kaz::sim
