// Checks rules that each tick of the servo code must obey, no matter which bytes the host sends.
// SPDX-License-Identifier: Apache-2.0
//
// The judge reads the state of shared/servo and the pin outputs of each tick. Therefore shared/servo must run
// in the same process as the judge. The judge uses joints.def and the protocol's frames, but no code of
// shared/servo.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "shared/servo/servo.h"

namespace kaz::hil::fuzz {

// Returns the PWM counts of each joint's motor; positive counts turn the joint in the positive direction. The
// counts are 0 while the motor drivers are off.
std::array<int, KZ_JOINTS> drives_of(const kz_tick_output& output);

class TickJudge {
 public:
  // Must be called before the first tick after a restart of the board.
  void restart() { started_ = false; }
  // Checks a tick. `input` and `output` are the input and output of the tick, `servo` is the state after the
  // tick.
  void tick(const kz_tick_input& input, const kz_servo& servo, const kz_tick_output& output);

  const std::optional<std::string>& violation() const { return violation_; }
  long long ticks() const { return ticks_; }
  // Returns a code for each kind of board state reached so far. A kind of state combines several conditions,
  // such as the shutdown reason, the number of enabled joints and the operations in progress.
  const std::set<std::uint32_t>& features() const { return features_; }

 private:
  struct Before {
    bool on = false;
    int command = 0;
    int lower = 0, upper = 0;
    // `above_ticks`: number of consecutive ticks in which the joint was at or above its upper limit.
    // `below_ticks`: number of consecutive ticks in which the joint was at or below its lower limit.
    int above_ticks = 0, below_ticks = 0;
    // Highest `ramp_limit` of the joint since the present ramp began.
    int ramp = 0;
  };

  void judge_requests(const kz_tick_input& input, const kz_servo& servo);
  void judge_outputs(const kz_servo& servo, const kz_tick_output& output);
  void judge_limit(const kz_servo& servo, int number, int drive);
  void judge_joint(const kz_servo& servo, int number);
  void note_features(const kz_servo& servo);
  void wrong(const kz_servo& servo, int joint, const std::string& what);

  bool started_ = false;
  kz_receiver receiver_{};  // decodes the bytes received in the ticks
  unsigned refusals_ = 0;   // kz_servo::refusals before the tick
  std::array<Before, KZ_JOINTS> before_{};
  long long ticks_ = 0;
  std::set<std::uint32_t> features_;
  std::optional<std::string> violation_;
};

}  // namespace kaz::hil::fuzz
