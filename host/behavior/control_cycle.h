// The beat of a behaviour: every 10 ms new targets go out, the state and what was seen come in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

class ControlCycle {
 public:
  static constexpr Time kPeriod = std::chrono::milliseconds(10);
  // A target is reached a little after the next one has come, so that the motion has no steps.
  static constexpr Time kRamp = std::chrono::milliseconds(12);
  // From when a behaviour has decided on a target until the board's ramp to it begins: 19 bytes on
  // the wire, half a tick until they are looked at, one tick until the pins follow.
  static constexpr Time kSendDelay = std::chrono::microseconds(3150);
  // No picture for so long is an error.
  static constexpr Time kBlind = std::chrono::seconds(2);

  // The context must outlive this.
  explicit ControlCycle(Context& context);

  struct Input {
    Time now{};
    host::Posture posture;  // measured a few milliseconds before `now`
    std::vector<vision::BallObservation> seen;
    // The link was lost and is there again: these targets were not sent, ramps that were under way
    // have ended, and the joints hold where they are (robot.h).
    std::optional<host::Resumption> resumed;
  };
  // Sends the targets (none: only asks), waits for the next beat, and returns what is known then.
  // Fails when robot, clock or camera do, when the board has switched the motors off, and when no
  // picture came for kBlind.
  // `ramp`: time in which the targets are reached.
  Result<Input> next(std::span<const host::JointTarget> targets, Time ramp = kRamp);

 private:
  Context& context_;
  Time beat_;
  Time last_picture_;
};

// Gains of the walking body (sim's and the firmware's defaults), all motors on where they stand:
// what every behaviour begins with.
Result<void> hold_still(host::Robot& robot);

}  // namespace kaz::behavior
