// The short form of the campaign: ./tools/dev study flash-campaign has the whole one.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/system/flash/campaign.h"

namespace kaz::flash_test {
namespace {

// Five seeds each, so that the cases run side by side.
class FlashCampaign : public testing::TestWithParam<int> {};

TEST_P(FlashCampaign, NeverABoardLostNeverAFalseSuccess) {
  const std::uint64_t first = 1001 + 5 * static_cast<std::uint64_t>(GetParam());
  for (std::uint64_t seed = first; seed < first + 5; ++seed) {
    const CampaignRun run = campaign_run(seed, KAZ_FIRMWARE_IMAGE, KAZ_WRITER);
    EXPECT_EQ(run.fault, "") << run.text;
  }
}

INSTANTIATE_TEST_SUITE_P(ThirtyRuns, FlashCampaign, testing::Range(0, 6));

}  // namespace
}  // namespace kaz::flash_test
