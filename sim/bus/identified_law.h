// Control law of an identified servo on a virtual bus: command delay, slew limit, duty and lag.
// SPDX-License-Identifier: Apache-2.0
//
// docs/reference/servo-bus.md describes the law. Angles are in the servo's direction, rad.
#pragma once

#include <deque>
#include <memory>
#include <utility>

#include "shared/servo_model/servo_model.h"

namespace kaz::sim {

// Torque switch and goal, as the registers have them.
struct BusCommand {
  int torque = 0;
  double goal = 0;  // in the unit of the register
  bool has_goal = false;
};

class IdentifiedLaw {
 public:
  using Params = std::shared_ptr<const servo_model::ServoParams>;
  explicit IdentifiedLaw(Params params) : params_(std::move(params)), law_(*params_, 0) {}

  // Returns the command that acts in this step: the one of ServoParams::delay ago. A host's write arrives
  // half a step before the step that sees it, on average. The first call fills the past with `now`.
  BusCommand delayed(const BusCommand& now, double step_s);
  // ServoLaw::advance().
  double duty(const servo_model::ServoCommand& command, double angle_rad, double step_s) {
    return law_.advance(command, angle_rad, step_s);
  }
  // Makes `angle_rad` the setpoint.
  void hold(double angle_rad) { law_.advance({.torque_on = false}, angle_rad, 1); }
  double setpoint_rad() const { return law_.setpoint_rad(); }
  // Forgets all commands.
  void power_on() { past_.clear(); }

 private:
  Params params_;
  servo_model::ServoLaw law_;
  std::deque<BusCommand> past_;  // the newest is last
};

}  // namespace kaz::sim
