// What a bench can do to a board besides talking to it: supply, sensors, line errors, power.
// SPDX-License-Identifier: Apache-2.0
//
// A virtual board has it all; a real one on a desk usually none of it. Cases that need a bench say so
// and are reported as left out where there is none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "shared/base/result.hpp"

namespace kaz::hil {

class Bench {
 public:
  virtual ~Bench() = default;

  // No fault injected, every joint at 0 rad and free to turn, power on.
  virtual void restore() = 0;
  // Pulses the RES pin.
  virtual void reset() = 0;
  virtual void set_power(bool on) = 0;

  // Holds an analogue input (multiplexer * 8 + input, shared/board/board.h) at a code 0..1023;
  // empty: as the board makes it.
  virtual void set_analog(int input, std::optional<int> code) = 0;
  // Turns a joint's shaft by hand, rad in the joint's own sense.
  virtual void place_joint(int joint, double angle_rad) = 0;
  // The shaft is held fast.
  virtual void block_joint(int joint, bool blocked) = 0;

  // Bytes for the board, each with a framing error.
  virtual void write_damaged(std::span<const std::uint8_t> bytes) = 0;

  // Present drive of a joint's motor, -1..1, positive turns the joint positively; 0 while
  // the motor drivers are disabled.
  virtual double drive(int joint) const = 0;
  virtual double angle_rad(int joint) const = 0;
};

}  // namespace kaz::hil
