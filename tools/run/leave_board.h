// Switches the motors off at the end of a run whose robot object cannot be used.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

// Uses a separate Requester, because another thread may be in the middle of a request with the robot's
// Requester. Returns whether the board's reply confirms that the motors are off; nullopt if the board does
// not reply. If the board replies, `counts` receives the board's statistics.
std::optional<bool> leave_board(const host::RobotBoard& board, host::Clock& clock,
                                Result<kz_statistics_reply>& counts);

}  // namespace kaz::tools
