// TMR0 and TMR1 joined: 16-bit count mode and compare match count mode; their pins for clock and reset.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTcr0 = 0xffffc8, kTcr1 = 0xffffc9, kTcsr0 = 0xffffca, kTcsr1 = 0xffffcb;
constexpr std::uint32_t kTcora = 0xffffcc, kTcorb = 0xffffce, kTcnt = 0xffffd0;
constexpr std::uint32_t kStcr = 0xffffc3;
constexpr std::uint8_t kCmfb = 0x80, kCmfa = 0x40, kOvf = 0x20;

unsigned flags(Chip& chip, std::uint32_t tcsr) {
  return chip.peek(tcsr).value() & 0xe0u;
}

// A chip that has just written `last`, and stays.
Chip started(Program& p) {
  const std::uint32_t begun = end_of(p);
  p.nops(64).stay();
  Chip chip = make_chip(p);
  EXPECT_TRUE(run_to(chip, begun));
  return chip;
}

struct Clock {
  std::uint8_t cks, stcr;
  States divisor;
};
// Clock source of TMR1 (hardware manual, 8-bit timers, clock select).
constexpr Clock kClocks[] = {{1, 0, 8},   {1, 2, 2},    {2, 0, 64},
                             {2, 2, 128}, {3, 0, 1024}, {3, 2, 2048}};

TEST(TmrCascade, SixteenBitsCountInEveryClock) {
  for (const Clock& c : kClocks) {
    Program p;
    p.modules_on().out8(kStcr, c.stcr).out8(kTcr0, 0x04).out16(kTcnt, 0x12f0).out8(kTcr1, c.cks);
    Chip chip = started(p);
    const States start = chip.now();
    for (const std::int64_t counts : {1, 15, 16, 17, 271, 272, 3000}) {
      // The state before the count and the count itself; `bra .` may be one state late.
      for (const States early : {3, 0}) {
        chip.run_until((start / c.divisor + counts) * c.divisor - early);
        const auto done = chip.now() / c.divisor - start / c.divisor;
        EXPECT_EQ(chip.peek16(kTcnt), 0x12f0 + done) << c.divisor;
      }
    }
  }
}

// Both bytes have to match: 0302 counts 0x303 to its clear, and TCSR1's flag goes by the low byte.
TEST(TmrCascade, MatchAndClearGoByBothBytes) {
  struct Case {
    std::uint8_t tcr0, tcr1;
    std::int64_t turn;
  };
  constexpr Case cases[] = {
      {0x0c, 0x01, 0x303},   // clear at A
      {0x14, 0x01, 0x106},   // clear at B
      {0x0c, 0x09, 0x303},   // TMR1's own clear is ignored
      {0x04, 0x11, 0x10000}  // no clear
  };
  for (const Case& c : cases) {
    Program p;
    p.modules_on().out8(kStcr, 0x02);
    p.out16(kTcora, 0x0302).out16(kTcorb, 0x0105).out8(kTcr0, c.tcr0).out8(kTcr1, c.tcr1);
    Chip chip = started(p);
    const States first = chip.now() / 2;
    for (const std::int64_t at : {0x302, 0x303, 0x304, 0x605, 0x606, 0x607, 0x2000}) {
      chip.run_until((first + at) * 2);
      const std::int64_t counts = chip.now() / 2 - first;
      EXPECT_EQ(chip.peek16(kTcnt), counts % c.turn) << at << " turn " << c.turn;
    }
  }
}

TEST(TmrCascade, FlagsOfBothTimersAtTheirCounts) {
  Program p;
  p.modules_on().out8(kStcr, 0x02);
  p.out16(kTcora, 0x0102).out16(kTcorb, 0xfe05).out8(kTcr0, 0x04).out8(kTcr1, 0x01);
  Chip chip = started(p);
  const States first = chip.now() / 2;
  struct Look {
    std::int64_t counts;
    unsigned tcsr0, tcsr1;
  };
  constexpr Look looks[] = {
      {2, 0, 0},
      {3, 0, kCmfa},
      {5, 0, kCmfa},
      {6, 0, kCmfa | kCmfb},
      {0xff, 0, kCmfa | kCmfb},
      {0x100, 0, kCmfa | kCmfb | kOvf},
      {0x102, 0, kCmfa | kCmfb | kOvf},
      {0x103, kCmfa, kCmfa | kCmfb | kOvf},
      {0xfe05, kCmfa, kCmfa | kCmfb | kOvf},
      {0xfe06, kCmfa | kCmfb, kCmfa | kCmfb | kOvf},
      {0xffff, kCmfa | kCmfb, kCmfa | kCmfb | kOvf},
      {0x10000, kCmfa | kCmfb | kOvf, kCmfa | kCmfb | kOvf},
  };
  for (const Look& look : looks) {
    chip.run_until((first + look.counts) * 2);
    ASSERT_EQ(chip.now() / 2, first + look.counts);
    EXPECT_EQ(flags(chip, kTcsr0), look.tcsr0) << look.counts;
    EXPECT_EQ(flags(chip, kTcsr1), look.tcsr1) << look.counts;
  }
}

