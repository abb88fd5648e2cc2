// One episode of a campaign.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "tools/kaz/evaluate/campaign.h"

namespace kaz::tools {

// Runs it in this process. A failure leaves its recording in `failures`/NUMBER; a success leaves
// nothing there. The answer is what the campaign keeps of it. Errors: it could not be begun.
Result<nlohmann::ordered_json> run_episode(const CampaignOptions& options, std::uint64_t number,
                                           const std::string& failures);

}  // namespace kaz::tools
