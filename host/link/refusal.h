// Sentences for what a board refuses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "host/robot/robot.h"

namespace kaz::host {

// `targets`: those of the refused request, to name the value; empty for other requests.
Error refusal_error(const kz_refused& refusal, std::span<const JointTarget> targets);

}  // namespace kaz::host