// A clear takes the place of the low byte's overflow.
TEST(TmrCascade, ClearAtTheEndOfTheLowByte) {
  Program p;
  p.modules_on().out8(kStcr, 0x02);
  p.out16(kTcora, 0x00ff).out8(kTcr0, 0x0c).out8(kTcr1, 0x01);
  Chip chip = started(p);
  const States first = chip.now() / 2;
  chip.run_until((first + 0x100) * 2);
  EXPECT_EQ(chip.peek16(kTcnt), chip.now() / 2 - first - 0x100);
  EXPECT_EQ(flags(chip, kTcsr0), kCmfa);
  EXPECT_EQ(flags(chip, kTcsr1), kCmfa | kCmfb);  // TCORB1 is FF too
}

// TMO0 goes by both bytes: high from match A to match B of the 16-bit counter.
TEST(TmrCascade, OutputGoesByBothBytes) {
  Program p;
  p.modules_on().out8(kStcr, 0x02);
  p.out16(kTcora, 0x0102).out16(kTcorb, 0x0205).out8(kTcsr0, 0x06).out8(kTcr0, 0x04);
  p.out8(kTcr1, 0x01);
  Chip chip = started(p);
  const States first = chip.now() / 2;
  for (const std::int64_t counts : {3, 0x102, 0x103, 0x205, 0x206, 0x400}) {
    chip.run_until((first + counts) * 2);
    const bool expected = counts >= 0x103 && counts < 0x206;
    EXPECT_EQ((chip.output(Port::p6).level >> 4 & 1) != 0, expected) << counts;
  }
}

// The overflow of the 16-bit counter requests OVI0 (vector 66) at its very state.
TEST(TmrCascade, InterruptsAtTheSixteenthBit) {
  Program p;
  p.modules_on().out8(kStcr, 0x02).out8(kTcr0, 0x24).out16(kTcnt, 0xfff0).out8(kTcr1, 0x01);
  const std::uint32_t begun = end_of(p);
  p.enable_interrupts().nops(100).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, begun));
  const States overflow = (chip.now() / 2 + 16) * 2;
  ASSERT_TRUE(run_to(chip, handler(66)));
  EXPECT_EQ(chip.now(), overflow + 4 + 8);
}

// TMR1 counts TMR0's matches A, in every clock of TMR0.
TEST(TmrCascade, CompareMatchCount) {
  constexpr Clock clocks[] = {{1, 0, 8},  {1, 1, 2},    {2, 0, 64},
                              {2, 1, 32}, {3, 0, 1024}, {3, 1, 256}};
  for (const Clock& c : clocks) {
    Program p;
    p.modules_on().out8(kStcr, c.stcr).out8(kTcora, 4).out8(kTcora + 1, 2).out8(kTcr1, 0x0c);
    p.out8(kTcr0, static_cast<std::uint8_t>(0x08 | c.cks));  // clear at A: a match each 5 counts
    Chip chip = started(p);
    const States first = chip.now() / c.divisor;
    for (const std::int64_t matches : {1, 2, 3, 4, 100}) {
      chip.run_until((first + 5 * matches) * c.divisor - 3);
      EXPECT_EQ(chip.peek(kTcnt + 1), (chip.now() / c.divisor - first) / 5 % 3) << c.divisor;
      chip.run_until((first + 5 * matches) * c.divisor);
      EXPECT_EQ(chip.peek(kTcnt + 1), matches % 3) << c.divisor;
      EXPECT_EQ(flags(chip, kTcsr1), matches >= 3 ? kCmfa : 0u);
    }
  }
}

