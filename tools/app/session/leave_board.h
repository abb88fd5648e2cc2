// Motors off at the end of a run whose own requests are out of reach.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

// By requests of its own: another thread may be in the midst of one. Whether the board's reply confirms
// that its motors are off; nothing: it does not answer. `counts`: the board's own, where it answers.
std::optional<bool> leave_board(const host::RobotBoard& board, host::Clock& clock,
                                Result<kz_statistics_reply>& counts);

}  // namespace kaz::tools
