// A wait in simulated time ends soon after the interrupt, and changes nothing where there is none.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/interruptible.h"

#include <gtest/gtest.h>

#include "host/link/wall_clock.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

// Steps of a millisecond; an interrupt comes at a time of its own.
class Simulated final : public Clock, public Link {
 public:
  explicit Simulated(Interrupt& interrupt) : interrupt_(interrupt) {}
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    while (now_ < t) step();
    return {};
  }
  std::string name() const override { return "simulated"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    written += bytes.size();
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    while (true) {
      if (now_ >= byte_at && byte_at > Time(0)) {
        bytes[0] = 42;
        byte_at = Time(0);
        return 1;
      }
      if (now_ >= deadline) return 0;
      step();
    }
  }

  Time byte_at{0}, interrupt_at{0};
  std::size_t written = 0;

 private:
  void step() {
    now_ += 1ms;
    if (now_ == interrupt_at) interrupt_.request();
  }
  Interrupt& interrupt_;
  Time now_{0};
};

TEST(Interruptible, WaitsAsWithoutIt) {
  Interrupt interrupt;
  Simulated line(interrupt);
  InterruptibleClock clock(line, interrupt);
  InterruptibleLink link(line, line, interrupt);
  ASSERT_TRUE(clock.sleep_until(1234ms));
  EXPECT_EQ(clock.now(), 1234ms);
  EXPECT_TRUE(clock.sleep_until(100ms)) << "a time that has passed";
  EXPECT_EQ(clock.now(), 1234ms);
  line.byte_at = 1300ms;
  std::uint8_t byte[1] = {};
  EXPECT_EQ(link.read(byte, 2000ms).value_or(0), 1u);
  EXPECT_EQ(clock.now(), 1300ms) << "a byte ends the wait";
  EXPECT_EQ(link.read(byte, 2000ms).value_or(9), 0u);
  EXPECT_EQ(clock.now(), 2000ms);
}

TEST(Interruptible, EndsALongWaitInItsMiddle) {
  Interrupt interrupt;
  Simulated line(interrupt);
  InterruptibleClock clock(line, interrupt);
  InterruptibleLink link(line, line, interrupt);
  line.interrupt_at = 500ms;
  const auto slept = clock.sleep_until(1h);
  ASSERT_FALSE(slept);
  EXPECT_EQ(slept.error().fault, Fault::interrupted);
  EXPECT_LE(clock.now(), 500ms + kInterruptSlice);
  std::uint8_t byte[1] = {};
  EXPECT_FALSE(link.read(byte, 1h));
  EXPECT_TRUE(link.write(byte)) << "motors can be switched off";
  EXPECT_EQ(line.written, 1u);
  const Time before = clock.now();
  {
    const CleanUp clean_up(interrupt, 1h);
    EXPECT_TRUE(clock.sleep_until(before + 20ms));
    EXPECT_TRUE(link.read(byte, before + 30ms));
  }
  EXPECT_FALSE(link.read(byte, 1h));
  EXPECT_EQ(clock.now(), before + 30ms);
}

TEST(Interruptible, AWithdrawnRequestEndsNoWait) {
  Interrupt interrupt;
  WallClock clock(&interrupt);
  interrupt.request();
  interrupt.request();
  EXPECT_FALSE(clock.sleep_until(clock.now() + 1h));
  interrupt.withdraw();
  EXPECT_TRUE(clock.sleep_until(clock.now() + 1ms));
  interrupt.request();
  EXPECT_FALSE(clock.sleep_until(clock.now() + 1h));
}

TEST(Interruptible, ACleanUpHasItsTime) {
  Interrupt interrupt;
  Simulated line(interrupt);
  InterruptibleClock clock(line, interrupt);
  interrupt.request();
  const CleanUp clean_up(interrupt, 20ms);
  const auto began = std::chrono::steady_clock::now();
  while (clock.sleep_until(clock.now() + 1ms)) {
    ASSERT_LT(std::chrono::steady_clock::now() - began, 10s);
  }
  EXPECT_GE(std::chrono::steady_clock::now() - began, 19ms);
}

}  // namespace
}  // namespace kaz::host
