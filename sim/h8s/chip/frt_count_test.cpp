// The free-running timer's counting: clocks, clear, flags, TEMP and banks, module stop.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTcsr = 0xffff91, kFrc = 0xffff92, kOcr = 0xffff94, kTcr = 0xffff96,
                        kTocr = 0xffff97, kIcra = 0xffff98, kOcraf = 0xffff9a, kOcrdm = 0xffff9c;
constexpr std::uint8_t kOcfa = 0x08, kOcfb = 0x04, kOvf = 0x02;

Chip started(Program& p) {
  const std::uint32_t begun = end_of(p);
  p.nops(1500).stay();
  Chip chip = make_chip(p);
  EXPECT_TRUE(run_to(chip, begun));
  return chip;
}

TEST(FrtCount, EachClock) {
  constexpr States divisors[] = {2, 8, 32};
  for (std::uint8_t cks = 0; cks < 3; ++cks) {
    Program p;
    p.modules_on().out8(kTcr, cks).out16(kFrc, 0x0100);
    Chip chip = started(p);
    const States start = chip.now(), d = divisors[cks];
    for (int k = 0; k < 200; ++k) {
      EXPECT_EQ(chip.peek16(kFrc), 0x0100 + chip.now() / d - start / d) << d;
      chip.step();
    }
  }
}

TEST(FrtCount, FtciCountsRisingEdges) {
  Program p;
  p.modules_on().out8(kTcr, 3).out16(kFrc, 0xfffe);
  Chip chip = started(p);
  for (unsigned k = 1; k < 5; ++k) {
    chip.set_input(Port::p6, 0, true);
    EXPECT_EQ(chip.peek16(kFrc), (0xfffe + k) & 0xffff);
    EXPECT_EQ((chip.peek(kTcsr).value() & kOvf) != 0, k >= 2);
    chip.set_input(Port::p6, 0, false);
    EXPECT_EQ(chip.peek16(kFrc), (0xfffe + k) & 0xffff);
  }
}

// phi/2 from FRC = 0: each flag as FRC leaves the value; CCLRA makes turns of OCRA + 1.
TEST(FrtCount, FlagsAndClear) {
  struct Case {
    unsigned ocra, ocrb;
    bool clear;
    std::int64_t a, b;  // counts to OCFA and OCFB, 0: never
    std::int64_t turn;
  };
  constexpr Case cases[] = {{9, 20, false, 10, 21, 0x10000},
                            {9, 20, true, 10, 0, 10},  // cleared before B
                            {20, 9, true, 21, 10, 21},
                            {15, 15, true, 16, 16, 16},
                            {0, 0, true, 1, 1, 1}};
  for (const Case& c : cases) {
    Program p;
    p.modules_on().out16(kOcr, static_cast<std::uint16_t>(c.ocra)).out8(kTocr, 0x10);
    p.out16(kOcr, static_cast<std::uint16_t>(c.ocrb)).out16(kFrc, 0xff00);
    // The flags so far are cleared with CCLRA set, then FRC starts.
    p.in8(kTcsr).out8(kTcsr, c.clear ? 1 : 0).out16(kFrc, 0);
    Chip chip = started(p);
    const States first = chip.now() / 2;
    while (chip.now() / 2 < first + 60) {
      const std::int64_t counts = chip.now() / 2 - first;
      const unsigned expected =
          (c.a && counts >= c.a ? kOcfa : 0u) | (c.b && counts >= c.b ? kOcfb : 0u);
      EXPECT_EQ(chip.peek(kTcsr).value() & 0xfe, expected) << c.ocra << " at " << counts;
      EXPECT_EQ(chip.peek16(kFrc), counts % c.turn) << c.ocra;
      chip.step();
    }
  }
}

TEST(FrtCount, OverflowButNotWhereTheClearComesInstead) {
  for (const bool clear : {false, true}) {
    Program p;
    p.modules_on().out8(kTcsr, clear ? 1 : 0).out16(kFrc, 0xfff0);  // OCRA, OCRB: FFFF
    Chip chip = started(p);
    const States wrap = (chip.now() / 2 + 16) * 2;
    chip.run_until(wrap - 1);
    EXPECT_EQ(chip.peek(kTcsr).value() & 0xfe, 0);
    chip.run_until(wrap);
    EXPECT_EQ(chip.peek16(kFrc), 0);
    EXPECT_EQ(chip.peek(kTcsr).value() & 0xfe, kOcfa | kOcfb | (clear ? 0 : kOvf));
  }
}

