// What comes into the chip from outside, told to whoever wants to play it again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "sim/h8s/chip.h"

namespace kaz::h8s {

// History implements this; Chip::set_input_log connects it.
class InputLog {
 public:
  virtual ~InputLog() = default;
  // About to be applied at the boundary now(): pins, bytes received, reset, poke, set_registers.
  virtual void input(std::function<void(Chip&)> apply) = 0;
  // Something that cannot be played again: load, power_on, restore, or an input from inside a
  // listener, in the middle of an instruction.
  virtual void cut() = 0;
  // The analog source was asked and gave `value`.
  virtual void sampled(int channel, States at, double value) = 0;
};

}  // namespace kaz::h8s
