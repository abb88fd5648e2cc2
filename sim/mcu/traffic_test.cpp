// The random host and its joints.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/traffic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

std::vector<SerialByte> minute(std::uint64_t seed) {
  RandomHost host(seed);
  std::vector<SerialByte> all;
  for (int t = 0; t < 60000; ++t)
    for (const SerialByte& byte : host.millisecond(t * States{KZ_STATES_PER_TICK}))
      all.push_back(byte);
  return all;
}

TEST(RandomHost, KeepsToTheSpeedOfTheWire) {
  const auto bytes = minute(1);
  ASSERT_GT(bytes.size(), 10000u);
  for (std::size_t i = 1; i < bytes.size(); ++i)
    ASSERT_GE(bytes[i].at - bytes[i - 1].at, KZ_STATES_PER_BYTE);
}

TEST(RandomHost, SendsEveryRequestAndFaults) {
  const auto bytes = minute(1);
  std::set<int> types;
  for (const auto& body : bodies_of(bytes)) types.insert(body.size() > 1 ? body[1] : -1);
  for (int i = 0; i < kz_message_count; ++i) {
    const kz_message_info& info = kz_messages[i];
    // The loader takes 3 s each time, and is rare.
    if ((info.code & KZ_REPLY) || info.code == KZ_TYPE_loader) continue;
    EXPECT_TRUE(types.count(info.code)) << info.name;
  }
  EXPECT_TRUE(std::any_of(types.begin(), types.end(), [](int type) {
    return type >= 0 && kz_message_find(static_cast<u8>(type)) == nullptr;
  })) << "a type that does not exist";

  int damaged = 0, framing_errors = 0;
  States longest_silence = 0;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    framing_errors += bytes[i].framing_error ? 1 : 0;
    const u8 outcome = kz_receive(&receiver, bytes[i].value, 0);
    damaged += outcome != KZ_RECEIVE_MORE && outcome != KZ_RECEIVE_FRAME ? 1 : 0;
    if (i > 0) longest_silence = std::max(longest_silence, bytes[i].at - bytes[i - 1].at);
  }
  EXPECT_GT(damaged, 100);
  EXPECT_GT(framing_errors, 0);
  // Longer than the longest limit of the link watchdog, 1 s.
  EXPECT_GT(longest_silence, 1000 * States{KZ_STATES_PER_TICK});
}

TEST(RandomHost, SameSeedSameBytes) {
  const auto same = [](const SerialByte& a, const SerialByte& b) {
    return a.value == b.value && a.at == b.at && a.framing_error == b.framing_error;
  };
  const auto first = minute(1), second = minute(1), other = minute(2);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin(), second.end(), same));
  EXPECT_FALSE(std::equal(first.begin(), first.end(), other.begin(), other.end(), same));
}

TEST(RandomAnalog, WalksJumpsAndBreaks) {
  RandomAnalog analog(3);
  bool low = false, high = false, jumped = false;
  double before = analog.ratio(0, 0);
  for (int t = 1; t < 200000; ++t) {
    analog.millisecond();
    const double now = analog.ratio(0, t * States{KZ_STATES_PER_TICK});
    low = low || now == 0.0;
    high = high || now == 1.0;
    jumped = jumped || std::abs(now - before) > 0.2;
    before = now;
  }
  EXPECT_TRUE(low);
  EXPECT_TRUE(high);
  EXPECT_TRUE(jumped);
  EXPECT_NEAR(analog.ratio(KZ_ANALOG_REFERENCE, 0), 0.5, 0.01);
}

}  // namespace
}  // namespace kaz::sim
