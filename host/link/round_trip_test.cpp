// The retransmission time-out, against RFC 6298's own arithmetic.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/round_trip.h"

#include <gtest/gtest.h>

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

constexpr RoundTrip::Bounds kBounds{50ms, 20ms, 200ms};

TEST(RoundTrip, FirstSampleAndLaterOnes) {
  RoundTrip trip(kBounds);
  EXPECT_EQ(trip.timeout(), 50ms);
  trip.add(16ms);  // SRTT 16, RTTVAR 8: RTO 48
  EXPECT_NEAR(seconds(trip.timeout()), 0.048, 1e-9);
  trip.add(24ms);  // RTTVAR 3/4 * 8 + 1/4 * 8 = 8, SRTT 17: RTO 49
  EXPECT_NEAR(seconds(trip.timeout()), 0.049, 1e-9);
  const RoundTripStatistics& s = trip.statistics();
  EXPECT_EQ(s.count, 2u);
  EXPECT_NEAR(s.min_s, 0.016, 1e-9);
  EXPECT_NEAR(s.mean_s, 0.020, 1e-9);
  EXPECT_NEAR(s.max_s, 0.024, 1e-9);
  EXPECT_NEAR(s.last_s, 0.024, 1e-9);
  EXPECT_NEAR(s.smoothed_s, 0.017, 1e-9);
}

TEST(RoundTrip, StaysWithinItsBounds) {
  RoundTrip trip(kBounds);
  for (int i = 0; i < 100; ++i) trip.add(4ms);
  EXPECT_EQ(trip.timeout(), 20ms);
  trip.add(1s);
  EXPECT_EQ(trip.timeout(), 200ms);
}

TEST(RoundTrip, DoublesUntilAnAnswerComesAtOnce) {
  RoundTrip trip(kBounds);
  for (int i = 0; i < 100; ++i) trip.add(4ms);
  trip.back_off();
  EXPECT_EQ(trip.timeout(), 40ms);
  for (int i = 0; i < 5; ++i) trip.back_off();
  EXPECT_EQ(trip.timeout(), 200ms);
  trip.add(4ms);
  EXPECT_EQ(trip.timeout(), 20ms);
  trip.back_off();
  trip.start_anew();
  EXPECT_EQ(trip.timeout(), 50ms);
}

}  // namespace
}  // namespace kaz::host
