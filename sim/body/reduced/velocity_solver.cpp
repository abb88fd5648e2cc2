// Velocities after a step: inertia, motors, stops and contacts with Coulomb friction in one solve.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/velocity_solver.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

// The line search ends where the slope has fallen to this share.
constexpr double kSlopeShare = 1e-3;
constexpr int kSearchSteps = 40;
// What each coordinate by itself would still change may be less than what all of them do.
constexpr double kSafety = 0.05;

// Two sums side by side, for machines with two doubles in a register.
double dot(const double* a, const double* b, int n) {
  double even = 0, odd = 0;
  int i = 0;
  for (; i + 1 < n; i += 2) {
    even += a[i] * b[i];
    odd += a[i + 1] * b[i + 1];
  }
  if (i < n) even += a[i] * b[i];
  return even + odd;
}

void add(double by, const double* __restrict from, double* __restrict to, int n) {
  for (int i = 0; i < n; ++i) to[i] += by * from[i];
}

// The coordinates of a free root are so many that the compiler had better know how many.
void add_shared(double by, const double* __restrict from, double* __restrict to, int n) {
  if (n != 6) return add(by, from, to, n);
  for (int i = 0; i < 6; ++i) to[i] += by * from[i];
}

void add_three(double a, double b, double c, const double* __restrict u, const double* __restrict v,
               const double* __restrict w, double* __restrict to, int n) {
  if (n == 6) {
    for (int i = 0; i < 6; ++i) to[i] += a * u[i] + b * v[i] + c * w[i];
    return;
  }
  for (int i = 0; i < n; ++i) to[i] += a * u[i] + b * v[i] + c * w[i];
}

double dot_shared(const double* a, const double* b, int n) {
  if (n != 6) return dot(a, b, n);
  return (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5]);
}

}  // namespace

void VelocitySolver::begin(int coordinates, int shared) {
  const bool same = coordinates == size_;
  size_ = coordinates;
  shared_ = shared;
  const auto size = static_cast<std::size_t>(size_);
  if (!same) {
    inertia_.assign(size * size, 0);
    hessian_.assign(size * size, 0);
    for (auto* v : {&inverse_diagonal_, &gradient_, &change_, &inertia_v_, &inertia_change_})
      v->assign(size, 0);
  }
  first_.resize(size);
  for (int i = 0; i < size_; ++i) first_[static_cast<std::size_t>(i)] = i;
  to_shared_.assign(size, 0);
  for (int i = 0; i < shared; ++i) first_[static_cast<std::size_t>(i)] = 0;
  pool_.clear();
  points_.clear();
  bounded_.clear();
}

void VelocitySolver::couple(int i, int first, bool to_shared) {
  int& own = first_[static_cast<std::size_t>(i)];
  own = std::min(own, first);
  if (to_shared) to_shared_[static_cast<std::size_t>(i)] = 1;
}

double* VelocitySolver::add_point(const Point& point, std::span<const Segment> segments) {
  Contact& contact = points_.emplace_back();
  contact.point = point;
  contact.rows = point.rolling > 0 ? 6 : 3;
  int lowest = size_;
  bool shared = false;
  for (const Segment& segment : segments) {
    if (segment.length == 0) continue;
    contact.segments[static_cast<std::size_t>(contact.segment_count++)] = segment;
    contact.length += segment.length;
    if (segment.first < shared_) {
      shared = true;
    } else {
      lowest = std::min(lowest, segment.first);
    }
  }
  for (const Segment& segment : segments) {
    for (int i = std::max(segment.first, shared_); i < segment.first + segment.length; ++i)
      couple(i, std::min(i, lowest), shared);
  }
  contact.pool = pool_.size();
  contact.velocity.setZero();
  contact.change.setZero();
  contact.impulse.setZero();
  pool_.resize(pool_.size() + static_cast<std::size_t>(contact.rows * contact.length), 0.0);
  return pool_.data() + contact.pool;
}

double VelocitySolver::along(const Contact& contact, int r, const double* v) const {
  const double* j = row(contact, r);
  double sum = 0;
  for (int s = 0; s < contact.segment_count; ++s) {
    const Segment& segment = contact.segments[static_cast<std::size_t>(s)];
    sum += dot(j, v + segment.first, segment.length);
    j += segment.length;
  }
  return sum;
}

