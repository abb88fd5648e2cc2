// Interpolation and forgetting of postures.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/posture_history.h"

#include <gtest/gtest.h>

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

Posture posture(Time time, double angle, std::uint32_t tick = 0) {
  Posture p;
  p.time = time;
  p.tick = tick;
  p.angle.fill(angle);
  return p;
}

TEST(PostureHistory, InterpolatesLinearly) {
  PostureHistory history;
  history.add(posture(100ms, 1.0, 1));
  history.add(posture(120ms, 2.0, 2));
  const auto at = history.at(105ms);
  ASSERT_TRUE(at);
  EXPECT_DOUBLE_EQ(at->angle[3], 1.25);
  EXPECT_EQ(at->tick, 1u);
  EXPECT_EQ(history.at(115ms)->tick, 2u);
  EXPECT_DOUBLE_EQ(history.at(120ms)->angle[0], 2.0);
  EXPECT_DOUBLE_EQ(history.at(100ms)->angle[0], 1.0);
}

TEST(PostureHistory, KnowsNothingOutsideOrFarFromStates) {
  PostureHistory history;
  EXPECT_FALSE(history.at(0ms));
  EXPECT_FALSE(history.newest());
  history.add(posture(1000ms, 0));
  history.add(posture(1500ms, 0));
  EXPECT_FALSE(history.at(999ms));
  EXPECT_FALSE(history.at(1501ms));
  EXPECT_TRUE(history.at(1100ms));
  EXPECT_FALSE(history.at(1101ms));
  EXPECT_TRUE(history.at(1400ms));
}

TEST(PostureHistory, ForgetsAfterFiveSeconds) {
  PostureHistory history;
  for (int i = 0; i <= 600; ++i) history.add(posture(i * 10ms, i));
  EXPECT_FALSE(history.at(995ms));
  EXPECT_TRUE(history.at(1000ms));
}

TEST(PostureHistory, ANewClockReplacesWhatItContradicts) {
  PostureHistory history;
  for (int i = 0; i <= 10; ++i) history.add(posture(i * 10ms, 1));
  history.add(posture(75ms, 5));
  EXPECT_EQ(history.newest(), 75ms);
  EXPECT_DOUBLE_EQ(history.at(72500us)->angle[0], 3.0);
}

}  // namespace
}  // namespace kaz::host
