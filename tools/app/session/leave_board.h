// Switches the motors off at the end of a run whose robot object cannot be used.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

// Sends its own requests, because another thread may be in the middle of one. Returns whether the reply
// confirms that the motors are off; nullopt if the board does not reply. `counts` receives the board's
// statistics if it replies.
std::optional<bool> leave_board(const host::RobotBoard& board, host::Clock& clock,
                                Result<kz_statistics_reply>& counts);

}  // namespace kaz::tools
