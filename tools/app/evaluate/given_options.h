// Rejects options of `kaz evaluate` that have no effect for the given behavior and worlds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

// `given`: option names on the command line, as "--obstacles". Fails (usage) for the first option without
// effect; the message states its purpose.
Result<void> check_given(const CampaignOptions& options, const std::vector<std::string>& given);

}  // namespace kaz::tools
