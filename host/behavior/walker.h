// The body as behaviours walk it: Motion's legs in each beat, beside whatever else is to move.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "host/behavior/control_cycle.h"
#include "host/motion/motion.h"

namespace kaz::behavior {

class Walker {
 public:
  // Motors on; slowly into the crouch that walking starts from, and there long enough for the gyro's
  // zero, if the board has one: 2 to 8 s. Fails as robot and clock do, and (usage) for a robot that is
  // no Kaz.
  static Result<Walker> begin(Context& context, std::string_view behavior,
                              const motion::Settings& settings = {});

  motion::Motion& motion() { return motion_; }
  const motion::Motion& motion() const { return motion_; }
  // The newest beat: posture and what was seen.
  const ControlCycle::Input& input() const { return input_; }
  void phase(std::string_view phase) { context_->sink.phase(input_.now, behavior_, phase); }

  // One beat: legs as Motion has them, and these joints besides (head, arms). A fall switches the
  // motors off, and motion().state() says so.
  Result<void> step(std::span<const host::JointTarget> others = {});
  // Beats until Motion has nothing left to do or has fallen, then half a second of standing.
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
  Time beat_ = ControlCycle::kPeriod;  // how long the last one was
};

}  // namespace kaz::behavior
