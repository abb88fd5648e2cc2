// Times of bytes on the wire: 10 bits of 160 states each.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/serial_line.h"

#include <gtest/gtest.h>

#include <array>

#include "sim/runtime/time.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(SerialLine, ByteArrivesWithItsStopBit) {
  SerialLine line;
  line.write(Bytes{1, 2}, 1000);
  EXPECT_TRUE(line.take_for_board(2599).empty());
  const auto first = line.take_for_board(2600);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].value, 1);
  EXPECT_EQ(first[0].at, 2600);
  EXPECT_EQ(line.take_for_board(4200).at(0).at, 4200);
}

TEST(SerialLine, WaitsUntilTheWireIsFree) {
  SerialLine line;
  line.write(Bytes{1, 2, 3}, 0);
  line.write(Bytes{4}, 100);  // the wire is busy until 4800
  line.write(Bytes{5}, 20000);
  const auto bytes = line.take_for_board(100000);
  ASSERT_EQ(bytes.size(), 5u);
  EXPECT_EQ(bytes[3].at, 6400);
  EXPECT_EQ(bytes[4].at, 21600);
}

TEST(SerialLine, CountsWhatWaits) {
  SerialLine line;
  EXPECT_EQ(line.waiting(0), 0u);
  line.write(Bytes(10), 0);
  EXPECT_EQ(line.waiting(0), 10u);
  EXPECT_EQ(line.waiting(1599), 10u);
  EXPECT_EQ(line.waiting(1600), 9u);
  EXPECT_EQ(line.waiting(16000), 0u);
}

TEST(SerialLine, OneSecondCarries11520Bytes) {
  SerialLine line;
  line.write(Bytes(20000), 0);
  EXPECT_EQ(line.take_for_board(KZ_CLOCK_HZ).size(), 11520u);
}

TEST(SerialLine, HostReadsOnlyWhatHasArrived) {
  SerialLine line;
  line.from_board(std::array{SerialByte{7, 1600, false}, SerialByte{8, 3200, false}});
  std::array<std::uint8_t, 4> buffer{};
  EXPECT_FALSE(line.readable(1599));
  EXPECT_EQ(line.read(buffer, 1599), 0u);
  EXPECT_EQ(line.read(buffer, 3199), 1u);
  EXPECT_EQ(buffer[0], 7);
  EXPECT_EQ(line.read(buffer, 3200), 1u);
  EXPECT_EQ(buffer[0], 8);
}

TEST(SerialLine, EachSideHasItsOwnRate) {
  SerialLine line;
  line.set_host_bit(1920);  // 9600 baud
  line.write(Bytes{1, 2}, 0);
  EXPECT_EQ(line.waiting(0), 2u);
  const auto arrived = line.take_for_board(100'000);
  ASSERT_EQ(arrived.size(), 2u);
  EXPECT_EQ(arrived[1].at, 2 * 19200);
  EXPECT_EQ(arrived[1].bit_states, 1920);
  // The board talks at 9600 baud, and then at 115200, of which a slow receiver hears little.
  std::array<std::uint8_t, 4> buffer{};
  line.from_board(
      std::array{SerialByte{7, 19200, false, 1920}, SerialByte{0xff, 20800, false, 160}});
  EXPECT_EQ(line.read(buffer, 100'000), 1u);
  EXPECT_EQ(buffer[0], 7);
}

TEST(SerialLine, WrongSpeedDamagesEveryByte) {
  SerialLine line;
  line.write_garbled(Bytes{1, 2}, 0);
  for (const SerialByte& byte : line.take_for_board(10000)) EXPECT_TRUE(byte.framing_error);
}

TEST(Time, StatesAndNanoseconds) {
  EXPECT_EQ(time_of(KZ_STATES_PER_TICK), std::chrono::milliseconds(1));
  EXPECT_EQ(time_of(KZ_CLOCK_HZ), std::chrono::seconds(1));
  EXPECT_EQ(states_of(std::chrono::milliseconds(1)), KZ_STATES_PER_TICK);
  EXPECT_EQ(states_of(Time(1)), 1);  // 54 ns a state: never before the given time
  EXPECT_EQ(states_of(Time(54)), 1);
  EXPECT_EQ(states_of(Time(55)), 2);
}

}  // namespace
}  // namespace kaz::sim
