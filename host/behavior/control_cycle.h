// The control cycle of a behaviour: every 10 ms targets are sent, state and observations are read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

class ControlCycle {
 public:
  static constexpr Time kPeriod = std::chrono::milliseconds(10);
  // Duration of the board's ramp to a target: longer than the period, so that the motion is continuous.
  static constexpr Time kRamp = std::chrono::milliseconds(12);
  // Delay from a behaviour's decision to the start of the board's ramp: 19 bytes on the wire, half a
  // tick until they are processed, one tick until the pins follow.
  static constexpr Time kSendDelay = std::chrono::microseconds(3150);
  // Without an image for this long the behaviours that look for the ball stand still until the next one.
  static constexpr Time kLostCamera = std::chrono::seconds(1);

  // The context must outlive this.
  explicit ControlCycle(Context& context);

  struct Input {
    Time now{};
    host::Posture posture;  // measured a few milliseconds before `now`
    std::vector<vision::BallObservation> observations;
    // The link was lost and has been restored: these targets were not sent, ramps in progress have
    // ended, and the joints hold where they are (robot.h).
    std::optional<host::Resumption> resumed;
  };
  // Sends the targets (empty: only reads the state), waits for the start of the next cycle, and returns
  // the newest state and observations. `ramp`: time in which the targets are reached.
  // Fails when robot, clock or camera fail, when the board has switched the motors off, and when no
  // image came for Context::camera_patience.
  Result<Input> next(std::span<const host::JointTarget> targets, Time ramp = kRamp);

 private:
  Context& context_;
  Time cycle_start_;
  Time last_image_;
};

// Fails (usage) if the robot lacks one of these joints, with their names and what to do. On a robot other
// than Kaz the targets would move the joints that happen to be on these channels, so behaviours that name
// joints of Kaz call it before hold_still().
Result<void> require_joints(const Context& context, std::string_view behavior,
                            std::initializer_list<host::Joint> joints);

// Sets the gains for walking (20 /rad, 0.15 s/rad; neck 12, hands 0.8 /rad) and enables all motors at
// their present angles: how every behaviour begins.
Result<void> hold_still(host::Robot& robot);

}  // namespace kaz::behavior
