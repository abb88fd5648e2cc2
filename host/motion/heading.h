// Which way the robot faces, from the yaw gyro, zeroed whenever it stands still.
// SPDX-License-Identifier: Apache-2.0
//
// The gyro turns with the trunk: it measures the rate about the trunk's z, which leans by pitch and
// roll. While only yaw changes that is the rate about the vertical times cos(pitch) cos(roll).
// Radians, + to the left.
#pragma once

#include "host/robot/inertial.h"

namespace kaz::motion {

class Heading {
 public:
  // `still`: the robot stands and was told nothing, so that the rate is the gyro's zero. `upright`:
  // cosine of the trunk's lean. Samples in order of time.
  void add(const host::Inertial& sample, bool still, double upright);

  double rad() const { return heading_; }
  // One sigma of what was integrated since the zero was last known well.
  double sigma_rad() const;
  // For how long the zero has been averaged, s.
  double zeroed_s() const { return zeroed_s_; }
  double rate() const { return rate_; }  // rad/s, without the zero

 private:
  double heading_ = 0, zero_ = 0, zeroed_s_ = 0, rate_ = 0;
  double moving_s_ = 0;
  Time last_{};
  bool started_ = false;
};

}  // namespace kaz::motion
