// Velocity-level solver: the rows, their impulses and their stiffness in the Hessian.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "sim/body/reduced/small_sums.h"
#include "sim/body/reduced/velocity_solver.h"

namespace kaz::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Factor that scales a vector of length `force` to at most `max`.
double cut(double force, double max) {
  return force > max ? max / force : 1.0;
}

// cut() of a vector with this squared length. Mostly friction sticks: then without a square root, by a margin
// above rounding.
double cut_square(double square, double max) {
  constexpr double kSurely = 1 - 1e-14;
  return square <= kSurely * (max * max) ? 1.0 : cut(std::sqrt(square), max);
}

// Matrix of the cross product: cross_of(a) b = a x b.
Matrix3d cross_of(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

int VelocitySolver::add_pair(std::span<const Segment> segments) {
  const int number = static_cast<int>(pairs_.size());
  Pair& pair = pairs_.emplace_back();
  for (const Segment& segment : segments) {
    if (segment.length == 0) continue;
    pair.segments[at(pair.segment_count++)] = segment;
    if (segment.plain == 0) pair.length += segment.length;
  }
  const auto each_block = [&](auto what) {
    for (int s = 0; s < pair.segment_count; ++s) {
      const Segment& segment = pair.segments[at(s)];
      const int end = matrix_.block_of(segment.first + segment.length - 1);
      for (int block = matrix_.block_of(segment.first); block <= end; ++block) what(block);
    }
  };
  each_block([&](int a) {
    matrix_.touch(a);
    each_block([&](int b) {
      if (a < b) matrix_.couple(a, b);
    });
  });
  pair.pool = columns_.size();
  columns_.resize(columns_.size() + at(6 * pair.length), 0.0);
  return number;
}

void VelocitySolver::add_point(const Point& point) {
  Contact& contact = points_.emplace_back();
  contact.point = point;
  contact.hardness = 1 / point.softness;
  contact.velocity.setZero();
  contact.change.setZero();
  contact.impulse.setZero();
}

// Tangential compliance of a point: its `give`, or give_share times the mobility of the bodies along each
// row, estimated as sum_k J_k^2 / M_kk (diagonal of M only; overestimates by a small factor). m/s per N s,
// rad/s per N m s.
void VelocitySolver::set_give(Contact& contact) {
  const Point& point = contact.point;
  if (point.give > 0 && point.rolling == 0) {
    contact.firmness = 1 / point.give;
    return;
  }
  const Pair& pair = pairs_[at(point.pair)];
  Impulse yields = Impulse::Zero();
  const double* column = columns_.data() + pair.pool;
  for (int s = 0; s < pair.segment_count; ++s) {
    const Segment& segment = pair.segments[at(s)];
    for (int k = 0; k < segment.length; ++k) {
      Motion motion;
      if (segment.plain != 0) {
        motion = Motion::Unit(k);
      } else {
        motion = Eigen::Map<const Motion>(column);
        column += 6;
      }
      Impulse u;
      along(contact, motion, u);
      yields += u.cwiseAbs2() / matrix_.inertia(segment.first + k);
    }
  }
  contact.firmness = 1 / (point.give > 0 ? point.give : point.give_share * std::max(yields[1], yields[2]));
  contact.moment_firm = 1 / (point.give_share * yields.tail<3>().maxCoeff());
}

// Relative motion J x of a pair about its point of reference, world axes.
VelocitySolver::Motion VelocitySolver::motion_of(const Pair& pair, const double* x) const {
  Motion motion = Motion::Zero();
  const double* column = columns_.data() + pair.pool;
  for (int s = 0; s < pair.segment_count; ++s) {
    const Segment& segment = pair.segments[at(s)];
    const double* of = x + segment.first;
    if (segment.plain != 0) {
      motion += segment.plain * Eigen::Map<const Motion>(of);
      continue;
    }
    for (int k = 0; k < segment.length; ++k, column += 6)
      motion += of[k] * Eigen::Map<const Motion>(column);
  }
  return motion;
}

// Velocities along a point's rows: B^T (v + w x arm) for the three forces, B^T w for the three moments, where
// B = (normal, tangent 1, tangent 2).
void VelocitySolver::along(const Contact& contact, const Motion& motion, Impulse& u) {
  const Matrix3d& basis = contact.point.basis;
  const Vector3d angular = motion.head<3>();
  u.head<3>() = basis.transpose() * (motion.tail<3>() + angular.cross(contact.point.arm));
  if (contact.point.rolling == 0) {
    u.tail<3>().setZero();
    return;
  }
  u[3] = basis.col(1).dot(angular);
  u[4] = basis.col(2).dot(angular);
  u[5] = basis.col(0).dot(angular);
}

// Friction radii mu l_n and rolling l_n, under-relaxed.
void VelocitySolver::set_lengths(Contact& contact, double relaxation) {
  const double normal =
      std::max(0.0, (contact.point.target - contact.velocity[0]) * contact.hardness);
  contact.length_t += relaxation * (contact.point.mu * normal - contact.length_t);
  contact.length_r += relaxation * (contact.point.rolling * normal - contact.length_r);
}

// Impulses from the velocities along the rows, for fixed friction radii:
// l_n = max(0, (target - u_n) / softness), l_t = project(l_t before - u_t / give, radius).
// Number by number: a vector that is written in parts of one width and read in others waits for memory.
void VelocitySolver::impulses(const Contact& contact, const Impulse& u, Impulse& l) {
  const Point& point = contact.point;
  const double *const v = u.data(), *const before = point.before.data();
  double* const to = l.data();
  to[0] = std::max(0.0, (point.target - v[0]) * contact.hardness);
  const double t1 = before[1] - v[1] * contact.firmness, t2 = before[2] - v[2] * contact.firmness;
  const double friction = cut_square(t1 * t1 + t2 * t2, contact.length_t);
  to[1] = t1 * friction;
  to[2] = t2 * friction;
  if (point.rolling == 0) {
    to[3] = to[4] = to[5] = 0;
    return;
  }
  const double r1 = before[3] - v[3] * contact.moment_firm,
               r2 = before[4] - v[4] * contact.moment_firm,
               spin = before[5] - v[5] * contact.moment_firm;
  const double rolling = cut_square(r1 * r1 + r2 * r2, contact.length_r);
  to[3] = r1 * rolling;
  to[4] = r2 * rolling;
  to[5] = spin * cut(std::abs(spin), contact.length_r);
}

// Impulses at `length` of the present change, times that change.
double VelocitySolver::work_along(const Contact& contact, double length) {
  const double *const u = contact.velocity.data(), *const change = contact.change.data();
  Impulse at, moved;
  const int rows = contact.point.rolling == 0 ? 3 : 6;
  for (int i = 0; i < rows; ++i) at[i] = u[i] + length * change[i];
  impulses(contact, at, moved);
  if (!(moved[0] > 0)) return 0;
  const double even =
      rows == 3 ? moved[2] * change[2] : moved[2] * change[2] + moved[4] * change[4];
  const double odd = rows == 3 ? 0 : moved[3] * change[3] + moved[5] * change[5];
  return (moved[0] * change[0] + even) + (moved[1] * change[1] + odd);
}

// Active set of a point: separated, slipping or sticking; likewise for rolling and spinning.
std::uint8_t VelocitySolver::pattern_of(const Contact& contact) {
  const Impulse& l = contact.impulse;
  if (l[0] <= 0) return 0;
  // Equal to the radius up to rounding; a pattern is only compared with another one of the same point.
  constexpr double kCut = 1 - 1e-12;
  const auto sticks = [](double force, double max) { return force < kCut * max ? 1 : 0; };
  const auto norm = [&](int i) { return std::sqrt(l[i] * l[i] + l[i + 1] * l[i + 1]); };
  int pattern = 1 + 2 * sticks(norm(1), contact.length_t);
  if (contact.point.rolling > 0) {
    pattern += 4 * sticks(norm(3), contact.length_r) + 8 * sticks(std::abs(l[5]), contact.length_r);
  }
  return static_cast<std::uint8_t>(pattern);
}

// Wrench of a point's impulses on body a about the pair's point of reference.
void VelocitySolver::add_wrench(const Contact& contact, Motion& wrench) {
  const Impulse& l = contact.impulse;
  const Vector3d force = contact.point.basis * l.head<3>();
  wrench.head<3>() += contact.point.arm.cross(force);
  wrench.tail<3>() += force;
  if (contact.point.rolling > 0)
    wrench.head<3>() += contact.point.basis * Vector3d(l[5], l[3], l[4]);
}

// g -= J^T wrench.
void VelocitySolver::take_wrench(const Pair& pair) {
  const double* column = columns_.data() + pair.pool;
  for (int s = 0; s < pair.segment_count; ++s) {
    const Segment& segment = pair.segments[at(s)];
    double* of = gradient_.data() + segment.first;
    if (segment.plain != 0) {
      Eigen::Map<Motion>{of} -= segment.plain * pair.wrench;
      continue;
    }
    for (int k = 0; k < segment.length; ++k, column += 6)
      of[k] -= dot_six(column, pair.wrench.data());
  }
}

// Adds J^T D J of a point, 6 x 6 about the pair's point of reference, where D = -dl/du: 1 / softness along
// the normal, 1 / give in both tangents while sticking. While slipping only the component across the slip
// direction t remains: mu l_n / |f| / give (I - t t^T), f the unprojected friction.
void VelocitySolver::add_point_stiffness(const Contact& contact, Stiffness& k) {
  const Matrix3d& basis = contact.point.basis;
  // D of two components along the columns a and b of the basis that are projected onto a disc.
  const auto plane = [&](int first, int a, int b, double firmness, double max, Matrix3d& d) {
    const Eigen::Vector2d free =
        contact.point.before.segment<2>(first) - contact.velocity.segment<2>(first) * firmness;
    const double force = free.norm();
    if (force <= max) {
      d += firmness *
           (basis.col(a) * basis.col(a).transpose() + basis.col(b) * basis.col(b).transpose());
      return;
    }
    const Vector3d across = (free[0] * basis.col(b) - free[1] * basis.col(a)) / force;
    d += max / force * firmness * across * across.transpose();
  };
  Matrix3d d = contact.hardness * basis.col(0) * basis.col(0).transpose();
  plane(1, 1, 2, contact.firmness, contact.length_t, d);
  const Matrix3d arm = cross_of(contact.point.arm);
  const Matrix3d turned = arm * d;
  k.bottomRightCorner<3, 3>() += d;
  k.topRightCorner<3, 3>() += turned;
  k.bottomLeftCorner<3, 3>() += turned.transpose();
  k.topLeftCorner<3, 3>() -= turned * arm;
  if (contact.point.rolling == 0) return;
  Matrix3d r = Matrix3d::Zero();
  plane(3, 1, 2, contact.moment_firm, contact.length_r, r);
  if (std::abs(contact.point.before[5] - contact.velocity[5] * contact.moment_firm) <=
      contact.length_r)
    r += contact.moment_firm * basis.col(0) * basis.col(0).transpose();
  k.topLeftCorner<3, 3>() += r;
}

// H += J^T K J for a pair with the 6 x 6 stiffness K; lower triangle only.
void VelocitySolver::add_pair_rows(const Pair& pair) {
  const double* columns = columns_.data() + pair.pool;
  scratch_.resize(at(6 * pair.length));  // stiffness times columns
  for (int i = 0; i < pair.length; ++i)
    Eigen::Map<Motion>(scratch_.data() + 6 * i) =
        pair.stiffness * Eigen::Map<const Motion>(columns + 6 * i);
  int of_s = 0;
  for (int s = 0; s < pair.segment_count; ++s) {
    const Segment& segment = pair.segments[at(s)];
    for (int k = 0; k < segment.length; ++k) {
      double* to = matrix_.row_of(segment.first + k);
      int of_t = 0;
      for (int t = 0; t <= s; ++t) {
        const Segment& other = pair.segments[at(t)];
        double* out = to + other.first;
        if (other.plain != 0) {
          const double* from =
              segment.plain != 0 ? pair.stiffness.data() + 6 * k : scratch_.data() + 6 * (of_s + k);
          const double sign = other.plain * (segment.plain != 0 ? segment.plain : 1);
          for (int j = 0; j < 6; ++j) out[j] += sign * from[j];
          continue;
        }
        const int end = t == s ? k + 1 : other.length;
        for (int j = 0; j < end; ++j) {
          const double* column = scratch_.data() + 6 * (of_t + j);
          out[j] += segment.plain != 0 ? segment.plain * column[k]
                                       : dot_six(columns + 6 * (of_s + k), column);
        }
        of_t += other.length;
      }
    }
    if (segment.plain == 0) of_s += segment.length;
  }
}

bool VelocitySolver::yields(int bounded) const {
  const Bounded& row = bounded_[at(bounded)];
  const double impulse = bounded_impulse_[at(bounded)];
  return impulse > row.min && impulse < row.max;
}

// Whether the active set differs from that when H was factored.
bool VelocitySolver::pattern_changed() const {
  return std::ranges::any_of(its_points_,
                             [this](int i) {
                               const Contact& contact = points_[at(i)];
                               return contact.pattern != contact.factored;
                             }) ||
         std::ranges::any_of(
             its_bounded_, [this](int i) { return yields(i) != (factored_yields_[at(i)] != 0); }) ||
         std::ranges::any_of(
             its_ties_, [this](int i) { return yields(ties_[at(i)]) != ties_[at(i)].factored; });
}

// Whether calm blocks need a new factorisation. Updates their record of active rows.
bool VelocitySolver::calm_rows_changed() {
  bool changed = calm_island_ != island_;
  calm_island_ = island_;
  for (const int i : its_bounded_) {
    if (!matrix_.calm(matrix_.block_of(bounded_[at(i)].coordinate))) continue;
    const char now = yields(i) ? 1 : 0;
    changed = changed || now != calm_yields_[at(i)];
    calm_yields_[at(i)] = now;
  }
  return changed;
}

// Assembles H = M + J^T D J of the island; calm blocks are factored or reused.
void VelocitySolver::add_stiffness() {
  const BlockMatrix::Island& island = matrix_.islands()[island_];
  const auto add_bounded = [this](bool calm) {
    for (const int i : its_bounded_) {
      const Bounded& row = bounded_[at(i)];
      if (matrix_.calm(matrix_.block_of(row.coordinate)) != calm || !yields(i)) continue;
      matrix_.row_of(row.coordinate)[row.coordinate] += 1 / row.softness;
    }
  };
  const bool keep = island.calm && !calm_rows_changed();
  matrix_.load(island, keep);
  if (island.calm && !keep) {
    add_bounded(true);
    matrix_.factor_calm(island);
  }
  add_bounded(false);
  for (const int i : its_pairs_) pairs_[at(i)].stiffness.setZero();
  for (const int i : its_bounded_) factored_yields_[at(i)] = yields(i) ? 1 : 0;
  for (const int i : its_points_) {
    Contact& contact = points_[at(i)];
    contact.factored = contact.pattern;
    if (contact.impulse[0] > 0)
      add_point_stiffness(contact, pairs_[at(contact.point.pair)].stiffness);
  }
  for (const int i : its_pairs_) add_pair_rows(pairs_[at(i)]);
  add_tie_stiffness();
}

}  // namespace kaz::sim
