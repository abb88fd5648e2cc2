// A short run of kaz_damage.
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/damage/damage.h"

#include <gtest/gtest.h>

namespace kaz::test {
namespace {

TEST(Damage, PassesNoMoreThanTheCrcAllowsAndMovesNoJointOutOfItsLimits) {
  const DamageReport report = measure_damage(400'000, 1);
  EXPECT_EQ(report.kinds[0].passed, 0u) << "frames with one damaged byte";
  for (const Damage& kind : report.kinds) EXPECT_GT(kind.frames, 90'000u) << kind.name;
  // 300,000 / 65536 = 4.6 are expected; 18 or more come once in a million runs.
  EXPECT_LE(report.passed(), 17u);
  EXPECT_GT(report.ticks_on, report.ticks / 2) << "the joints were not on";
  EXPECT_GT(report.furthest_moved, 1000) << "the joints did not move";
  EXPECT_EQ(report.commands_outside, 0u);
  EXPECT_LE(report.furthest_outside, 200) << "100 urad; a tick at full speed and a step of a code";
}

}  // namespace
}  // namespace kaz::test