TEST(TmrCascade, BothCascadedStandStill) {
  Program p;
  p.modules_on().out16(kTcnt, 0xfffe).out16(kTcr0, 0x0404);
  Chip chip = started(p);
  chip.run_until(100'000);
  EXPECT_EQ(chip.peek16(kTcnt), 0xfffe);
}

struct PinClock {
  unsigned n;
  std::uint8_t cks;
  int rising, falling;
};

// TMCI0 is P60, TMCI1 is P65.
TEST(TmrPins, ClockEdges) {
  constexpr PinClock cases[] = {{0, 5, 1, 0}, {0, 6, 0, 1}, {0, 7, 1, 1},
                                {1, 5, 1, 0}, {1, 6, 0, 1}, {1, 7, 1, 1}};
  for (const PinClock& c : cases) {
    Program p;
    p.modules_on().out8(kTcr0 + c.n, c.cks);
    Chip chip = started(p);
    const int bit = c.n == 0 ? 0 : 5;
    for (int k = 0; k < 3; ++k) {
      chip.set_input(Port::p6, bit, true);
      EXPECT_EQ(chip.peek(kTcnt + c.n), k * (c.rising + c.falling) + c.rising);
      chip.set_input(Port::p6, bit, false);
      EXPECT_EQ(chip.peek(kTcnt + c.n), (k + 1) * (c.rising + c.falling));
    }
    EXPECT_EQ(chip.peek(kTcnt + 1 - c.n), 0);
  }
}

// TMRI0 is P63, TMRI1 is P66: the rising edge clears where CCLR is 3.
TEST(TmrPins, ResetEdges) {
  for (const unsigned n : {0u, 1u}) {
    for (const unsigned cclr : {0u, 1u, 2u, 3u}) {
      Program p;
      p.modules_on().out8(kTcr0 + n, static_cast<std::uint8_t>(cclr << 3)).out8(kTcnt + n, 0x55);
      Chip chip = started(p);
      const int bit = n == 0 ? 3 : 6;
      chip.set_input(Port::p6, bit, true);
      EXPECT_EQ(chip.peek(kTcnt + n), cclr == 3 ? 0 : 0x55);
      EXPECT_EQ(flags(chip, kTcsr0 + n), 0u);
    }
  }
}

TEST(TmrPins, FallingEdgeDoesNotReset) {
  Program p;
  p.modules_on().out8(kTcr0, 0x18);
  const std::uint32_t begun = end_of(p);
  p.nops(20).out8(kTcnt, 0x55);
  const std::uint32_t written = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, begun));
  chip.set_input(Port::p6, 3, true);
  ASSERT_TRUE(run_to(chip, written));
  chip.set_input(Port::p6, 3, false);
  EXPECT_EQ(chip.peek(kTcnt), 0x55);
}

// In 16-bit count mode TMRI0 clears both bytes and TMRI1 none; edges at TMCI1 may be the clock.
TEST(TmrPins, CascadeByPins) {
  Program p;
  p.modules_on().out16(kTcnt, 0x12fe).out8(kTcr0, 0x1c).out8(kTcr1, 0x1d);
  Chip chip = started(p);
  for (int k = 0; k < 3; ++k) {
    chip.set_input(Port::p6, 5, true);
    chip.set_input(Port::p6, 5, false);
  }
  EXPECT_EQ(chip.peek16(kTcnt), 0x1301);
  chip.set_input(Port::p6, 6, true);
  EXPECT_EQ(chip.peek16(kTcnt), 0x1301);
  chip.set_input(Port::p6, 3, true);
  EXPECT_EQ(chip.peek16(kTcnt), 0x0000);
}

// A word written to TCORA0 and TCORA1 keeps away the matches that both would have in that state.
TEST(TmrCoincidence, WordToBothCompareRegisters) {
  const auto program = [](std::uint8_t tcora, int nops) {
    Program p;
    p.modules_on().out16(kTcora, static_cast<std::uint16_t>(tcora << 8 | tcora));
    p.out8(kStcr, 0x03).out16(kTcr0, 0x0101).nops(nops).out16(kTcora, 0xf0f0);
    return p;
  };
  // The word is written in an even state, where phi/2 counts.
  int nops = 1;
  std::uint8_t at_write = 0;
  for (States odd = 1; odd != 0; ++nops) {
    Program p = program(0xff, nops + 1);
    const std::uint32_t written = end_of(p);
    Chip chip = make_chip(p.nops(4).stay());
    ASSERT_TRUE(run_to(chip, written));
    odd = chip.now() % 2;
    at_write = chip.peek(kTcnt).value();
    ASSERT_EQ(chip.peek(kTcnt + 1), at_write);
  }
  for (const int before : {0, 1, 2}) {  // counts by which the match comes earlier
    Program p = program(static_cast<std::uint8_t>(at_write - 1 - before), nops);
    const std::uint32_t written = end_of(p);
    Chip chip = make_chip(p.nops(4).stay());
    ASSERT_TRUE(run_to(chip, written));
    ASSERT_EQ(chip.peek(kTcnt), at_write);
    const unsigned expected = before == 0 ? 0u : unsigned{kCmfa};
    EXPECT_EQ(flags(chip, kTcsr0), expected) << before;
    EXPECT_EQ(flags(chip, kTcsr1), expected) << before;
  }
}

TEST(TmrModuleStop, HoldsTheCountAndGoesOn) {
  Program p;
  p.modules_on().out8(kStcr, 0x03).out16(kTcr0, 0x0101).nops(20).out16(kMstpcr, 0x1000);
  const std::uint32_t off = end_of(p);
  p.nops(200).out16(kMstpcr, 0x0000);
  const std::uint32_t on = end_of(p);
  p.nops(10).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, off));
  const std::uint16_t held = chip.peek16(kTcnt).value();
  EXPECT_GT(held, 0);
  ASSERT_TRUE(run_to(chip, on));
  EXPECT_EQ(chip.peek16(kTcnt), held);
  const States back = chip.now();
  chip.run_until(back + 8);
  EXPECT_EQ(chip.peek(kTcnt), static_cast<std::uint8_t>((held >> 8) + (back + 8) / 2 - back / 2));
}

}  // namespace
}  // namespace kaz::h8s::testing
