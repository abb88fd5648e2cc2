// Path of the head during a search for a ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/robot/kinematics.h"

namespace kaz::behavior {

// The head pans between -80 and 80 degrees at constant speed, along three rows with different tilts. The head
// then repeats this path forever, alternately backward and forward. The tilts of the rows are 20, 52 and -15
// degrees. The field of view is 80 degrees wide and 64 degrees high. The tilts of neighboring rows differ by
// 32 or 35 degrees. So the images of neighboring rows overlap by about half of the image height. The three
// rows together cover the range from 47 degrees above the horizon to 84 degrees below it. To the sides, they
// cover the range from -120 to 120 degrees.
class SearchPattern {
 public:
  static constexpr double kSweepDeg = 80;
  static constexpr double kTiltsDeg[] = {20, 52, -15};

  // The search starts at the present gaze `start`. The first row is the row whose tilt is nearest to the tilt
  // of `start`. The head begins the first row at the end on the side of `start`. If the pan angle of `start`
  // is 0, `left_first` selects the end; true: left, false: right. `speed`: speed of the faster of the two
  // joints, rad/s.
  SearchPattern(const host::Gaze& start, double speed, bool left_first);

  // Returns the gaze at `t` seconds after the start, t >= 0.
  host::Gaze at(double t) const;
  // Time from the start until the first scan of all rows is complete, s.
  double once() const { return points_.back().time; }

 private:
  struct Point {
    double time;
    host::Gaze gaze;
  };
  std::vector<Point> points_;  // the start, then both ends of each row
};

}  // namespace kaz::behavior
