// The random conversations of the wire comparison.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/wire_host.h"

#include <gtest/gtest.h>

#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

std::vector<SerialByte> second_of(WireHost& host, const WireWindows& windows) {
  std::vector<SerialByte> all;
  for (States at = 0; at < 1000 * kMs; at += kMs) {
    for (const SerialByte& byte : host.bytes(at, at + kMs, windows)) {
      EXPECT_GE(byte.at, at);
      EXPECT_LT(byte.at, at + kMs);
      all.push_back(byte);
    }
    host.take_event(at);
  }
  return all;
}

TEST(WireHost, KeepsToTheLineAndLeavesTheWindowsFree) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    WireHost host(seed);
    const auto bytes = second_of(host, {true, 100, 20 * kMs, 25 * kMs});
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i > 0) {
        ASSERT_GE(bytes[i].at - bytes[i - 1].at, KZ_STATES_PER_BYTE);
      }
      const States since = (bytes[i].at - 100 + kMs) % kMs;
      EXPECT_FALSE(since > 300 && since < 1000) << since;
      EXPECT_FALSE(bytes[i].at > 20 * kMs && bytes[i].at < 25 * kMs);
    }
    EXPECT_GE(host.requests(), 20);
  }
}

// Also where the board starts, and the frames before it had to wait.
TEST(WireHost, RequestsThatTakeTheBoardAwayStandAlone) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    WireHost host(seed);
    std::vector<SerialByte> bytes = second_of(host, {true, 100, 300 * kMs, 500 * kMs});
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    States store_ended = 0;
    for (const SerialByte& byte : bytes) {
      if (store_ended != 0) {
        EXPECT_GE(byte.at - store_ended, 25 * kMs) << "seed " << seed;
      }
      const bool whole = kz_receive(&receiver, byte.value, byte.framing_error) == KZ_RECEIVE_FRAME;
      store_ended = whole && receiver.body[1] == KZ_TYPE_store_calibration ? byte.at : 0;
    }
  }
}

TEST(WireHost, SaysAllThatTheGrammarHas) {
  std::map<std::string, std::int64_t> kinds;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    WireHost host(seed);
    second_of(host, {});
    for (const auto& [kind, count] : host.kinds()) kinds[kind] += count;
  }
  for (const char* kind : {"polite", "back to back", "damaged", "in pieces", "framing errors",
                           "repeated", "silences", "to all boards", "to other addresses",
                           "store_calibration", "set_address", "reset", "loader"})
    EXPECT_GT(kinds[kind], 0) << kind;
}

TEST(WireHost, SameSeedSameBytes) {
  const auto values = [](std::uint64_t seed) {
    WireHost host(seed);
    std::vector<std::pair<int, States>> all;
    for (const SerialByte& byte : second_of(host, {})) all.emplace_back(byte.value, byte.at);
    return all;
  };
  EXPECT_EQ(values(3), values(3));
  EXPECT_NE(values(3), values(4));
}

}  // namespace
}  // namespace kaz::sim
