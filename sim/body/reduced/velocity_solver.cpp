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
  } else {
    std::ranges::fill(inertia_, 0.0);
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
      sum += dot(m, x, shared_);
      add(x[i], m, out, shared_);
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
  // Row by row of J: D couples the two rows of friction alone.
  const auto add_pair = [this, &contact](int r, const double* with) {
    const double* a = row(contact, r);
    int ia = 0;
    for (int s = 0; s < contact.segment_count; ++s) {
      const Segment& segment = contact.segments[static_cast<std::size_t>(s)];
      for (int i = segment.first; i < segment.first + segment.length; ++i, ++ia) {
        double* h = hessian_.data() + at(i, 0);
        const double* b = with;
        for (int t = 0; t <= s; ++t) {
          const Segment& other = contact.segments[static_cast<std::size_t>(t)];
          const int length = t == s ? i - segment.first + 1 : other.length;
          add(a[ia], b, h + other.first, length);
          b += other.length;
        }
      }
    }
  };
  scratch_.resize(static_cast<std::size_t>(contact.length));
  for (int r = 0; r < contact.rows; ++r) {
    std::ranges::fill(scratch_, 0.0);
    bool any = false;
    for (int k = 0; k < contact.rows; ++k) {
      if (d(r, k) == 0) continue;
      add(d(r, k), row(contact, k), scratch_.data(), contact.length);
      any = true;
    }
    if (any) add_pair(r, scratch_.data());
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
    for (int i = 0; i < shared_; ++i) add(-of_k[i], of_k, hessian_.data() + at(i, 0), i + 1);
    for (int i = first; i < k; ++i) add(-of_k[i], of_k, hessian_.data() + at(i, 0), shared_);
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
    if (shared(i)) add(-x[i], h, x, shared_);
  }
  for (int i = 0; i < size_; ++i) {
    const double* h = hessian_.data() + at(i, 0);
    const int first = first_[static_cast<std::size_t>(i)];
    double sum = x[i] - dot(h + first, x + first, i - first);
    if (shared(i)) sum -= dot(h, x, shared_);
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
  residual_ = 0;
  for (steps_ = 0; steps_ < most_steps;) {
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
  }
}

}  // namespace kaz::sim
