// Rejects options of `kaz evaluate` that have no effect for the given behavior and worlds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/eval/campaign.h"

namespace kaz::tools {

// `given`: names of the options on the command line, for example "--obstacles". If an option has no effect,
// fails (usage) for the first such option. The message states the purpose of that option.
Result<void> check_given(const CampaignOptions& options, const std::vector<std::string>& given);

}  // namespace kaz::tools
