// Estimates the heading of the robot from the yaw gyro, and measures the gyro's zero while the robot stands.
// SPDX-License-Identifier: Apache-2.0
//
// The gyro is fixed to the trunk, which leans by pitch and roll. So the gyro measures the rate about the
// trunk's z axis. While only yaw changes, the gyro's rate is the product of three factors: the yaw rate about
// the vertical, cos(pitch), and cos(roll).
//
// A Kalman filter with two states estimates the heading and the gyro's zero together. The gyro's zero is
// modeled as a random walk. Each sample that is taken while the robot stands measures this zero. The filter
// also estimates the covariance of heading and zero. During a movement, the drift of the zero causes an error
// of the heading. When the robot stands again, the samples also correct this error. Units: rad, positive to
// the left.
#pragma once

#include "host/robot/inertial.h"

namespace kaz::motion {

class Heading {
 public:
  Heading();

  // Adds a sample, which must be later than the previous sample. `still`: true if the robot stands without a
  // command. If `still` is true, add() uses the measured rate to correct the gyro's zero. But add() ignores a
  // rate which shows that the robot is being turned. `upright`: cosine of the trunk's lean.
  void add(const host::Inertial& sample, bool still, double upright);

  double rad() const { return heading_; }
  // Standard deviation of the rotation since the first sample. The value includes the noise, the error of the
  // measured zero, and the drift of the zero. Lean and shaking of the trunk during walking cause
  // further errors. The value does not include them, but Motion takes them into account.
  double sigma_rad() const;
  double sigma_zero() const;  // rad/s
  // Total time of the samples that measured the zero, s.
  double zeroed_s() const { return zeroed_s_; }
  double rate() const { return rate_; }  // yaw rate after subtraction of the zero, rad/s

 private:
  double heading_ = 0, zero_ = 0, zeroed_s_ = 0, rate_ = 0;
  // Covariance matrix: variance of the heading, covariance of heading and zero, variance of the zero.
  double heading_2_ = 0, both_ = 0, zero_2_;
  Time last_{};
  bool started_ = false;
};

}  // namespace kaz::motion
