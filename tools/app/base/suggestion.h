// Suggestion of a name for a mistyped one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kaz::tools {

// Returns "; did you mean --duration?", or "" if no name is similar: an edit distance of at most 2, or a name
// that starts with `given`.
std::string suggestion(std::string_view given, const std::vector<std::string>& names);

}  // namespace kaz::tools
