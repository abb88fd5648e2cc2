// Replaces the file name in the setting `balance` of go-forward by the weights in that file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Leaves the values `none` and `learned`, and values that are weights, unchanged. Any other value is the name
// of a file: the weights in this file replace the value. So a recording, or a run on another machine, does
// not depend on the file. Does nothing for other behaviors. Fails (usage) if the file cannot be read or
// contains no weights.
Result<void> load_balance(const std::string& behavior,
                          std::map<std::string, std::string>& settings);

}  // namespace kaz::tools
