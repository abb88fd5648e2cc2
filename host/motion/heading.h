// The robot's heading by integration of the yaw gyro, whose zero is measured whenever it stands still.
// SPDX-License-Identifier: Apache-2.0
//
// The gyro turns with the trunk: it measures the rate about the trunk's z, which leans by pitch and
// roll. While only yaw changes that is the rate about the vertical times cos(pitch) cos(roll).
//
// Heading and the gyro's zero are estimated together (Kalman filter of two states). The zero is a random
// walk; while the robot stands each sample measures it. What it had wandered meanwhile then shows, and
// the heading is put right by as much as the filter lays on it. Radians, + to the left.
#pragma once

#include "host/robot/inertial.h"

namespace kaz::motion {

class Heading {
 public:
  Heading();

  // `still`: the robot stands without a command, so that the rate is the gyro's zero. `upright`:
  // cosine of the trunk's lean. Samples in order of time.
  void add(const host::Inertial& sample, bool still, double upright);

  double rad() const { return heading_; }
  // One sigma of what was turned since the first sample: noise, the zero as it was measured, and what
  // it wandered since. Motion has the rest: lean and shaking of a walking trunk.
  double sigma_rad() const;
  double sigma_zero() const;  // rad/s
  // For how long the zero has been measured, s.
  double zeroed_s() const { return zeroed_s_; }
  double rate() const { return rate_; }  // rad/s, without the zero

 private:
  double heading_ = 0, zero_ = 0, zeroed_s_ = 0, rate_ = 0;
  // Covariance: of the heading, of both, of the zero.
  double heading_2_ = 0, both_ = 0, zero_2_;
  Time last_{};
  bool started_ = false;
};

}  // namespace kaz::motion
