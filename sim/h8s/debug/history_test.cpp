// Every state visited backwards equals the one recorded forwards, inputs from outside included.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/history.h"

#include <random>

#include "sim/h8s/debug/debug_testing.h"

namespace kaz::h8s::testing {
namespace {

struct Place {
  States now;
  Registers registers;
  std::vector<std::uint8_t> ram;
  bool operator==(const Place&) const = default;
};

Place place(const Chip& chip) {
  Place p{chip.now(), chip.registers(), {}};
  for (std::uint32_t at = 0xffe080; at < 0x1000000; at += at == 0xffefff ? 0xe51 : 1)
    p.ram.push_back(chip.peek(at).value_or(0));
  return p;
}

TEST(History, BackwardsIsForwardsReversed) {
  Chip chip = busy_chip();
  chip.set_analog([n = 0](int, States) mutable { return (++n % 16) / 16.0; });
  History history(chip, {500, 8});
  std::vector<Place> places;
  std::mt19937 random(1);
  while (chip.now() < 12'000) {
    places.push_back(place(chip));
    if (random() % 50 == 0) chip.set_input(Port::p6, static_cast<int>(random() % 8), random() % 2);
    if (random() % 300 == 0) {
      chip.poke(kRamData + 0x100, static_cast<std::uint8_t>(random()));
    }
    // Inputs are recorded at the time at which they were applied.
    places.back() = place(chip);
    ASSERT_EQ(history.step().why, Halt::Why::reached);
  }
  const Place last = place(chip);
  for (std::size_t k = places.size(); k-- > 0;) {
    ASSERT_EQ(history.step_back().why, Halt::Why::reached) << k;
    ASSERT_EQ(place(chip), places[k]) << k;
  }
  EXPECT_EQ(history.step_back().why, Halt::Why::begin);
  EXPECT_TRUE(history.replaying());
  for (std::size_t k = 0; k < places.size(); ++k) {
    ASSERT_EQ(place(chip), places[k]) << k;
    ASSERT_EQ(history.step().why, Halt::Why::reached);
  }
  EXPECT_EQ(place(chip), last);
  for (int n = 0; n < 30; ++n) {
    const std::size_t k = random() % places.size();
    ASSERT_TRUE(history.back_to(places[k].now).has_value());
    ASSERT_EQ(place(chip), places[k]) << k;
  }
  EXPECT_FALSE(history.back_to(last.now + 1).has_value());
  EXPECT_FALSE(history.replaying() && history.end() != last.now);
}

TEST(History, ForgetsItsOldestPartBeyondTheLimitOfRecords) {
  Chip chip = busy_chip();
  History history(chip, {500, 8, 300});
  for (int n = 0; chip.now() < 20'000; ++n) {
    chip.set_input(Port::p6, n % 8, n % 3 == 0);
    ASSERT_EQ(history.step().why, Halt::Why::reached);
  }
  const Place last = place(chip);
  const States begin = history.begin();
  EXPECT_GT(begin, 15'000u) << "an input every few states: 300 of them are less than 5,000 states";
  ASSERT_LT(begin, last.now);
  // What is kept is still exact.
  ASSERT_TRUE(history.back_to(begin).has_value());
  EXPECT_EQ(history.step_back().why, Halt::Why::begin);
  ASSERT_EQ(history.run_until(last.now).why, Halt::Why::reached);
  EXPECT_EQ(place(chip), last);
  EXPECT_FALSE(history.back_to(begin - 1).has_value());
}

TEST(History, BreakpointsAndWatchesBackwards) {
  Chip chip = busy_chip();
  History history(chip, {1000, 12});
  const Triggers stop_at{{handler(52)}, {}};
  const Triggers watch{{}, {{0xffe102, 2, false, true}}};
  std::vector<States> breaks, writes;
  while (chip.now() < 6'000) {
    const Halt halt = history.run_until(6'000, stop_at);
    if (halt.why == Halt::Why::breakpoint) breaks.push_back(chip.now());
  }
  EXPECT_GT(breaks.size(), 20u);
  ASSERT_TRUE(history.back_to(0).has_value());
  while (history.run_until(6'000, watch).why == Halt::Why::watch) {
    EXPECT_EQ(chip.registers().pc, busy_loop() + 12);  // behind mov.l er0,@0xffe100:16
    writes.push_back(chip.now() - 5);                  // I 3, M 2
  }
  EXPECT_GT(writes.size(), 100u);
  for (std::size_t k = breaks.size(); k-- > 0;) {
    ASSERT_EQ(history.reverse_continue(stop_at).why, Halt::Why::breakpoint);
    ASSERT_EQ(chip.now(), breaks[k]);
    EXPECT_EQ(chip.registers().pc, handler(52));
  }
  EXPECT_EQ(history.reverse_continue(stop_at).why, Halt::Why::begin);
  ASSERT_TRUE(history.back_to(history.end()).has_value());
  for (std::size_t k = writes.size(); k-- > 0;) {
    const Halt halt = history.reverse_continue(watch);
    ASSERT_EQ(halt.why, Halt::Why::watch);
    EXPECT_EQ(halt.address, 0xffe102u);
    ASSERT_EQ(chip.registers().pc, busy_loop() + 6);
    ASSERT_EQ(chip.now(), writes[k]);
  }
}

TEST(History, AChangeInThePastMakesANewFuture) {
  Chip chip = busy_chip();
  History history(chip, {1000, 12});
  history.run_until(5'000);
  ASSERT_TRUE(history.back_to(2'000).has_value());
  Registers r = chip.registers();
  r.er[0] = 0;
  chip.set_registers(r);
  EXPECT_FALSE(history.replaying());
  const Place fork = place(chip);
  history.run_until(4'000);
  const Place later = place(chip);
  ASSERT_TRUE(history.back_to(fork.now).has_value());
  EXPECT_EQ(place(chip), fork);
  history.run_until(4'000);
  EXPECT_EQ(place(chip), later);
}

TEST(History, SleepIsOneStepBackAndInputsEndIt) {
  Program p;
  p.out8(0xffffc2, 0x01).enable_interrupts().word(0x0180).stay();
  Chip chip = make_chip(p);
  History history(chip, {10'000, 12});
  history.run_until(150'000);
  chip.set_input(Port::p4, 2, true);  // IRQ0 is low by default: make an edge
  chip.set_input(Port::p4, 2, false);
  history.run_until(150'500);
  const States end = chip.now();
  std::vector<States> back;
  while (history.step_back().why == Halt::Why::reached) back.push_back(chip.now());
  EXPECT_EQ(back.back(), 0);
  ASSERT_GT(back.size(), 5u);
  history.run_until(end);
  EXPECT_EQ(chip.now(), end);
}

TEST(History, LoadBeginsItAnew) {
  Chip chip = busy_chip();
  History history(chip);
  history.run_until(3'000);
  chip.power_on();
  EXPECT_EQ(history.step_back().why, Halt::Why::begin);
  history.run_until(100);
  EXPECT_EQ(history.step_back().why, Halt::Why::reached);
}

}  // namespace
}  // namespace kaz::h8s::testing
