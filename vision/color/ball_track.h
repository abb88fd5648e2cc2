// Tracks the ball: position and velocity from observations that arrive late and in any order.
// SPDX-License-Identifier: Apache-2.0
//
// Kalman filter of position and velocity in a fixed frame (foot, or the trunk of a standing robot), z up,
// m and m/s; process model: nearly constant velocity, Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
// "Estimation with Applications to Tracking and Navigation", 2001, section 6.2.2. Where the height
// of the floor is given, gravity acts on a ball that is clearly above it or moves upwards; where it
// meets the floor it bounces, with the covariance carried through the bounce by its saltation
// matrix (N. Kong et al., "Saltation Matrices", 2023); a ball on the floor stays on it and slows
// down.
//
// Errors of an observation at distance D, from those of the outline: the centre's error s_c (px) and the
// posture's s_p (rad) displace it across the ray by D sqrt((s_c / f)^2 + s_p^2); with radius_px = f r / D,
// the radius's error s_r (px) displaces it along the ray by D^2 s_r / (f r). So the direction is accurate,
// and the error of the distance grows with its square. m, s, px, rad.
#pragma once

#include <deque>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::vision {

struct BallTrackOptions {
  double radius_m = 0.020;
  double centre_error_px = 0.3, radius_error_px = 0.2;  // standard deviations
  double posture_error_rad = 0.003;
  // m^2/s^3, power density of the unmodelled acceleration (process noise). With 0.5 the track follows a
  // ball that reverses within 50 ms, as one in a hand may; a free ball needs a tenth of it.
  double acceleration_psd = 0.5;
  double initial_speed_m_s = 1;  // standard deviation before the second observation
  double gate = 8;               // Mahalanobis distance above which an observation is an outlier
  Time lost_after = std::chrono::milliseconds(500);
  // An observation older than the newest by more means that the clock was set back.
  Time latest_late = std::chrono::seconds(1);
  std::optional<double> floor_m;  // height of the floor; without it gravity is not modelled
  double restitution = 0.6;
  double rolling_m_s2 = 0.1;  // deceleration of a rolling ball
};

struct BallState {
  Eigen::Vector3d position{0, 0, 0}, velocity{0, 0, 0};  // m, m/s
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();

  Eigen::Matrix3d position_covariance() const { return covariance.topLeftCorner<3, 3>(); }
  Eigen::Matrix3d velocity_covariance() const { return covariance.bottomRightCorner<3, 3>(); }
};

// Covariance of an observed position, fixed frame, m^2: s_across^2 I + (s_along^2 - s_across^2) r r^T with
// the unit ray r and the errors above. `in_eye`: position in the optical frame, m.
Eigen::Matrix3d ball_covariance(const Eigen::Vector3d& in_eye, double focal_px,
                                const Eigen::Matrix3d& fixed_from_eye,
                                const BallTrackOptions& options);

class BallTrack {
 public:
  enum class Taken {
    started,    // the first, or the first after a loss
    used,       // the newest
    late,       // inserted by exposure; the later observations were processed again
    restarted,  // the ball has jumped: two consistent outliers start a new track
    new_clock,  // far older than the newest: the clock was set back, a new track starts (gaps())
    outlier,    // not used
    refused,    // no ball, not finite, or older than the track's history
  };

  explicit BallTrack(const BallTrackOptions& options = {}) : options_(options) {}

  Taken observe(const BallObservation& seen, const Eigen::Isometry3d& fixed_from_eye);
  // `covariance` must be positive definite.
  Taken observe(Time exposure, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  void forget();

  bool known() const { return !history_.empty(); }
  Time latest() const { return history_.back().time; }  // newest exposure; known() must hold
  // Whether the last observation is at most lost_after before `t`.
  bool seen(Time t) const { return known() && between(t, latest()) <= options_.lost_after; }
  int gaps() const { return gaps_; }  // how often the clock was set back

  // Predicted state at `t`; known() must hold. For times before the history: its first state.
  BallState at(Time t) const;
  // Position for the gaze: as at(), but with the velocity v, covariance P, scaled by m / (1 + m),
  // m = v^T P^-1 v. A velocity within its noise hardly counts, so that the gaze rests on a resting ball.
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
  std::deque<Entry> history_;  // by exposure, of this track
  std::optional<Entry> outlier_;
  int gaps_ = 0;
};

}  // namespace kaz::vision
