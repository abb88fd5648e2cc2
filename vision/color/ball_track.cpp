// Kalman filter of the ball: prediction with flight, bounces and rolling; correction, gate, late data.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball_track.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Dense>

namespace kaz::vision {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kGravity = 9.81;
constexpr std::size_t kRemembered = 40;  // more than a second at 30 Hz
constexpr double kFastest_m_s = 8;       // maximum speed between two outliers of one ball
constexpr double kMinHeight_m = 0.01;    // in flight above this height over the floor
constexpr double kMinBounce_m_s = 0.15;  // a slower rebound ends the bouncing

}  // namespace

Matrix3d ball_covariance(const Vector3d& in_eye, double focal_px, const Matrix3d& fixed_from_eye,
                         const BallTrackOptions& o) {
  const double distance = in_eye.norm();
  const double across = distance * std::hypot(o.centre_error_px / focal_px, o.posture_error_rad);
  const double along = distance * distance * o.radius_error_px / (focal_px * o.radius_m);
  const Vector3d ray = fixed_from_eye * in_eye / distance;
  return across * across * Matrix3d::Identity() +
         std::max(0.0, along * along - across * across) * ray * ray.transpose();
}

BallTrack::Taken BallTrack::observe(const BallObservation& seen,
                                    const Eigen::Isometry3d& fixed_from_eye) {
  const Vector3d in_eye = seen.position();
  if (!seen.found || !in_eye.allFinite() || !(in_eye.norm() > 0) || !(seen.info.camera.fx > 0))
    return Taken::refused;
  return observe(seen.info.exposure, fixed_from_eye * in_eye,
                 ball_covariance(in_eye, seen.info.camera.fx, fixed_from_eye.linear(), options_));
}

BallTrack::Taken BallTrack::observe(Time exposure, const Vector3d& position,
                                    const Matrix3d& covariance) {
  if (!position.allFinite() || !covariance.allFinite() || !(covariance.determinant() > 0))
    return Taken::refused;
  const Entry seen{exposure, position, covariance, {}};
  if (!known()) {
    start(seen);
    return Taken::started;
  }
  if (between(latest(), exposure) > options_.latest_late) {
    ++gaps_;
    start(seen);
    return Taken::new_clock;
  }
  if (between(exposure, latest()) > options_.lost_after) {
    start(seen);
    return Taken::started;
  }
  return insert(seen);
}

void BallTrack::forget() {
  history_.clear();
  outlier_.reset();
}

void BallTrack::start(const Entry& seen) {
  forget();
  Entry first = seen;
  first.after.position = seen.position;
  first.after.covariance.setZero();
  first.after.covariance.topLeftCorner<3, 3>() = seen.covariance;
  first.after.covariance.bottomRightCorner<3, 3>() =
      options_.initial_speed_m_s * options_.initial_speed_m_s * Matrix3d::Identity();
  history_.push_back(first);
}

// Restarts the track if two consecutive outliers can be one ball: their distance is within
// kFastest_m_s dt + 3 sigma. A single outlier is taken for another object.
bool BallTrack::restart(const Entry& seen) {
  const std::optional<Entry> first = outlier_;
  outlier_ = seen;
  if (!first || seen.time <= first->time || between(seen.time, first->time) > options_.lost_after)
    return false;
  const double dt = seconds(between(seen.time, first->time));
  const double reach =
      kFastest_m_s * dt + 3 * std::sqrt((first->covariance + seen.covariance).trace());
  if ((seen.position - first->position).norm() > reach) return false;
  start(*first);
  Entry second = seen;
  second.after = history_.back().after;
  advance(second.after, dt);
  correct(second.after, second);
  history_.push_back(second);
  return true;
}

// Inserts an observation by exposure. The filter is causal, so all later observations are processed again
// from the new state.
BallTrack::Taken BallTrack::insert(const Entry& seen) {
  const auto place = std::find_if(history_.begin(), history_.end(),
                                  [&](const Entry& e) { return e.time >= seen.time; });
  if (place != history_.end() && (place == history_.begin() || place->time == seen.time))
    return Taken::refused;
  const bool newest = place == history_.end();
  Entry entry = seen;
  entry.after = std::prev(place)->after;
  advance(entry.after, seconds(between(seen.time, std::prev(place)->time)));
  if (!correct(entry.after, entry)) {
    if (newest && restart(entry)) return Taken::restarted;
    return Taken::outlier;
  }
  if (newest) outlier_.reset();
  for (auto e = history_.insert(place, entry); std::next(e) != history_.end(); ++e) {
    Entry& next = *std::next(e);
    next.after = e->after;
    advance(next.after, seconds(between(next.time, e->time)));
    correct(next.after, next);
  }
  if (history_.size() > kRemembered) history_.pop_front();
  return newest ? Taken::used : Taken::late;
}

// Kalman update with the observed position z, covariance R: innovation y = z - H x with H = (I 0),
// S = H P H^T + R, gain K = P H^T S^-1. Gate: y^T S^-1 y <= gate^2; false, and no change, for an outlier.
bool BallTrack::correct(BallState& state, const Entry& seen) const {
  const Vector3d surprise = seen.position - state.position;
  const Eigen::LDLT<Matrix3d> spread(state.position_covariance() + seen.covariance);
  if (surprise.dot(spread.solve(surprise)) > options_.gate * options_.gate) return false;
  const Eigen::Matrix<double, 6, 3> cross = state.covariance.leftCols<3>();
  const Eigen::Matrix<double, 6, 3> gain = spread.solve(cross.transpose()).transpose();
  state.position += gain.topRows<3>() * surprise;
  state.velocity += gain.bottomRows<3>() * surprise;
  // Joseph's form, P = (I - K H) P (I - K H)^T + K R K^T: stays symmetric and positive definite.
  Matrix6 keep = Matrix6::Identity();
  keep.leftCols<3>() -= gain;
  state.covariance =
      keep * state.covariance * keep.transpose() + gain * seen.covariance * gain.transpose();
  return true;
}

