// Setpoint trajectory of a servo from one goal to the next.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Units: positions in steps (pulses) of the position sensor, times in s.
struct Trajectory {
  double position = 0, speed = 0, acceleration = 0;

  void hold(double at) { *this = {at, 0, 0}; }
  // Moves `position` toward `goal` for one time step of a trapezoidal speed profile. If the goal is nearer
  // than the braking distance, the position passes the goal and then returns. `highest` is the maximum speed,
  // `rate` the acceleration. If `rate` is 0, the speed changes at once.
  void go_to(double goal, double highest, double rate, double step_s);
  // Changes the speed toward `wanted` for one time step. The position is unchanged. `rate` is the
  // acceleration. If `rate` is 0, the speed becomes `wanted` at once.
  void reach_speed(double wanted, double rate, double step_s);
};

}  // namespace kaz::sim
