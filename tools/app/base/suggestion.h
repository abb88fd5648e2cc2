// The name that a mistyped one was meant to be.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kaz::tools {

// "; did you mean --duration?", or nothing where no name is near. The beginning of a name is near.
std::string suggestion(std::string_view given, const std::vector<std::string>& names);

}  // namespace kaz::tools
