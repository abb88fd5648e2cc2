// Lateness is measured with a clock of the test, on which time passes only in waits and as the test wants.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <deque>

#include <gtest/gtest.h>

#include "host/link/lateness.h"
#include "host/link/stalling_testing.h"

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

// Bytes come at given times; waits end when they are due.
class FakeLine final : public Link, public Clock {
 public:
  std::deque<Time> arrivals;  // of a byte each, ascending
  int reads = 0;

  std::string name() const override { return "fake"; }
  Result<void> write(std::span<const std::uint8_t>) override { return {}; }
  Result<std::size_t> read(std::span<std::uint8_t>, Time deadline) override {
    ++reads;
    if (arrivals.empty() || arrivals.front() > std::max(deadline, now_)) {
      now_ = std::max(now_, deadline);
      return 0;
    }
    now_ = std::max(now_, arrivals.front());
    arrivals.pop_front();
    return 1;
  }
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }
  void pass(Time length) { now_ += length; }

 private:
  Time now_ = milliseconds(1000);
};

class Lateness : public ::testing::Test {
 protected:
  std::size_t read(Time length) {
    std::array<std::uint8_t, 8> bytes{};
    return meter_.read(bytes, meter_.now() + length).value();
  }
  void stall_next(Time length) {
    line_.stalls = 1;
    line_.length = length;
  }
  FakeLine fake_;
  StallingLine line_{fake_, fake_};
  LatenessMeter meter_{line_, line_};
};

TEST_F(Lateness, APunctualProgramHasNoExcuse) {
  fake_.arrivals = {milliseconds(1003), milliseconds(1031)};
  EXPECT_EQ(read(milliseconds(50)), 1u);
  EXPECT_EQ(fake_.now(), milliseconds(1003));
  EXPECT_EQ(read(milliseconds(50)), 1u);
  EXPECT_EQ(read(milliseconds(20)), 0u);
  EXPECT_EQ(fake_.now(), milliseconds(1051));
  EXPECT_TRUE(meter_.sleep_until(milliseconds(1100)));
  EXPECT_TRUE(meter_.sleep_until(milliseconds(900)));  // is over: at once
  EXPECT_EQ(read(milliseconds(-5)), 0u);               // only what is there already
  EXPECT_TRUE(meter_.write({}));
  EXPECT_EQ(meter_.longest(), Time::zero());
  EXPECT_EQ(meter_.excuse(), "");
}

// Somebody at a stand takes his time; what is late afterwards counts.
TEST_F(Lateness, WaitingForAPersonIsNone) {
  EXPECT_EQ(read(milliseconds(10)), 0u);
  fake_.pass(milliseconds(4000));
  meter_.waited();
  EXPECT_EQ(read(milliseconds(10)), 0u);
  EXPECT_EQ(meter_.longest(), Time::zero());
  EXPECT_EQ(meter_.excuse(), "");
  fake_.pass(milliseconds(40));
  EXPECT_EQ(read(milliseconds(10)), 0u);
  EXPECT_EQ(meter_.longest(), milliseconds(40));
}

TEST_F(Lateness, ASleepThatEndsLate) {
  stall_next(milliseconds(34));
  EXPECT_TRUE(meter_.sleep_until(milliseconds(1010)));
  EXPECT_EQ(meter_.longest(), milliseconds(34));
  EXPECT_EQ(meter_.excuse(),
            "this program was kept waiting for up to 34 ms at a time, and for 34 ms in total");
  meter_.begin();
  EXPECT_EQ(meter_.excuse(), "");
}

TEST_F(Lateness, AWaitThatEndsLateWithNothing) {
  stall_next(milliseconds(8));
  EXPECT_EQ(read(milliseconds(20)), 0u);
  EXPECT_EQ(meter_.longest(), milliseconds(8));
  EXPECT_EQ(fake_.now(), milliseconds(1020)) << "the stall is a part of the wait";
}

// The byte was there after 3 ms, of a wait of 50; the program saw it after 33.
TEST_F(Lateness, BytesThatAreReadLateDoNotHideIt) {
  fake_.arrivals = {milliseconds(1003)};
  line_.pause = milliseconds(1003);  // not in the first slice
  stall_next(milliseconds(30));
  EXPECT_EQ(read(milliseconds(50)), 1u);
  EXPECT_GE(meter_.longest(), milliseconds(30) - LatenessMeter::kSlice);
  EXPECT_NE(meter_.excuse(), "");
}

TEST_F(Lateness, APauseBetweenTwoCalls) {
  EXPECT_TRUE(meter_.write({}));
  fake_.pass(milliseconds(12));
  EXPECT_TRUE(meter_.write({}));
  EXPECT_EQ(meter_.longest(), milliseconds(12));
  // Before begin() others may have computed.
  fake_.pass(milliseconds(500));
  meter_.begin();
  EXPECT_TRUE(meter_.write({}));
  EXPECT_EQ(meter_.excuse(), "");
}

TEST_F(Lateness, ManyShortOnesExcuseTooButRareOnesDoNot) {
  for (int i = 0; i < 10; ++i) {
    stall_next(milliseconds(3));
    EXPECT_TRUE(meter_.sleep_until(meter_.now() + milliseconds(20)));
  }
  EXPECT_EQ(meter_.total(), milliseconds(30));
  EXPECT_NE(meter_.excuse(), "");
  EXPECT_EQ(meter_.excuse(milliseconds(20)), "") << "each is borne by what is judged";
  EXPECT_TRUE(meter_.sleep_until(meter_.now() + milliseconds(2000)));  // 30 ms in 2.2 s
  EXPECT_EQ(meter_.excuse(), "");
}

TEST_F(Lateness, ATimersSlackIsNone) {
  for (int i = 0; i < 1000; ++i) {
    stall_next(std::chrono::microseconds(400));
    EXPECT_TRUE(meter_.sleep_until(meter_.now() + milliseconds(1)));
  }
  EXPECT_EQ(meter_.total(), Time::zero());
  EXPECT_EQ(meter_.excuse(), "");
}

TEST_F(Lateness, TheProgramAtTheOtherEnd) {
  Result<Time> lost = milliseconds(100);
  LatenessMeter meter(line_, line_, [&] { return lost; });
  EXPECT_EQ(meter.excuse(), "") << "it was lost before";
  lost = milliseconds(140);
  EXPECT_EQ(meter.excuse(), "the program at the other end fell behind by 40 ms");
  EXPECT_NE(meter.excuse(milliseconds(40)), "");
  EXPECT_EQ(meter.excuse(milliseconds(41)), "") << "borne by what is judged";
  meter.begin();
  EXPECT_EQ(meter.excuse(), "");
}

// Stopped by a debugger or SIGSTOP it replies to nothing, as if it had been killed.
TEST_F(Lateness, AProgramAtTheOtherEndThatDoesNotReply) {
  Result<Time> lost = Time::zero();
  LatenessMeter meter(line_, line_, [&] { return lost; });
  lost = fail(Fault::environment, "no reply");
  EXPECT_EQ(meter.excuse(),
            "the program at the other end of fake does not reply, because that program is stopped "
            "or has ended");
  EXPECT_TRUE(meter.other_end_gone());
  meter.begin();
  EXPECT_FALSE(meter.other_end_gone());
  lost = Time::zero();
  EXPECT_EQ(meter.excuse(), "the program at the other end was stopped") << "and goes on";
  EXPECT_FALSE(meter.other_end_gone());
}

}  // namespace
}  // namespace kaz::host
