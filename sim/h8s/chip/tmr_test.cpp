// The four 8-bit timers: clocks, clears, outputs, coincidences, pulse measurement, to the state.
// SPDX-License-Identifier: Apache-2.0

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/timer8.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTconri = 0xfffffc, kTconro = 0xfffffd, kTconrs = 0xfffffe;

struct Registers8 {
  std::uint32_t tcr, tcsr, tcora, tcorb, tcnt;
  std::uint8_t tconrs;  // bank of FFF0..FFF7
};
constexpr Registers8 kTmr0{0xffffc8, 0xffffca, 0xffffcc, 0xffffce, 0xffffd0, 0};
constexpr Registers8 kTmr1{0xffffc9, 0xffffcb, 0xffffcd, 0xffffcf, 0xffffd1, 0};
constexpr Registers8 kTmrx{0xfffff0, 0xfffff1, 0xfffff6, 0xfffff7, 0xfffff4, 0};
constexpr Registers8 kTmry{0xfffff0, 0xfffff1, 0xfffff2, 0xfffff3, 0xfffff4, 0x80};

Program bank(const Registers8& t) {
  Program p;
  return p.modules_on().out8(kTconrs, t.tconrs);
}

struct Clock {
  const char* name;
  Registers8 timer;
  std::uint8_t cks, stcr;
  States divisor;
};

class TimerClock : public ::testing::TestWithParam<Clock> {};

// The prescaler runs from reset, so the count is the number of its edges since the write to TCR.
TEST_P(TimerClock, CountsEveryEdgeOfItsPrescaler) {
  const Clock& c = GetParam();
  Program p = bank(c.timer);
  p.out8(0xffffc3, c.stcr).out8(c.timer.tcr, c.cks);
  const std::uint32_t begun = end_of(p);
  p.nops(64).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, begun));
  const States start = chip.now();
  const auto expected = [&](States at) {
    return static_cast<std::uint8_t>(at / c.divisor - start / c.divisor);
  };
  for (int k = 0; k < 60; ++k) {
    EXPECT_EQ(chip.peek(c.timer.tcnt), expected(chip.now())) << chip.now();
    chip.step();
  }
  for (int k = 1; k < 9; ++k) {
    chip.run_until(start + k * 37 * c.divisor + k);
    EXPECT_EQ(chip.peek(c.timer.tcnt), expected(chip.now())) << chip.now();
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, TimerClock,
    ::testing::Values(Clock{"0_8", kTmr0, 1, 0, 8}, Clock{"0_2", kTmr0, 1, 1, 2},
                      Clock{"0_64", kTmr0, 2, 0, 64}, Clock{"0_32", kTmr0, 2, 1, 32},
                      Clock{"0_1024", kTmr0, 3, 0, 1024}, Clock{"0_256", kTmr0, 3, 1, 256},
                      Clock{"1_8", kTmr1, 1, 0, 8}, Clock{"1_2", kTmr1, 1, 2, 2},
                      Clock{"1_64", kTmr1, 2, 0, 64}, Clock{"1_128", kTmr1, 2, 2, 128},
                      Clock{"1_1024", kTmr1, 3, 0, 1024}, Clock{"1_2048", kTmr1, 3, 2, 2048},
                      Clock{"x_1", kTmrx, 1, 0, 1}, Clock{"x_2", kTmrx, 2, 0, 2},
                      Clock{"x_4", kTmrx, 3, 0, 4}, Clock{"y_4", kTmry, 1, 0, 4},
                      Clock{"y_256", kTmry, 2, 0, 256}, Clock{"y_2048", kTmry, 3, 0, 2048}),
    [](const auto& param) { return std::string("tmr") + param.param.name; });

TEST(Timer8, MatchTakesEffectAsTheCountLeavesTheValue) {
  Timer8 t;
  t.tcora = 9;
  t.tcr = 0x08;  // clear at A
  EXPECT_EQ(t.to_next(), 10);
  t.step(9);
  EXPECT_EQ(t.count, 9);
  EXPECT_EQ(t.flags.value(), 0);
  t.step(1);
  EXPECT_EQ(t.count, 0);
  EXPECT_EQ(t.flags.value(), TMR_TCSR::CMFA);
  EXPECT_EQ(t.turn(), 10);
}

