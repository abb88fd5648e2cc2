// The path of a servo's target.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/trajectory.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {

void Trajectory::go_to(double goal, double highest, double rate, double step_s) {
  const double left = goal - position, before = speed;
  if (rate == 0) {
    const double moved = std::clamp(left, -highest * step_s, highest * step_s);
    position += moved;
    speed = moved / step_s;
    acceleration = 0;
    return;
  }
  // Of a speed that changes once a step.
  const double change = rate * step_s;
  const double can_stop = std::sqrt(change * change / 4 + 2 * rate * std::abs(left)) - change / 2;
  const double wanted = std::copysign(std::min(highest, can_stop), left);
  speed += std::clamp(wanted - speed, -change, change);
  position += speed * step_s;
  const bool arrived = (goal - position) * left <= 0 && std::abs(speed) <= 2 * change;
  if (arrived) {
    position = goal;
    speed = 0;
  }
  acceleration = arrived ? 0 : (speed - before) / step_s;
}

void Trajectory::reach_speed(double wanted, double rate, double step_s) {
  const double change = rate == 0 ? INFINITY : rate * step_s, before = speed;
  speed += std::clamp(wanted - speed, -change, change);
  acceleration = rate == 0 ? 0 : (speed - before) / step_s;
}

}  // namespace kaz::sim
