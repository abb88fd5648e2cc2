// The setting `balance` of go-forward: weights of a file become the setting itself.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

// `none`, `learned` and weights stay; else it is a file, whose weights take its place, so that what is
// recorded, evaluated or run elsewhere does not depend on the file any more. Nothing for other behaviours.
// Errors (usage): the file cannot be read, or holds no weights.
Result<void> load_balance(const std::string& behavior,
                          std::map<std::string, std::string>& settings);

}  // namespace kaz::tools