TEST(Timer8, OverflowOnlyWhereTheCounterWraps) {
  Timer8 t;
  t.count = 0xff;
  t.tcora = 3;
  t.tcorb = 4;
  EXPECT_TRUE(t.step(1).overflow);
  EXPECT_EQ(t.flags.value(), TMR_TCSR::OVF);
  Timer8 cleared;  // cleared by the match at FF: no overflow
  cleared.count = 0xff;
  cleared.tcr = 0x08;
  EXPECT_FALSE(cleared.step(1).overflow);
  EXPECT_EQ(cleared.flags.value(), TMR_TCSR::CMFA | TMR_TCSR::CMFB);
}

// Both matches at once: toggle over 1 over 0 over none.
TEST(Timer8, SimultaneousMatchesHaveAnOrder) {
  for (unsigned a = 0; a < 4; ++a) {
    for (unsigned b = 0; b < 4; ++b) {
      for (const bool level : {false, true}) {
        const unsigned strongest = a > b ? a : b;
        const bool expected = strongest == 3   ? !level
                              : strongest == 2 ? true
                              : strongest == 1 ? false
                                               : level;
        EXPECT_EQ(timer_output(level, static_cast<std::uint8_t>(b << 2 | a), true, true), expected);
      }
    }
  }
}

// A write to TCNT in the state of a count wins; one to TCOR keeps the match of its state away. TMRX
// counts each state, so each write meets a count.
TEST(Tmr, WriteWinsOverACount) {
  Program p = bank(kTmrx);
  p.out8(kTmrx.tcr, 1).nops(7).out8(kTmrx.tcnt, 0x55);
  const std::uint32_t written = end_of(p);
  p.nops(3).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, written));
  EXPECT_EQ(chip.peek(kTmrx.tcnt), 0x55);
  chip.step();
  EXPECT_EQ(chip.peek(kTmrx.tcnt), 0x56);
}

TEST(Tmr, WriteToCompareRegisterKeepsTheMatchOfItsStateAway) {
  // From the write to TCR (count 0) to the end of the write to TCORA: 5 states. TCORA = 4 would match
  // in that very state, 3 one before.
  for (const auto& [value, matched] : {std::pair{4, false}, std::pair{3, true}}) {
    Program p = bank(kTmrx);
    p.out8(kTmrx.tcora, static_cast<std::uint8_t>(value));
    p.out8(kTmrx.tcr, 1).out8(kTmrx.tcora, 0xf0);
    const std::uint32_t written = end_of(p);
    p.nops(3).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, written));
    EXPECT_EQ(chip.peek(kTmrx.tcnt), 5);
    EXPECT_EQ((chip.peek(kTmrx.tcsr).value() & 0x40) != 0, matched) << value;
  }
}

TEST(Tmr, FlagsClearOnlyAfterTheyWereReadAsOne) {
  for (const Registers8& t : {kTmr0, kTmr1, kTmrx, kTmry}) {
    Program p = bank(t);
    p.out8(t.tcora, 2).out8(t.tcr, 1).nops(60).out8(t.tcsr, 0x00);
    const std::uint32_t unread = end_of(p);
    p.in8(t.tcsr).out8(t.tcr, 0).out8(t.tcsr, 0x00).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, unread));
    EXPECT_EQ(chip.peek(t.tcsr).value() & 0x40, 0x40);
    ASSERT_TRUE(run_to(chip, end_of(p) - 2));
    EXPECT_EQ(chip.peek(t.tcsr).value() & 0x40, 0x00);
  }
}

TEST(TmrY, EachInterruptHasItsVector) {
  const struct {
    std::uint8_t tcr, tcora, tcorb;
    unsigned vector;
  } cases[] = {{0x41, 10, 0xff, 72}, {0x81, 0xff, 10, 73}, {0x21, 0xff, 0xff, 74}};
  for (const auto& c : cases) {
    Program p = bank(kTmry);
    p.out8(kTmry.tcora, c.tcora).out8(kTmry.tcorb, c.tcorb).out8(kTmry.tcr, c.tcr);
    p.enable_interrupts().stay();
    Chip chip = make_chip(p);
    EXPECT_TRUE(run_to(chip, handler(c.vector))) << c.vector;
  }
}

