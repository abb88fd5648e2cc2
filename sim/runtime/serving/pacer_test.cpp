// The arithmetic of pacing, with a clock of our own.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/pacer.h"

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

using std::chrono::milliseconds;

TEST(Pacer, WaitsForTheWallClock) {
  Pacer pacer(milliseconds(20));
  pacer.start(milliseconds(0), milliseconds(1000));
  EXPECT_EQ(pacer.step_done(milliseconds(1), Time(1000'200'000)), Time(800'000));
  EXPECT_EQ(pacer.wall_of(milliseconds(500)), milliseconds(1500));
  EXPECT_EQ(pacer.overruns(), 0u);
}

TEST(Pacer, CatchesUpAfterAShortDelay) {
  Pacer pacer(milliseconds(20));
  pacer.start(milliseconds(0), milliseconds(0));
  EXPECT_EQ(pacer.step_done(milliseconds(1), milliseconds(16)), Time(0));
  EXPECT_EQ(pacer.worst_late(), milliseconds(15));
  // Fifteen steps without waiting, and the world is on time again.
  for (int t = 2; t <= 16; ++t)
    EXPECT_EQ(pacer.step_done(milliseconds(t), milliseconds(16)), Time(0));
  EXPECT_EQ(pacer.step_done(milliseconds(17), milliseconds(16)), milliseconds(1));
  EXPECT_EQ(pacer.overruns(), 0u);
  EXPECT_EQ(pacer.lost(), Time(0));
}

TEST(Pacer, DoesNotRunAfterALongStall) {
  Pacer pacer(milliseconds(20));
  pacer.start(milliseconds(0), milliseconds(0));
  EXPECT_EQ(pacer.step_done(milliseconds(1), milliseconds(301)), Time(0));
  EXPECT_EQ(pacer.overruns(), 1u);
  EXPECT_EQ(pacer.lost(), milliseconds(300));
  // The next step is due one millisecond later, not 300 ms ago.
  EXPECT_EQ(pacer.step_done(milliseconds(2), milliseconds(301)), milliseconds(1));
  EXPECT_EQ(pacer.wall_of(milliseconds(2)), milliseconds(302));
}

// Continued after a stop, the process may report before its next step is done.
TEST(Pacer, AStopCountsBeforeItsStepIsDone) {
  Pacer pacer(milliseconds(20));
  pacer.start(milliseconds(0), milliseconds(0));
  pacer.step_done(milliseconds(1), milliseconds(1));
  EXPECT_EQ(pacer.lost_until(milliseconds(1), milliseconds(21)), Time(0));
  EXPECT_EQ(pacer.lost_until(milliseconds(1), milliseconds(2001)), milliseconds(2000));
  pacer.step_done(milliseconds(2), milliseconds(2002));
  EXPECT_EQ(pacer.lost_until(milliseconds(2), milliseconds(2003)), milliseconds(2000));
}

TEST(Pacer, ToleranceItselfIsNoOverrun) {
  Pacer pacer(milliseconds(20));
  pacer.start(milliseconds(0), milliseconds(0));
  pacer.step_done(milliseconds(1), milliseconds(21));
  EXPECT_EQ(pacer.overruns(), 0u);
  pacer.step_done(milliseconds(1), milliseconds(21) + Time(1));
  EXPECT_EQ(pacer.overruns(), 1u);
}

}  // namespace
}  // namespace kaz::sim