// What an impulse along a row does to its velocity, with each coordinate by itself: more than with all
// of them, by a small factor.
void VelocitySolver::set_give(Contact& contact) {
  const auto yields = [&](int r) {
    const double* j = row(contact, r);
    double sum = 0;
    for (int s = 0; s < contact.segment_count; ++s) {
      const Segment& segment = contact.segments[static_cast<std::size_t>(s)];
      for (int i = segment.first; i < segment.first + segment.length; ++i, ++j)
        sum += *j * *j / inertia_[at(i, i)];
    }
    return sum;
  };
  contact.give =
      contact.point.give > 0 ? contact.point.give : kGive * std::max(yields(1), yields(2));
  if (contact.rows == 6) contact.moment_give = kGive * std::max({yields(3), yields(4), yields(5)});
}

// Eliminating i couples all that i is coupled to.
void VelocitySolver::close() {
  for (Contact& contact : points_) set_give(contact);
  for (int i = size_ - 1; i >= shared_; --i) {
    const int first = first_[static_cast<std::size_t>(i)];
    for (int j = i - 1; j >= std::max(first, shared_); --j)
      couple(j, first, to_shared_[static_cast<std::size_t>(i)] != 0);
  }
}

void VelocitySolver::multiply(const double* x, double* out) const {
  std::fill_n(out, size_, 0.0);
  for (int i = 0; i < size_; ++i) {
    const double* m = inertia_.data() + at(i, 0);
    const int first = first_[static_cast<std::size_t>(i)];
    double sum = m[i] * x[i];
    if (i >= shared_ && to_shared_[static_cast<std::size_t>(i)] != 0) {
      sum += dot_shared(m, x, shared_);
      add_shared(x[i], m, out, shared_);
    }
    sum += dot(m + first, x + first, i - first);
    add(x[i], m + first, out + first, i - first);
    out[i] += sum;
  }
}

// N m s, that a moment of rolling or spinning may have.
double VelocitySolver::roll_length(const Contact& contact) {
  return contact.point.rolling *
         std::max(0.0, (contact.point.target - contact.velocity[0]) / contact.point.softness);
}

// From the velocities along the rows, with the length of friction as it is.
void VelocitySolver::impulses(const Contact& contact, const Impulse& u, Impulse& l) const {
  const Point& point = contact.point;
  l[0] = std::max(0.0, (point.target - u[0]) / point.softness);
  const auto cut = [](double force, double most) { return force > most ? most / force : 1.0; };
  l.segment<2>(1) = point.before.segment<2>(1) - u.segment<2>(1) / contact.give;
  l.segment<2>(1) *= cut(l.segment<2>(1).norm(), contact.length_t);
  if (contact.rows == 3) return;
  const double most = roll_length(contact);
  l.tail<3>() = point.before.tail<3>() - u.tail<3>() / contact.moment_give;
  l.segment<2>(3) *= cut(l.segment<2>(3).norm(), most);
  l[5] *= cut(std::abs(l[5]), most);
}

double VelocitySolver::bounded_impulse(const Bounded& row, double u) const {
  return std::clamp((row.target - u) / row.softness, row.least, row.most);
}

// M v - p - J^T l, with the lengths of friction set anew.
void VelocitySolver::gradient(std::span<const double> momentum, std::span<const double> v) {
  for (int i = 0; i < size_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    gradient_[k] = inertia_v_[k] - momentum[k];
  }
  for (Contact& contact : points_) {
    for (int r = 0; r < contact.rows; ++r) contact.velocity[r] = along(contact, r, v.data());
    const Point& point = contact.point;
    contact.length_t =
        point.mu * std::max(0.0, (point.target - contact.velocity[0]) / point.softness);
    impulses(contact, contact.velocity, contact.impulse);
    if (contact.impulse[0] == 0) continue;
    for (int r = 0; r < contact.rows; ++r) {
      const double* j = row(contact, r);
      for (int s = 0; s < contact.segment_count; ++s) {
        const Segment& segment = contact.segments[static_cast<std::size_t>(s)];
        add(-contact.impulse[r], j, gradient_.data() + segment.first, segment.length);
        j += segment.length;
      }
    }
  }
  bounded_impulse_.resize(bounded_.size());
  for (std::size_t i = 0; i < bounded_.size(); ++i) {
    const Bounded& bounded = bounded_[i];
    const auto c = static_cast<std::size_t>(bounded.coordinate);
    bounded_impulse_[i] = bounded_impulse(bounded, bounded.sign * v[c]);
    gradient_[c] -= bounded.sign * bounded_impulse_[i];
  }
}

// About the change that the gradient asks for, m/s or rad/s: each coordinate by itself.
double VelocitySolver::change_left() const {
  double largest = 0;
  for (int i = 0; i < size_; ++i)
    largest =
        std::max(largest, std::abs(gradient_[static_cast<std::size_t>(i)]) / inertia_[at(i, i)]);
  return largest;
}