TEST(TmrX, HasNoCompareOrOverflowInterrupt) {
  Program p = bank(kTmrx);
  p.out8(kTmrx.tcora, 10).out8(kTmrx.tcr, 0xe1).enable_interrupts();
  const std::uint32_t loop = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  chip.run_until(5000);
  EXPECT_EQ(chip.registers().pc, loop);
  EXPECT_EQ(chip.peek(kTmrx.tcsr).value() & 0xe0, 0xe0);
}

// One measurement: TICRR at the rising, TICRF at the falling edge of TMIX (P60), then ICF and ICIX.
TEST(TmrX, MeasuresAPulse) {
  Program p = bank(kTmry);
  p.out8(kTmry.tcsr, 0x10);  // TCSRY.ICIE
  p.out8(kTconrs, 0x00).out8(kTmrx.tcr, 3).out8(kTconri, 0x10).enable_interrupts();
  const std::uint32_t ready = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  const States start = chip.now();
  chip.run_until(start + 100);
  chip.set_input(Port::p6, 0, true);
  const std::uint8_t rise = chip.peek(kTmrx.tcnt).value();
  chip.run_until(start + 500);
  chip.set_input(Port::p6, 0, false);
  ASSERT_TRUE(run_to(chip, handler(75)));
  EXPECT_EQ(chip.peek(0xfffff2), rise);
  EXPECT_EQ(static_cast<std::uint8_t>(chip.peek(0xfffff3).value() - rise), 100);  // 400 states / 4
  EXPECT_EQ(chip.peek(kTmrx.tcsr).value() & 0x10, 0x10);                          // ICF
  EXPECT_EQ(chip.peek(kTconri).value() & 0x10, 0);                                // ICST
}

TEST(TmrX, DrivesItsPin) {
  Program p = bank(kTmrx);
  p.out8(kTmrx.tcora, 99).out8(kTmrx.tcorb, 24).out8(kTmrx.tcsr, 0x06).out8(kTmrx.tcr, 0x09);
  const std::uint32_t begun = end_of(p);
  p.nops(400).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, begun));
  const States start = chip.now();
  // phi, 100 counts: high from the match at A (99 -> 0) to the match at B (24 -> 25).
  for (int k = 0; k < 350; ++k) {
    const States since = chip.now() - start;
    const bool expected = since >= 100 && since % 100 < 25;
    EXPECT_EQ((chip.output(Port::p6).level >> 7 & 1) != 0, expected) << since;
    chip.step();
  }
}

TEST(TmrY, CountsItsPinWhereTisrSaysSo) {
  for (const bool enabled : {false, true}) {
    Program p = bank(kTmry);
    p.out8(0xfffff5, enabled ? 1 : 0).out8(kTmry.tcr, 5);  // rising edges of TMIY (P62)
    const std::uint32_t ready = end_of(p);
    p.stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, ready));
    for (int k = 0; k < 3; ++k) {
      chip.set_input(Port::p6, 2, true);
      chip.set_input(Port::p6, 2, false);
    }
    EXPECT_EQ(chip.peek(kTmry.tcnt), enabled ? 3 : 0);
  }
}

TEST(TmrXY, ModuleStopFreezesAndHides) {
  Program p = bank(kTmrx);
  p.out8(kTmrx.tcr, 1).out8(kTconro, 0x00).out16(kMstpcr, 0x0100);
  const std::uint32_t off = end_of(p);
  p.nops(100).in8(kTmrx.tcnt).out16(kMstpcr, 0x0000);
  const std::uint32_t on = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, off));
  const std::uint8_t held = chip.peek(kTmrx.tcnt).value();
  ASSERT_TRUE(run_to(chip, on));
  EXPECT_EQ(chip.peek(kTmrx.tcnt), held);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.misuse()[0].address, kTmrx.tcnt);
}

TEST(TimerConnection, SignalPathsAreReported) {
  Program p = bank(kTmrx);
  p.out8(kTconri, 0x20).out8(kTconro, 0x80).out8(kTconrs, 0x40).stay();
  Chip chip = make_chip(p);
  chip.run_until(200);
  EXPECT_EQ(chip.misuse().size(), 3u);
  EXPECT_EQ(chip.peek(kTconri), 0x20);
  EXPECT_EQ(chip.peek(kTconro), 0x80);
  EXPECT_EQ(chip.peek(kTconrs), 0x40);
}

}  // namespace
}  // namespace kaz::h8s::testing
