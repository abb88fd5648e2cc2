// Options of `kaz evaluate` that would draw nothing for the behaviour and the worlds they are given with.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

// `given`: names on the command line, as "--obstacles". Errors (usage): the first one that has no effect, and
// what it is for.
Result<void> check_given(const CampaignOptions& options, const std::vector<std::string>& given);

}  // namespace kaz::tools
