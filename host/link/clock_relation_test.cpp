// The relation of the clocks: its bound holds, and is as tight as its header says.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/clock_relation.h"

#include <gtest/gtest.h>

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

// Hand-made: request of 10 bytes and reply of 20 at 100 us a byte, tick 50 at 7 ms.
TEST(ClockRelation, OneExchange) {
  ClockRelation relation(100us);
  EXPECT_FALSE(relation.known());
  // Arrives at 1 ms + 1 ms = 2 ms at the earliest; the reply left at 12 ms - 2 ms = 10 ms at the
  // latest, so the tick began at 9 ms at the latest.
  relation.add({.sent = 1ms, .received = 12ms, .bytes_out = 10, .bytes_in = 20, .tick = 50});
  ASSERT_TRUE(relation.known());
  EXPECT_EQ(relation.host_time(50), 5500us);
  EXPECT_EQ(relation.error_bound(), 3500us);
  EXPECT_EQ(relation.host_time(60), 15500us);
  EXPECT_EQ(relation.host_time(49), 4500us);
}

TEST(ClockRelation, IntersectsAndAges) {
  ClockRelation relation(0us);
  relation.add({.sent = 0ms, .received = 11ms, .bytes_out = 1, .bytes_in = 1, .tick = 100});
  // Tick 100 in 0..10 ms. One second later tick 1100 in 1004..1014 ms: together 1004..1010, and 200
  // ppm of the 1.004 s between the two answers more above.
  relation.add({.sent = 1004ms, .received = 1015ms, .bytes_out = 1, .bytes_in = 1, .tick = 1100});
  EXPECT_NEAR(seconds(relation.host_time(1100)), (1.004 + 1.010 + 200e-6 * 1.004) / 2, 1e-8);
  EXPECT_NEAR(seconds(relation.error_bound()), (0.006 + 200e-6 * 1.004) / 2, 1e-8);
  EXPECT_EQ(relation.restarts(), 0);
}

TEST(ClockRelation, StartsAnewAfterAReset) {
  ClockRelation relation(0us);
  relation.add({.sent = 0ms, .received = 3ms, .bytes_out = 1, .bytes_in = 1, .tick = 5000});
  relation.add({.sent = 100ms, .received = 103ms, .bytes_out = 1, .bytes_in = 1, .tick = 20});
  EXPECT_EQ(relation.restarts(), 1);
  EXPECT_EQ(relation.host_time(20), 101ms);
}

TEST(ClockRelation, CounterWraps) {
  ClockRelation relation(0us);
  relation.add({.sent = 10ms, .received = 13ms, .bytes_out = 1, .bytes_in = 1, .tick = 0xFFFFFFFF});
  EXPECT_EQ(relation.host_time(4), 16ms);
  relation.add({.sent = 15ms, .received = 18ms, .bytes_out = 1, .bytes_in = 1, .tick = 4});
  EXPECT_EQ(relation.restarts(), 0);
  EXPECT_EQ(relation.host_time(0xFFFFFFFF), 11ms);
}

}  // namespace
}  // namespace kaz::host
