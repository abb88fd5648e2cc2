// Runs the servo firmware under the same load as in a walking robot. All control loops run, and the host
// sends targets and queries at 100 Hz.
// SPDX-License-Identifier: Apache-2.0
//
// Measurements of the tick's duration and of the emulator's speed use this load. A simple model without
// physics turns the potentiometers with the motors and thereby closes the control loops.
#pragma once

#include <array>
#include <cstdint>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

class WalkingLoad {
 public:
  // Sets the analog source of `mcu`. `mcu` must outlive this object. Do not run `mcu` after this object is
  // destroyed.
  explicit WalkingLoad(Mcu& mcu);
  WalkingLoad(const WalkingLoad&) = delete;
  WalkingLoad& operator=(const WalkingLoad&) = delete;

  // Runs the first 600 ms. At 100 ms the motors are switched on, and at 110 ms the robot begins to walk.
  // Returns the errors of Mcu::run_until().
  Result<void> start();
  // Runs one millisecond. Every 10 ms, the host sends targets for all joints; 7 ms later, the host queries
  // the states of the joints. Returns the errors of Mcu::run_until().
  Result<void> millisecond();

  std::int64_t bytes_to_board() const { return bytes_to_board_; }
  std::int64_t bytes_from_board() const { return bytes_from_board_; }
  // Returns the absolute difference between the angle of a joint and the joint's most recent target, rad.
  double error(int joint) const;

 private:
  void send(std::uint8_t type, const std::uint8_t* fields, std::uint8_t size);
  void send_targets();
  void move_joints();

  Mcu& mcu_;
  std::array<double, KZ_ANALOG> inputs_{};  // voltages as fractions of AVCC
  std::array<std::int16_t, KZ_JOINTS> targets_{};
  std::int64_t milliseconds_ = 0;
  States wire_free_ = 0;
  std::uint8_t sequence_ = 0;
  std::int64_t bytes_to_board_ = 0, bytes_from_board_ = 0;
};

}  // namespace kaz::sim