// J^T D J, D the negative derivative of the impulses.
void VelocitySolver::add_contact_stiffness(const Contact& contact) {
  if (contact.impulse[0] == 0) return;
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  d(0, 0) = 1 / contact.point.softness;
  const auto friction = [&d, &contact](int first, int count, double give, double most) {
    const Impulse free = contact.point.before - contact.velocity / give;
    const double force = free.segment(first, count).norm();
    if (force <= most) {
      for (int k = 0; k < count; ++k) d(first + k, first + k) = 1 / give;
      return;
    }
    if (count == 1) return;
    const Eigen::Vector2d way = free.segment<2>(first) / force;
    d.block<2, 2>(first, first) =
        most / (force * give) * (Eigen::Matrix2d::Identity() - way * way.transpose());
  };
  friction(1, 2, contact.give, contact.length_t);
  if (contact.rows == 6) {
    const double most = roll_length(contact);
    friction(3, 2, contact.moment_give, most);
    friction(5, 1, contact.moment_give, most);
  }
  add_rows(contact, 0, d.topLeftCorner<3, 3>());
  if (contact.rows == 6) add_rows(contact, 3, d.bottomRightCorner<3, 3>());
}

// J^T D J of three rows. Rows of the result are written as far as the segment goes: what stands above
// the diagonal is never read.
void VelocitySolver::add_rows(const Contact& contact, int first, const Eigen::Matrix3d& d) {
  const double *a = row(contact, first), *b = row(contact, first + 1), *c = row(contact, first + 2);
  const int length = contact.length;
  scratch_.resize(static_cast<std::size_t>(3 * length));
  double *u = scratch_.data(), *v = u + length, *w = v + length;
  for (int i = 0; i < length; ++i) {
    u[i] = d(0, 0) * a[i] + d(0, 1) * b[i] + d(0, 2) * c[i];
    v[i] = d(1, 0) * a[i] + d(1, 1) * b[i] + d(1, 2) * c[i];
    w[i] = d(2, 0) * a[i] + d(2, 1) * b[i] + d(2, 2) * c[i];
  }
  int k = 0;
  for (int s = 0; s < contact.segment_count; ++s) {
    const Segment& segment = contact.segments[static_cast<std::size_t>(s)];
    for (int i = segment.first; i < segment.first + segment.length; ++i, ++k) {
      int from = 0;
      for (int t = 0; t <= s; ++t) {
        const Segment& other = contact.segments[static_cast<std::size_t>(t)];
        add_three(a[k], b[k], c[k], u + from, v + from, w + from,
                  hessian_.data() + at(i, other.first), other.length);
        from += other.length;
      }
    }
  }
}

void VelocitySolver::add_stiffness() {
  for (int i = 0; i < size_; ++i) {
    const double* from = inertia_.data() + at(i, 0);
    double* to = hessian_.data() + at(i, 0);
    const int first = first_[static_cast<std::size_t>(i)];
    if (to_shared_[static_cast<std::size_t>(i)] != 0) std::copy_n(from, shared_, to);
    std::copy(from + first, from + i + 1, to + first);
  }
  for (const Contact& contact : points_) add_contact_stiffness(contact);
  for (std::size_t i = 0; i < bounded_.size(); ++i) {
    const Bounded& bounded = bounded_[i];
    if (bounded_impulse_[i] <= bounded.least || bounded_impulse_[i] >= bounded.most) continue;
    hessian_[at(bounded.coordinate, bounded.coordinate)] += 1 / bounded.softness;
  }
}

// L^T L, from the last coordinate to the first: no fill beyond close().
void VelocitySolver::factor() {
  for (int k = size_ - 1; k >= 0; --k) {
    double* of_k = hessian_.data() + at(k, 0);
    const double root = std::sqrt(of_k[k]);
    const double inverse = 1 / root;
    of_k[k] = root;
    inverse_diagonal_[static_cast<std::size_t>(k)] = inverse;
    const int first = first_[static_cast<std::size_t>(k)];
    const bool shared = k >= shared_ && to_shared_[static_cast<std::size_t>(k)] != 0;
    for (int i = first; i < k; ++i) of_k[i] *= inverse;
    for (int i = first; i < k; ++i)
      add(-of_k[i], of_k + first, hessian_.data() + at(i, first), i - first + 1);
    if (!shared) continue;
    for (int i = 0; i < shared_; ++i) of_k[i] *= inverse;
    // Above the diagonal too: what stands there is never read.
    for (int i = 0; i < shared_; ++i)
      add_shared(-of_k[i], of_k, hessian_.data() + at(i, 0), shared_);
    for (int i = first; i < k; ++i) add_shared(-of_k[i], of_k, hessian_.data() + at(i, 0), shared_);
  }
}

