// For tests: a Robot connected to the test board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <utility>

#include "host/link/board_testing.h"
#include "host/robot/robot.h"

namespace kaz::host {

// Throws std::runtime_error if the board cannot be identified. `board` must outlive the robot.
inline Robot connect_to(TestBoard& board) {
  auto robot = Robot::connect(board, board);
  if (!robot) throw std::runtime_error(robot.error().message);
  return std::move(*robot);
}

}  // namespace kaz::host
