// The short form: every kind of event, a few times.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/campaign/campaign.h"

#include <gtest/gtest.h>

namespace kaz::campaign {
namespace {

TEST(Campaign, TheRobotIsSafeAndComesBack) {
  Options options;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.world_path = KAZ_WORLD;
  options.robot_path = KAZ_ROBOT "/kaz.urdf";
  options.camera_path = KAZ_ROBOT "/camera.json";
  options.rounds = 30;
  const auto report = run_campaign(options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->passed()) << report->text();
  EXPECT_GE(report->tallies.size(), 8u) << report->text();
}

}  // namespace
}  // namespace kaz::campaign
