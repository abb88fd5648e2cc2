// The way the head goes while it looks for something.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/robot/kinematics.h"

namespace kaz::behavior {

// Sweeps of the pan from -80 to 80 degrees at three tilts, at a constant speed, for ever. With eyes
// that see 64 degrees from top to bottom, tilts of 20, 52 and -15 degrees cover everything from 47
// degrees above the horizon to 84 below it, the rows overlapping by half; 80 degrees from side to
// side reach from -120 to 120.
class SearchPattern {
 public:
  static constexpr double kSweepDeg = 80;
  static constexpr double kTiltsDeg[] = {20, 52, -15};

  // Begins where the head looks now, with the row nearest to it, toward the nearer end of the sweep
  // (`left_first` decides where both are as near). speed: rad/s, of the faster of the two joints.
  SearchPattern(const host::Gaze& start, double speed, bool left_first);

  // Where to look `t` seconds after the beginning, t >= 0.
  host::Gaze at(double t) const;
  // Seconds until every row has been seen once.
  double once() const { return points_.back().time; }

 private:
  struct Point {
    double time;
    host::Gaze gaze;
  };
  std::vector<Point> points_;  // first: the start; then both ends of each row
};

}  // namespace kaz::behavior
