// Interface to the surroundings of a board: supply, sensors, line errors, power.
// SPDX-License-Identifier: Apache-2.0
//
// A virtual board has a bench; a real board on a desk usually has no bench. A case that needs a bench
// declares this requirement. Without a bench, these cases are reported as left out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "shared/base/result.hpp"

namespace kaz::hil {

class Bench {
 public:
  virtual ~Bench() = default;

  // Removes all faults, places every joint at 0 rad with the shaft free to turn, and switches the power on.
  virtual void restore() = 0;
  // Pulses the RES pin.
  virtual void reset() = 0;
  virtual void set_power(bool on) = 0;

  // Holds an analog input at a code from 0 to 1023; nullopt releases the input. `input` is the index of the
  // analog input in kz_tick_input.analog (shared/board/board.h).
  virtual void set_analog(int input, std::optional<int> code) = 0;
  // Turns a joint's shaft by hand to an angle, rad in the joint's positive direction.
  virtual void place_joint(int joint, double angle_rad) = 0;
  // Blocks the shaft of a joint, or releases the shaft.
  virtual void block_joint(int joint, bool blocked) = 0;

  // Sends bytes to the board, each with a framing error.
  virtual void write_damaged(std::span<const std::uint8_t> bytes) = 0;

  // Returns the present drive of a joint's motor, -1 to 1; a positive drive turns the joint in the positive
  // direction. The result is 0 while the motor drivers are disabled.
  virtual double drive(int joint) const = 0;
  virtual double angle_rad(int joint) const = 0;
};

}  // namespace kaz::hil
