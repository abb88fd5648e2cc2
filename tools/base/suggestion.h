// Suggests the correct spelling of a mistyped name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kaz::tools {

// Returns a text such as "; did you mean --duration?", or "" if no name is similar to `given`. A name is
// similar if its edit distance from `given` is at most 2, or if the name starts with `given`.
std::string suggestion(std::string_view given, const std::vector<std::string>& names);

}  // namespace kaz::tools
