// Replaces a file name in the setting `balance` of go-forward by the weights in the file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Keeps `none`, `learned` and weights. Otherwise reads the named file and stores its weights as the setting,
// so that a recording or another machine does not depend on the file. Does nothing for other behaviors. Fails
// (usage) if the file cannot be read or contains no weights.
Result<void> load_balance(const std::string& behavior,
                          std::map<std::string, std::string>& settings);

}  // namespace kaz::tools
