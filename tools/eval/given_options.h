// Rejects options of `kaz evaluate` that have no effect for the given behavior and worlds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/eval/campaign.h"

namespace kaz::tools {

// Options that are only valid for behaviors on a course (behavior::Stage). Use course_behaviors() for their
// help texts: it returns the names of these behaviors, separated by commas.
inline constexpr std::string_view kCourseOptions[] = {"--worlds", "--density", "--obstacles",
                                                      "--goal-distance"};
std::string course_behaviors();

// `given`: names of the options on the command line, for example "--obstacles". If an option has no effect,
// fails (usage) for the first such option. The message states the purpose of that option.
Result<void> check_given(const CampaignOptions& options, const std::vector<std::string>& given);

}  // namespace kaz::tools
