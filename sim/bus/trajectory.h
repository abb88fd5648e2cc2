// The path of a servo's target from one goal to the next.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

struct Trajectory {
  double position = 0, speed = 0, acceleration = 0;

  void hold(double at) { *this = {at, 0, 0}; }
  // One step of a trapezoid of speed, from wherever it is, as fast as it can still stop. `rate`: of the
  // speed; 0: the speed is there at once.
  void go_to(double goal, double highest, double rate, double step_s);
  // One step towards a speed; the position is left alone. `rate` as above.
  void reach_speed(double wanted, double rate, double step_s);
};

}  // namespace kaz::sim
