// Control cycle of a behavior: every 10 ms, sends targets and reads state and ball observations.
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
  // Duration of the board's ramp to a target. The ramp lasts longer than one control cycle (kPeriod), so that
  // a joint is still moving when the next target arrives.
  static constexpr Time kRamp = std::chrono::milliseconds(12);
  // Delay from a behavior's decision to the start of the board's ramp. The delay is the sum of three parts:
  // - 1.65 ms: transmission of 19 bytes.
  // - 0.5 ms: mean time until the board's next tick, which processes the bytes.
  // - 1 ms: one tick until the board writes the new outputs to the pins.
  static constexpr Time kSendDelay = std::chrono::microseconds(3150);
  // After this time without an image, the robot stands still until the next image. This applies to behaviors
  // that use the camera.
  static constexpr Time kLostCamera = std::chrono::seconds(1);

  // The context must outlive this object.
  explicit ControlCycle(Context& context);

  struct Input {
    Time now{};
    host::Posture posture;  // measured a few milliseconds before `now`
    std::vector<vision::BallObservation> observations;
    // Set if the link was lost and restored during the call of next(). If `resumed` is set, the targets of
    // this call were not sent. The board has ended all ramps and holds the joints at their positions
    // (host/robot/robot.h).
    std::optional<host::Resumption> resumed;
  };
  // Sends the targets, waits for the start of the next cycle, and returns the newest state and
  // observations. If `targets` is empty, next() sends no targets, but still waits for the next cycle and
  // returns the newest state and observations. `ramp`: time to reach the targets.
  //
  // next() fails if robot, clock or camera fail, or if the board has switched the motors off. Also fails if
  // no image came for Context::camera_patience.
  Result<Input> next(std::span<const host::JointTarget> targets, Time ramp = kRamp);
  // Calls next() and replaces `input`, the result of the cycle before. The ramp lasts a little longer than
  // the cycle before, so that the motion is continuous. Returns the errors of next().
  Result<void> advance(std::span<const host::JointTarget> targets, Input& input);
  // Duration of the latest cycle of advance(). Initially kPeriod.
  Time duration() const { return duration_; }

 private:
  Context& context_;
  Time cycle_start_;
  Time last_image_;
  Time duration_ = kPeriod;
};

// Returns the log entry of an observation.
PictureRow picture_row(const vision::BallObservation& observation);

// Fails (usage) if the robot lacks one of `joints`; the message lists the missing joints. On a robot other
// than Kaz, the number of a Kaz joint can belong to a different joint. To avoid wrong motions, a behavior
// that uses joints by name must call require_joints() before hold_still().
Result<void> require_joints(const Context& context, std::string_view behavior,
                            std::initializer_list<host::Joint> joints);

// Sets the gains for walking and enables all motors at their present angles. The position gain is 12 per
// radian for the neck, 0.8 for the hands, and 20 for all other joints. The damping gain is 0.15 s per radian.
// Every behavior calls hold_still() before it sends targets.
Result<void> hold_still(host::Robot& robot);

}  // namespace kaz::behavior
