// The free-running timer's finer rules: coincidences, capture edges and masking, automatic addition.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTcsr = 0xffff91, kFrc = 0xffff92, kOcr = 0xffff94, kTcr = 0xffff96,
                        kTocr = 0xffff97, kIcra = 0xffff98, kIcrc = 0xffff9c, kIcrd = 0xffff9e;

// An edge at FTIA..FTID (P62..P65).
void edge(Chip& chip, int n, bool level) {
  chip.set_input(Port::p6, 2 + n, level);
}

TEST(Frt, WriteToFrcWinsOverTheCount) {
  // phi/2: of the eight programs that differ by one NOP each, half end their write in a state of a
  // count.
  for (int shift = 0; shift < 8; ++shift) {
    Program p;
    p.modules_on().nops(shift).out16(kFrc, 0x1234);
    const std::uint32_t written = end_of(p);
    p.nops(4).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, written));
    EXPECT_EQ(chip.peek16(kFrc), 0x1234);
    const States at = chip.now();
    chip.step();
    EXPECT_EQ(chip.peek16(kFrc), 0x1234 + (at + 1) / 2 - at / 2);
  }
}

// OCRA written in the state in which its old value would have matched: no flag; a state later: flag.
TEST(Frt, WriteToOcrKeepsTheMatchOfItsStateAway) {
  int suppressed = 0, matched = 0;
  for (int late = 0; late < 4; ++late) {
    Program p;
    p.modules_on().out16(kOcr, 0x0010).out16(kFrc, 0x0010 - 2).nops(late);
    p.out16(kOcr, 0x8000);
    const std::uint32_t written = end_of(p);
    p.stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, written));
    const unsigned frc = chip.peek16(kFrc).value();
    const bool flag = (chip.peek(kTcsr).value() & 0x08) != 0;
    // The match takes effect as FRC goes from 10 to 11; if that is this very state it is kept away.
    const bool just_now = frc == 0x11 && chip.now() % 2 == 0;
    if (just_now) ++suppressed;
    if (flag) ++matched;
    EXPECT_EQ(flag, frc > 0x10 && !just_now) << frc;
  }
  EXPECT_GT(suppressed, 0);
  EXPECT_GT(matched, 0);
}

TEST(Frt, EdgesAreChosenPinByPin) {
  Program p;
  p.modules_on().out8(kTcr, 0xa0);  // FTIA and FTIC rising, FTIB and FTID falling
  const std::uint32_t ready = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  for (int n = 0; n < 4; ++n) edge(chip, n, true);
  EXPECT_EQ(chip.peek(kTcsr).value() & 0xf0, 0xa0);
  for (int n = 0; n < 4; ++n) edge(chip, n, false);
  EXPECT_EQ(chip.peek(kTcsr).value() & 0xf0, 0xf0);
}

// BUFEA: ICRC takes what ICRA held; with IEDGA and IEDGC apart both edges of FTIA capture.
TEST(Frt, BufferedCaptureTakesBothEdges) {
  Program p;
  p.modules_on().out8(kTcr, 0x88);  // IEDGA rising, IEDGC falling, BUFEA
  const std::uint32_t ready = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  chip.run_until(300);
  edge(chip, 0, true);
  const unsigned rise = chip.peek16(kIcra).value();
  EXPECT_EQ(rise, chip.peek16(kFrc));
  chip.run_until(500);
  edge(chip, 0, false);
  EXPECT_EQ(chip.peek16(kIcra), chip.peek16(kFrc));
  EXPECT_EQ(chip.peek16(kIcrc), rise);
}

// ICRDMS: after a capture D no other until FRC has reached ICRD + 2 OCRDM.
TEST(Frt, CaptureDIsMaskedForTwiceOcrdm) {
  Program p;
  p.modules_on().out8(kTcr, 0x10);       // FTID rising
  p.out8(kTocr, 0xa0).out16(kIcrc, 50);  // ICRDMS, ICRS: OCRDM = 50
  const std::uint32_t ready = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  const States start = chip.now();
  const auto pulse = [&](States at) {
    chip.run_until(at);
    edge(chip, 3, true);
    const unsigned captured = chip.peek16(kIcrd).value();
    edge(chip, 3, false);
    return captured;
  };
  const unsigned first = pulse(start + 100);
  EXPECT_EQ(pulse(start + 100 + 196), first);         // 98 counts later: masked
  EXPECT_GE(pulse(start + 100 + 204), first + 102u);  // 102 counts: taken, masks again
}

// OCRAMS: each match A adds OCRAR and OCRAF in turn, and OLVLA may follow: a pulse train without the
// CPU.
TEST(Frt, OcraMovesOnByItself) {
  Program p;
  p.modules_on().out8(kTocr, 0x60);        // OCRAMS, ICRS
  p.out16(kIcra, 30).out16(0xffff9a, 70);  // OCRAR, OCRAF
  p.out16(kOcr, 0x0100).out16(kFrc, 0x00f0);
  const std::uint32_t ready = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  const States start = chip.now();
  const unsigned steps[] = {0x0100, 0x0100 + 30, 0x0100 + 100, 0x0100 + 130};
  EXPECT_EQ(chip.peek16(kOcr), steps[0]);
  chip.run_until(start + 2 * 20);
  EXPECT_EQ(chip.peek16(kOcr), steps[1]);
  chip.run_until(start + 2 * 60);
  EXPECT_EQ(chip.peek16(kOcr), steps[2]);
  chip.run_until(start + 2 * 130);
  EXPECT_EQ(chip.peek16(kOcr), steps[3]);
}

TEST(Frt, OutputPinsTakeTheirLevelAtTheFirstMatch) {
  Program p;
  p.modules_on().out16(kOcr, 40).out8(kTocr, 0x0a);  // OEA, OLVLA = 1
  const std::uint32_t ready = end_of(p);
  p.nops(200).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  EXPECT_EQ(chip.output(Port::p6).driven & 0x02, 0x02);
  while ((chip.peek(kTcsr).value() & 0x08) == 0) {
    EXPECT_EQ(chip.output(Port::p6).level & 0x02, 0) << chip.now();
    ASSERT_EQ(chip.step().reason, Stop::Reason::reached);
  }
  EXPECT_EQ(chip.output(Port::p6).level & 0x02, 0x02);
}

}  // namespace
}  // namespace kaz::h8s::testing
