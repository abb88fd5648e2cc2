// Walking for behaviors. In each control cycle, Walker sends the leg targets of Motion, together with the
// behavior's targets for other joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "host/behavior/control_cycle.h"
#include "host/motion/motion.h"

namespace kaz::behavior {

class Walker {
 public:
  // Enables the motors and moves slowly into the crouch for walking. If the board has a gyro and
  // Settings::use_gyro is true, the robot stands still in the crouch until the gyro is zeroed. The call takes
  // 2 to 8 s. Fails if robot or clock fail. Also fails (usage) for a robot other than Kaz. The context must
  // outlive the returned object.
  static Result<Walker> begin(Context& context, std::string_view behavior,
                              const motion::Settings& settings = {});

  motion::Motion& motion() { return motion_; }
  const motion::Motion& motion() const { return motion_; }
  // Posture and observations of the latest cycle.
  const ControlCycle::Input& input() const { return input_; }
  void phase(std::string_view phase) { context_->sink.phase(input_.now, behavior_, phase); }

  // Runs one control cycle with the leg targets of Motion and the targets `others` (head, arms). If the robot
  // falls, the motors are disabled and fallen() returns true.
  Result<void> step(std::span<const host::JointTarget> others = {});
  // Runs step() until Motion is idle or the robot has fallen, then stands for 0.5 s.
  Result<void> finish();

  bool fallen() const { return motion_.state() == motion::State::fallen; }

 private:
  Walker(Context& context, std::string_view behavior, const motion::Settings& settings);
  Result<void> crouch();
  Result<void> stay(Time duration);

  Context* context_;
  std::string_view behavior_;
  motion::Motion motion_;
  ControlCycle cycle_;
  ControlCycle::Input input_;
};

}  // namespace kaz::behavior
