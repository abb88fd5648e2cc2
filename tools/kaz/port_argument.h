// The option --port PATH[@BAUD].
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Path and baud rate, 115200 if none is given. Error (usage): the rate is none.
Result<std::pair<std::string, int>> parse_port(const std::string& text);

}  // namespace kaz::tools
