// The servo firmware's walking load: all loops closed, targets sent and states queried at 100 Hz.
// SPDX-License-Identifier: Apache-2.0
//
// The load under which the cost of a tick and the emulator's speed are measured. Potentiometers follow the
// motors by the simplest model that closes the loops; there is no physics.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

class WalkingLoad {
 public:
  // Takes over the analog inputs of `mcu`, which must outlive it.
  explicit WalkingLoad(Mcu& mcu);
  WalkingLoad(const WalkingLoad&) = delete;
  WalkingLoad& operator=(const WalkingLoad&) = delete;

  // Runs from power-on to walking: 100 ms of start-up, motors on, half a second of steps.
  Result<void> start();
  // Runs one millisecond. Once in ten the host sends targets for all joints, waits for the reply, and
  // queries their states.
  Result<void> millisecond();

  std::int64_t bytes_to_board() const { return bytes_to_board_; }
  std::int64_t bytes_from_board() const { return bytes_from_board_; }
  // Distance of a joint from its target of the last step, rad.
  double error(int joint) const;

 private:
  void send(std::uint8_t type, const std::uint8_t* fields, std::uint8_t size);
  void send_targets();
  void move_joints();

  Mcu& mcu_;
  std::array<double, KZ_ANALOG> inputs_{};  // fractions of AVCC
  std::array<std::int16_t, KZ_JOINTS> targets_{};
  std::int64_t milliseconds_ = 0;
  States wire_free_ = 0;
  std::uint8_t sequence_ = 0;
  std::int64_t bytes_to_board_ = 0, bytes_from_board_ = 0;
};

}  // namespace kaz::sim