// In flight if the height over the rolling height, or the upward velocity, exceeds its minimum by more than
// two standard deviations.
BallTrack::Ground BallTrack::ground(const BallState& state) const {
  if (!options_.floor_m) return Ground::unknown;
  const double height = state.position.z() - *options_.floor_m - options_.radius_m;
  const double high = kMinHeight_m + 2 * std::sqrt(state.covariance(2, 2));
  const double fast = kMinBounce_m_s + 2 * std::sqrt(state.covariance(5, 5));
  return height > high || state.velocity.z() > fast ? Ground::flight : Ground::floor;
}

// Prediction over dt with constant acceleration: x = F x + (dt^2 / 2, dt) a, P = F P F^T + Q,
// F = (I dt I; 0 I). Q of white acceleration noise of power density q, per axis:
// q (dt^3 / 3, dt^2 / 2; dt^2 / 2, dt) (Bar-Shalom et al. 2001, section 6.2.2).
void BallTrack::drift(BallState& state, double dt, const Vector3d& acceleration) const {
  state.position += dt * state.velocity + 0.5 * dt * dt * acceleration;
  state.velocity += dt * acceleration;
  Matrix6 transition = Matrix6::Identity();
  transition.topRightCorner<3, 3>() = dt * Matrix3d::Identity();
  state.covariance = transition * state.covariance * transition.transpose();
  const double q = options_.acceleration_psd;
  for (int i = 0; i < 3; ++i) {
    state.covariance(i, i) += q * dt * dt * dt / 3;
    state.covariance(i, i + 3) += q * dt * dt / 2;
    state.covariance(i + 3, i) += q * dt * dt / 2;
    state.covariance(i + 3, i + 3) += q * dt;
  }
}

// Prediction over dt with gravity and contact. Time to land from height h with upward speed v:
// (v + sqrt(v^2 + 2 g h)) / g. At the bounce v_z' = -e v_z, and P = X P X^T with the saltation matrix X
// (N. Kong et al. 2023), which maps deviations in height and vertical velocity across it:
// X_zz = X_vv = -e, X_vz = -(1 + e) g / v_z. Rolling: constant deceleration until the ball rests.
void BallTrack::advance(BallState& state, double dt) const {
  const Ground now = ground(state);
  if (now == Ground::unknown) return drift(state, dt, Vector3d::Zero());
  const double rest = *options_.floor_m + options_.radius_m;
  bool rolls = now == Ground::floor;
  // Ever lower bounces would be infinitely many; eight suffice for any dt here.
  for (int bounce = 0; !rolls && bounce < 8; ++bounce) {
    const double height = std::max(0.0, state.position.z() - rest), up = state.velocity.z();
    const double lands = (up + std::sqrt(up * up + 2 * kGravity * height)) / kGravity;
    const Vector3d fall(0, 0, -kGravity);
    if (lands > dt) return drift(state, dt, fall);
    drift(state, lands, fall);
    dt -= lands;
    const double down = state.velocity.z(), e = options_.restitution;
    state.position.z() = rest;
    state.velocity.z() = -e * down;
    rolls = -e * down < kMinBounce_m_s;
    if (down < 0) {
      Matrix6 through = Matrix6::Identity();
      through(2, 2) = through(5, 5) = -e;
      through(5, 2) = -(1 + e) * kGravity / down;
      state.covariance = through * state.covariance * through.transpose();
    }
  }
  state.velocity.z() = 0;
  const double speed = state.velocity.norm();
  if (speed * dt == 0) return drift(state, dt, Vector3d::Zero());
  const double rolled = std::min(dt, speed / std::max(options_.rolling_m_s2, 1e-9));
  const Vector3d slows = -options_.rolling_m_s2 / speed * state.velocity;
  drift(state, rolled, slows);
  if (rolled < dt) {
    state.velocity.setZero();
    drift(state, dt - rolled, Vector3d::Zero());
  }
}

const BallTrack::Entry& BallTrack::before(Time t) const {
  const auto later =
      std::find_if(history_.begin(), history_.end(), [t](const Entry& e) { return e.time > t; });
  return later == history_.begin() ? history_.front() : *std::prev(later);
}

BallState BallTrack::at(Time t) const {
  const Entry& from = before(t);
  BallState state = from.after;
  if (t > from.time) advance(state, seconds(between(t, from.time)));
  return state;
}

Vector3d BallTrack::aim(Time t) const {
  const Entry& from = before(t);
  BallState state = from.after;
  const double m = state.velocity.dot(state.velocity_covariance().ldlt().solve(state.velocity));
  state.velocity *= m / (1 + m);
  if (t > from.time) advance(state, seconds(between(t, from.time)));
  return state.position;
}

bool BallTrack::in_flight(Time t) const {
  return ground(at(t)) == Ground::flight;
}

}  // namespace kaz::vision