// Each of the seven flags by itself: 0 written before it was read as 1 does nothing, 1 never sets.
TEST(FrtCount, FlagsClearAfterTheyWereRead) {
  for (const bool read_first : {false, true}) {
    Program p;
    p.modules_on().out16(kOcr, 2).out8(kTocr, 0x10).out16(kOcr, 3).out8(kTcr, 0xf0);
    p.out16(kFrc, 0xfff0).nops(100).out8(kTcr, 0xf3);  // all set; then no clock
    if (read_first) p.in8(kTcsr);
    const std::uint32_t set = end_of(p);
    for (int bit = 1; bit < 8; ++bit) p.out8(kTcsr, static_cast<std::uint8_t>(~(1u << bit)));
    p.stay();
    Chip chip = make_chip(p);
    for (int bit = 2; bit < 6; ++bit) chip.set_input(Port::p6, bit, false);
    chip.run_until(100);
    for (int bit = 2; bit < 6; ++bit) chip.set_input(Port::p6, bit, true);
    ASSERT_TRUE(run_to(chip, set));
    ASSERT_EQ(chip.peek(kTcsr).value() & 0xfe, 0xfe);
    for (int bit = 1; bit < 8; ++bit) {
      chip.step();
      chip.step();
      const unsigned left = read_first ? 0xfeu & ~((2u << bit) - 1) : 0xfeu;
      EXPECT_EQ(chip.peek(kTcsr).value() & 0xfe, left) << bit;
    }
  }
}

// The lower byte belongs to the upper one read or written before it, whatever the counter does.
TEST(FrtCount, TempHoldsTheOtherByte) {
  Program p;
  p.modules_on().out8(kFrc, 0x12).nops(30).out8(kFrc + 1, 0x34);
  const std::uint32_t written = end_of(p);
  p.in8(kFrc);
  const std::uint32_t upper = end_of(p);
  p.nops(40).in8(kFrc + 1);
  const std::uint32_t lower = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, written));
  EXPECT_EQ(chip.peek16(kFrc), 0x1234);
  ASSERT_TRUE(run_to(chip, upper));
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x12u);
  const unsigned then = chip.peek(kFrc + 1).value();
  ASSERT_TRUE(run_to(chip, lower));
  EXPECT_EQ(chip.registers().er[0] & 0xff, then);
  EXPECT_GT(chip.peek(kFrc + 1), then);
}

// An upper byte alone changes nothing.
TEST(FrtCount, UpperByteWaitsForTheLower) {
  Program p;
  p.modules_on().out8(kOcr, 0x12).stay();
  Chip chip = make_chip(p);
  chip.run_until(100);
  EXPECT_EQ(chip.peek16(kOcr), 0xffff);
}

TEST(FrtCount, BanksShareAddresses) {
  Program p;
  p.modules_on().out16(kOcr, 0x1111).out8(kTocr, 0x30).out16(kOcr, 0x2222);
  p.out16(kIcra, 0x3333).out16(kOcraf, 0x4444).out16(kOcrdm, 0x0055);
  const std::uint32_t second = end_of(p);
  p.out8(kTocr, 0x00);
  const std::uint32_t first = end_of(p);
  p.out16(kIcra, 0x6666).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, second));
  EXPECT_EQ(chip.peek16(kOcr), 0x2222);
  EXPECT_EQ(chip.peek16(kIcra), 0x3333);
  EXPECT_EQ(chip.peek16(kOcraf), 0x4444);
  EXPECT_EQ(chip.peek16(kOcrdm), 0x0055);
  ASSERT_TRUE(run_to(chip, first));
  EXPECT_EQ(chip.peek16(kOcr), 0x1111);
  EXPECT_EQ(chip.peek16(kIcra), 0x0000);
  EXPECT_TRUE(chip.misuse().empty());
  chip.run_until(chip.now() + 40);
  EXPECT_EQ(chip.peek16(kIcra), 0x0000);  // read-only, and reported as misuse
  ASSERT_EQ(chip.misuse().size(), 1u);
}

TEST(FrtCount, ModuleStopHoldsTheCount) {
  Program p;
  p.modules_on().out16(kFrc, 0).nops(50).out16(kMstpcr, 0x2000);
  const std::uint32_t off = end_of(p);
  p.nops(300).out16(kMstpcr, 0x0000);
  const std::uint32_t on = end_of(p);
  p.nops(50).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, off));
  const std::uint16_t held = chip.peek16(kFrc).value();
  EXPECT_GT(held, 20);
  ASSERT_TRUE(run_to(chip, on));
  const States back = chip.now();
  EXPECT_EQ(chip.peek16(kFrc), held);
  chip.run_until(back + 21);
  EXPECT_EQ(chip.peek16(kFrc), held + (back + 21) / 2 - back / 2);
}

}  // namespace
}  // namespace kaz::h8s::testing
