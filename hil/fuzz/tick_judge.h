// Judge of the servo's ticks: what must hold in each, whatever the host has sent.
// SPDX-License-Identifier: Apache-2.0
//
// Looks at the state of shared/servo and at what the tick gives to the pins; so it needs an engine
// in this
// process. It knows joints.def and the protocol's frames, but none of the servo's code.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "shared/servo/servo.h"

namespace kaz::hil::fuzz {

// High counts of each joint's motor, positive turns the joint positively; 0 while the drivers are
// off.
std::array<int, KZ_JOINTS> drives_of(const kz_tick_output& output);

class TickJudge {
 public:
  // The board starts again with its next tick.
  void restart() { started_ = false; }
  // After a tick: what went in, what came out, the state behind it.
  void tick(const kz_tick_input& input, const kz_servo& servo, const kz_tick_output& output);

  const std::optional<std::string>& violation() const { return violation_; }
  long long ticks() const { return ticks_; }
  // States of the board that were reached: shutdown, what is on, what is in progress.
  const std::set<std::uint32_t>& features() const { return features_; }

 private:
  struct Before {
    bool on = false;
    int command = 0;
    int lower = 0, upper = 0;
    int above_ticks = 0, below_ticks = 0;  // at or beyond a limit for so long
    int ramp = 0;                          // highest that applied since the present ramp began
  };

  void judge_requests(const kz_tick_input& input, const kz_servo& servo);
  void judge_outputs(const kz_servo& servo, const kz_tick_output& output);
  void judge_limit(const kz_servo& servo, int number, int drive);
  void judge_joint(const kz_servo& servo, int number);
  void note_features(const kz_servo& servo);
  void wrong(const kz_servo& servo, int joint, const std::string& what);

  bool started_ = false;
  kz_receiver receiver_{};  // of the bytes that the ticks got
  unsigned refusals_ = 0;   // of the servo, before the tick
  std::array<Before, KZ_JOINTS> before_{};
  long long ticks_ = 0;
  std::set<std::uint32_t> features_;
  std::optional<std::string> violation_;
};

}  // namespace kaz::hil::fuzz
