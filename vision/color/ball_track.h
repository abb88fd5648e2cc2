// Tracks position and velocity of the ball from observations, which may arrive late and in any order.
// SPDX-License-Identifier: Apache-2.0
//
// A Kalman filter estimates position and velocity in a fixed frame (foot, or the trunk of a standing robot),
// z up, m and m/s. The process model is nearly constant velocity (Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
// "Estimation with Applications to Tracking and Navigation", 2001, section 6.2.2). If the floor height is
// given, gravity acts on a ball that is clearly above the floor or moves upwards. A falling ball bounces at
// the floor. The bounce changes the covariance by a saltation matrix (N. Kong et al., "Saltation Matrices",
// 2023). A ball on the floor stays on the floor and slows down.
//
// The position errors of an observation are computed from these quantities:
//   D    distance of the ball, m
//   r    radius of the ball, m
//   f    focal length, px
//   s_c  error of the outline's center, px
//   s_r  error of the outline's radius, px
//   s_p  error of the posture, rad
// The position error across the ray is D sqrt((s_c / f)^2 + s_p^2). The radius of the outline is f r / D.
// Therefore the position error along the ray is D^2 s_r / (f r). So the direction is accurate, and the error
// of the distance grows with the square of the distance. Units: m, s, px, rad.
#pragma once

#include <deque>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "shared/base/time.hpp"
#include "vision/color/ball.h"

namespace kaz::vision {

struct BallTrackOptions {
  double radius_m = 0.020;
  double centre_error_px = 0.3, radius_error_px = 0.2;  // standard deviations
  double posture_error_rad = 0.003;
  // Power density of the unmodeled acceleration (process noise), m^2/s^3. With 0.5, the track follows a ball
  // that is moved back and forth by hand and reverses its direction within 50 ms. If nobody touches the ball,
  // a power density of 0.05 is enough.
  double acceleration_psd = 0.5;
  double initial_speed_m_s = 1;  // standard deviation of the speed before the second observation
  double gate = 8;               // Mahalanobis distance above which an observation is an outlier
  Time lost_after = std::chrono::milliseconds(500);
  // An observation is late if its exposure is earlier than the newest exposure by at most this time. If an
  // observation's exposure is earlier than the newest exposure by more than this time, the clock was set
  // back.
  Time latest_late = std::chrono::seconds(1);
  std::optional<double> floor_m;  // height of the floor; nullopt: gravity is not modeled
  double restitution = 0.6;
  double rolling_m_s2 = 0.1;  // deceleration of a rolling ball
};

struct BallState {
  Eigen::Vector3d position{0, 0, 0}, velocity{0, 0, 0};  // m, m/s
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();

  Eigen::Matrix3d position_covariance() const { return covariance.topLeftCorner<3, 3>(); }
  Eigen::Matrix3d velocity_covariance() const { return covariance.bottomRightCorner<3, 3>(); }
};

// Returns the covariance of an observed position in the fixed frame, m^2. The covariance is s_across^2 I +
// (s_along^2 - s_across^2) r r^T. Here r is the unit ray. The position error across the ray is s_across, and
// the position error along the ray is s_along (formulas: top of this file). `in_eye` is the position in the
// optical frame, m.
Eigen::Matrix3d ball_covariance(const Eigen::Vector3d& in_eye, double focal_px,
                                const Eigen::Matrix3d& fixed_from_eye,
                                const BallTrackOptions& options);

class BallTrack {
 public:
  enum class Taken {
    started,    // used as the first observation of a track, initially or after the ball was lost
    used,       // used as the newest observation of the track
    late,       // used, but not the newest; all newer observations were processed again
    restarted,  // the ball jumped: two consistent outliers started a new track
    // The clock was set back: the exposure is far earlier than the newest exposure. A new track was started.
    new_clock,
    outlier,  // not used
    refused,  // not used: no ball, not finite, repeated, or older than the history of the track
  };

  explicit BallTrack(const BallTrackOptions& options = {}) : options_(options) {}

  Taken observe(const BallObservation& seen, const Eigen::Isometry3d& fixed_from_eye);
  // Adds an observed position (m, fixed frame). A `covariance` that is not positive definite is refused.
  Taken observe(Time exposure, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  void forget();

  bool known() const { return !history_.empty(); }
  Time latest() const { return history_.back().time; }  // newest exposure; requires known()
  // Returns whether the time from the newest exposure to `t` is at most `lost_after`.
  bool seen(Time t) const { return known() && between(t, latest()) <= options_.lost_after; }
  int gaps() const { return gaps_; }  // number of times that the clock was set back

  // Predicts the state at `t`; requires known(). If `t` is before the history, returns the first state.
  BallState at(Time t) const;
  // Predicts the position at which to direct the gaze; requires known(). Like at(), but with the velocity v
  // scaled by m / (1 + m). Here m = v^T P^-1 v is the squared Mahalanobis length of v, and P is the
  // covariance of v. A velocity that is smaller than its standard deviation has little effect, so the gaze
  // does not jitter around a ball at rest.
  Eigen::Vector3d aim(Time t) const;
  bool in_flight(Time t) const;

 private:
  struct Entry {
    Time time{};
    Eigen::Vector3d position;
    Eigen::Matrix3d covariance;
    BallState after;
  };
  enum class Ground { flight, floor, unknown };

  Ground ground(const BallState& state) const;
  void advance(BallState& state, double dt) const;
  void drift(BallState& state, double dt, const Eigen::Vector3d& acceleration) const;
  bool correct(BallState& state, const Entry& seen) const;
  void start(const Entry& seen);
  bool restart(const Entry& seen);
  Taken insert(const Entry& seen);
  const Entry& before(Time t) const;

  BallTrackOptions options_;
  std::deque<Entry> history_;  // observations of this track, sorted by exposure time
  std::optional<Entry> outlier_;
  int gaps_ = 0;
};

}  // namespace kaz::vision
