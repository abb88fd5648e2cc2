// Pairs by time: free-running cameras, other rates, lost pictures, clocks that jump.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/stereo_pairing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "shared/base/random.hpp"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

RawFrame at(Time t) {
  return {t, {}};
}

std::vector<RawPair> all(StereoPairing& pairing) {
  std::vector<RawPair> pairs;
  while (auto pair = pairing.next()) pairs.push_back(std::move(*pair));
  return pairs;
}

TEST(StereoPairing, PairsTheNearestOfFreeRunningCameras) {
  // Every phase between two cameras of one rate, each with a millisecond of jitter: with a tolerance
  // of half an interval all pictures but those at the ends find a partner, and the nearest one.
  for (int phase_ms = -16; phase_ms <= 16; ++phase_ms) {
    StereoPairing pairing(17ms);
    std::vector<Time> left, right;
    for (int i = 0; i < 100; ++i) {
      left.push_back(i * 34ms);
      right.push_back(i * 34ms + phase_ms * 1ms);
    }
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < 100; ++i) {
      pairing.add(EyeSide::left, at(left[i]));
      pairing.add(EyeSide::right, at(right[i]));
      for (const RawPair& pair : all(pairing)) {
        ++pairs;
        const Time nearest = *std::ranges::min_element(
            right, {}, [&](Time t) { return std::chrono::abs(t - pair.left.exposure); });
        EXPECT_EQ(pair.right.exposure, nearest);
        EXPECT_EQ(pair.gap(), std::chrono::abs(phase_ms * 1ms));
        EXPECT_EQ(pair.exposure(), pair.left.exposure + phase_ms * 500us);
      }
    }
    EXPECT_EQ(pairs, 100u);
  }
}

TEST(StereoPairing, WhatHasNoPartnerIsDroppedAndCounted) {
  StereoPairing pairing(5ms);
  for (int i = 0; i < 30; ++i) pairing.add(EyeSide::left, at(i * 10ms));  // three times as often
  EXPECT_TRUE(all(pairing).empty());
  for (int i = 24; i < 30; i += 3) pairing.add(EyeSide::right, at(i * 10ms + 1ms));
  EXPECT_EQ(all(pairing).size(), 2u);
  EXPECT_EQ(pairing.without_partner(EyeSide::left),
            26u);  // all before 27 but 24; 28, 29 still wait
  EXPECT_EQ(pairing.without_partner(EyeSide::right), 0u);
  pairing.add(EyeSide::right, at(400ms));
  EXPECT_TRUE(all(pairing).empty());
  EXPECT_EQ(pairing.without_partner(EyeSide::left), 28u);
}

TEST(StereoPairing, ANearerPictureThatIsThereIsTaken) {
  StereoPairing pairing(20ms);
  pairing.add(EyeSide::left, at(0ms));
  pairing.add(EyeSide::left, at(15ms));
  pairing.add(EyeSide::right, at(16ms));
  const auto pairs = all(pairing);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].left.exposure, Time(15ms));
  EXPECT_EQ(pairing.without_partner(EyeSide::left), 1u);
}

TEST(StereoPairing, AClockThatJumpsBackGivesNoOldPairs) {
  StereoPairing pairing(5ms);
  pairing.add(EyeSide::left, at(100ms));
  pairing.add(EyeSide::right, at(101ms));
  EXPECT_EQ(all(pairing).size(), 1u);
  pairing.add(EyeSide::left, at(100ms));
  pairing.add(EyeSide::left, at(33ms));
  pairing.add(EyeSide::right, at(33ms));
  EXPECT_TRUE(all(pairing).empty());
  EXPECT_EQ(pairing.out_of_order(EyeSide::left), 2u);
  EXPECT_EQ(pairing.out_of_order(EyeSide::right), 1u);
}

TEST(StereoPairing, AnyOrderOfPicturesGivesOrderedPairsWithinTheTolerance) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Time tolerance(static_cast<std::int64_t>(random.next() % 20) * 1'000'000);
    StereoPairing pairing(tolerance);
    std::size_t added = 0, paired = 0;
    Time last = Time::min();
    for (int i = 0; i < 300; ++i) {
      const EyeSide side = random.next() % 3 == 0 ? EyeSide::left : EyeSide::right;
      const Time t(static_cast<std::int64_t>(i * 5 + random.next() % 40) * 1'000'000);
      pairing.add(side, at(t));
      ++added;
      for (const RawPair& pair : all(pairing)) {
        EXPECT_LE(pair.gap(), tolerance);
        EXPECT_GT(pair.exposure(), last);
        last = pair.exposure();
        ++paired;
      }
    }
    std::uint64_t gone = 0;
    for (const EyeSide side : {EyeSide::left, EyeSide::right})
      gone += pairing.without_partner(side) + pairing.out_of_order(side);
    // Each picture is in a pair, counted, or still waits; those that wait are of one side.
    EXPECT_LE(2 * paired + gone, added);
    EXPECT_LE(added, 2 * paired + gone + StereoPairing::kMostWaiting);
  }
}

}  // namespace
}  // namespace kaz::host