void VelocitySolver::back_solve(double* x) const {
  const auto shared = [this](int i) {
    return i >= shared_ && to_shared_[static_cast<std::size_t>(i)] != 0;
  };
  for (int i = size_ - 1; i >= 0; --i) {
    const double* h = hessian_.data() + at(i, 0);
    const int first = first_[static_cast<std::size_t>(i)];
    x[i] *= inverse_diagonal_[static_cast<std::size_t>(i)];
    add(-x[i], h + first, x + first, i - first);
    if (shared(i)) add_shared(-x[i], h, x, shared_);
  }
  for (int i = 0; i < size_; ++i) {
    const double* h = hessian_.data() + at(i, 0);
    const int first = first_[static_cast<std::size_t>(i)];
    double sum = x[i] - dot(h + first, x + first, i - first);
    if (shared(i)) sum -= dot_shared(h, x, shared_);
    x[i] = sum * inverse_diagonal_[static_cast<std::size_t>(i)];
  }
}

// Derivative of the convex function at v + way * change.
double VelocitySolver::slope(double way, std::span<const double> v) const {
  double sum = start_slope_ + way * curve_;
  for (const Contact& contact : points_) {
    Impulse moved;
    impulses(contact, contact.velocity + way * contact.change, moved);
    for (int r = 0; r < contact.rows; ++r) sum -= moved[r] * contact.change[r];
  }
  for (const Bounded& bounded : bounded_) {
    const auto c = static_cast<std::size_t>(bounded.coordinate);
    const double change = bounded.sign * change_[c];
    sum -= change * bounded_impulse(bounded, bounded.sign * v[c] + way * change);
  }
  return sum;
}

// Where along the change the slope is 0. It grows all the way.
double VelocitySolver::search(std::span<const double> v) const {
  const double at_start = slope(0, v);
  const double enough = kSlopeShare * std::abs(at_start);
  double low = 0, of_low = at_start, high = 1, of_high = slope(1, v);
  if (std::abs(of_high) <= enough || of_high < 0) return 1;
  // The Illinois method: the chord, but an end that has stayed counts half.
  int stayed = 0;
  for (int i = 0; i < kSearchSteps; ++i) {
    const double way = low - of_low * (high - low) / (of_high - of_low);
    const double here = slope(way, v);
    if (std::abs(here) <= enough) return way;
    if (here < 0) {
      low = way;
      of_low = here;
      if (stayed > 0) of_high /= 2;
      stayed = 1;
    } else {
      high = way;
      of_high = here;
      if (stayed < 0) of_low /= 2;
      stayed = -1;
    }
  }
  return low > 0 ? low : high;
}

void VelocitySolver::solve(std::span<const double> momentum, std::span<double> v, double tolerance,
                           int most_steps) {
  multiply(v.data(), inertia_v_.data());
  gradient(momentum, v);
  residual_ = change_left();
  for (steps_ = 0; steps_ < most_steps && residual_ > kSafety * tolerance;) {
    ++steps_;
    add_stiffness();
    factor();
    for (int i = 0; i < size_; ++i)
      change_[static_cast<std::size_t>(i)] = -gradient_[static_cast<std::size_t>(i)];
    back_solve(change_.data());
    residual_ = 0;
    for (const double x : change_) residual_ = std::max(residual_, std::abs(x));
    multiply(change_.data(), inertia_change_.data());
    double way = 1;
    if (residual_ > tolerance) {
      start_slope_ = 0;
      for (int i = 0; i < size_; ++i) {
        const auto k = static_cast<std::size_t>(i);
        start_slope_ += change_[k] * (inertia_v_[k] - momentum[k]);
      }
      curve_ = dot(change_.data(), inertia_change_.data(), size_);
      for (Contact& contact : points_) {
        for (int r = 0; r < contact.rows; ++r)
          contact.change[r] = along(contact, r, change_.data());
      }
      way = search(v);
    }
    for (int i = 0; i < size_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      v[k] += way * change_[k];
      inertia_v_[k] += way * inertia_change_[k];
    }
    gradient(momentum, v);
    if (residual_ <= tolerance) break;
    residual_ = change_left();
  }
}

}  // namespace kaz::sim
