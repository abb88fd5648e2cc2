// The clock of another machine: bytes, clients that come and go.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/followed_clock.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <bit>
#include <chrono>

#include "shared/base/no_descriptors_testing.h"
#include "sim/runtime/serving/socket_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::array<std::uint8_t, 8> bytes_of(Time time) {
  return std::bit_cast<std::array<std::uint8_t, 8>>(std::int64_t{time.count()});
}

TEST(ClockStream, TimesComeInAnyPieces) {
  ClockStream stream;
  const auto first = bytes_of(milliseconds(5)), second = bytes_of(milliseconds(7));
  EXPECT_FALSE(stream.latest());
  ASSERT_TRUE(stream.feed(std::span(first).first(3)));
  EXPECT_FALSE(stream.latest());
  ASSERT_TRUE(stream.feed(std::span(first).subspan(3)));
  EXPECT_EQ(stream.latest(), milliseconds(5));
  ASSERT_TRUE(stream.feed(second));
  EXPECT_EQ(stream.latest(), milliseconds(7));
}

TEST(ClockStream, RefusesATimeThatIsNone) {
  ClockStream back;
  ASSERT_TRUE(back.feed(bytes_of(milliseconds(5))));
  EXPECT_FALSE(back.feed(bytes_of(milliseconds(4))));
  EXPECT_FALSE(ClockStream().feed(bytes_of(Time(-1))));
  EXPECT_FALSE(ClockStream().feed(bytes_of(Time(INT64_MAX))));
}

TEST(FollowedClock, StandsStillWithoutMessagesAndFollowsTheNextClient) {
  const TestFolder folder;
  auto opened = FollowedClock::open(folder.file("clock"));
  ASSERT_TRUE(opened) << opened.error().message;
  FollowedClock& clock = **opened;
  const auto next = [&clock] {  // up to 10 s on a busy machine
    bool another = false;
    const Time before = clock.now();
    for (int i = 0; i < 200 && clock.now() == before && !another; ++i)
      another = clock.poll(milliseconds(50)).value();
    return another;
  };
  EXPECT_FALSE(clock.poll(Time(0)).value());
  {
    const Descriptor machine = connect_to(folder.file("clock"));
    ASSERT_EQ(::send(machine.get(), bytes_of(seconds(9)).data(), 8, 0), 8);
    EXPECT_TRUE(next()) << "the first time of a machine";
    EXPECT_EQ(clock.now(), seconds(9));
    EXPECT_FALSE(clock.poll(milliseconds(1)).value());
    EXPECT_EQ(clock.now(), seconds(9));
    ASSERT_EQ(::send(machine.get(), bytes_of(seconds(10)).data(), 8, 0), 8);
    EXPECT_FALSE(next());
    EXPECT_EQ(clock.now(), seconds(10));
  }
  EXPECT_FALSE(clock.poll(milliseconds(1)).value());
  EXPECT_EQ(clock.now(), seconds(10));
  const Descriptor another = connect_to(folder.file("clock"));
  ASSERT_EQ(::send(another.get(), bytes_of(seconds(2)).data(), 8, 0), 8);
  EXPECT_TRUE(next());
  EXPECT_EQ(clock.now(), seconds(2));
}

// The world stands still while a client is silent: it must not be able to keep another one out.
TEST(FollowedClock, AnotherClientReplacesASilentOneAndNoneThatSends) {
  using Clock = std::chrono::steady_clock;
  const TestFolder folder;
  auto opened = FollowedClock::open(folder.file("clock"));
  ASSERT_TRUE(opened) << opened.error().message;
  FollowedClock& clock = **opened;
  const Descriptor first = connect_to(folder.file("clock"));
  EXPECT_FALSE(clock.poll(seconds(5)).value()) << "connected, and nothing more";
  const Descriptor second = connect_to(folder.file("clock"));
  ASSERT_EQ(::send(second.get(), bytes_of(seconds(7)).data(), 8, 0), 8);
  const auto poll_until = [&clock](Clock::time_point end, Time time, auto between) {
    while (Clock::now() < end && clock.now() != time) {
      ASSERT_TRUE(clock.poll(milliseconds(20)));
      between();
    }
  };
  const auto connected = Clock::now();
  poll_until(connected + seconds(20), seconds(7), [] {});
  EXPECT_EQ(clock.now(), seconds(7)) << "the second client has not been accepted";
  EXPECT_GE(Clock::now() - connected, FollowedClock::kMaxSilence - milliseconds(100));
  char byte = 0;
  EXPECT_EQ(::recv(first.get(), &byte, 1, 0), 0) << "the first one is disconnected";

  const Descriptor third = connect_to(folder.file("clock"));
  ASSERT_EQ(::send(third.get(), bytes_of(seconds(1)).data(), 8, 0), 8);
  Time sent = seconds(7);
  poll_until(Clock::now() + 2 * FollowedClock::kMaxSilence, seconds(1), [&] {
    sent += milliseconds(1);
    ::send(second.get(), bytes_of(sent).data(), 8, 0);
  });
  EXPECT_GT(clock.now(), seconds(7)) << "a client that sends was replaced";
}

TEST(FollowedClock, WithoutADescriptorItWaitsAndThenTakesTheClient) {
  const TestFolder folder;
  auto clock = FollowedClock::open(folder.file("clock"));
  ASSERT_TRUE(clock) << clock.error().message;
  Descriptor machine = unconnected();
  {
    const NoDescriptors none;
    machine = connect_to(folder.file("clock"), std::move(machine));
    ASSERT_EQ(::send(machine.get(), bytes_of(seconds(9)).data(), 8, 0), 8);
    int polls = 0;
    for (const auto end = std::chrono::steady_clock::now() + milliseconds(300);
         std::chrono::steady_clock::now() < end; ++polls)
      EXPECT_FALSE((*clock)->poll(milliseconds(50)).value());
    EXPECT_LT(polls, 20) << "it spins";
  }
  for (int i = 0; i < 100 && (*clock)->now() == Time(0); ++i)
    (void)(*clock)->poll(milliseconds(50));
  EXPECT_EQ((*clock)->now(), seconds(9));
}

}  // namespace
}  // namespace kaz::sim
