// FRT, 8-bit timers, PWM and watchdogs against the counts that the fact sheet states.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/pwm.h"

namespace kaz::h8s::testing {
namespace {

// FRT at phi/8 with clear at A and OCRA = 2303: a match each 18432 states (1 ms at 18.432 MHz).
Program frt_program() {
  Program p;
  p.modules_on()
      .out16(0xffff94, 2303)
      .out8(0xffff96, 0x01)
      .out8(0xffff91, 0x01)
      .out8(0xffff90, 0x09);
  p.enable_interrupts();
  return p;
}

TEST(Frt, PeriodIsExact) {
  Program p = frt_program();
  p.stay();
  Chip chip = make_chip(p);
  // Handler: read TCSR, clear OCFA, return.  btst/bclr #3,@TCSR:8 ; rte
  chip.poke(handler(52), std::vector<std::uint8_t>{0x7f, 0x91, 0x72, 0x30, 0x56, 0x70});
  std::vector<States> entries;
  chip.set_hook(handler(52), [&](Chip& c) {
    entries.push_back(c.now());
    return HookAction::go_on;
  });
  chip.run_until(10 * 18432 + 1000);
  ASSERT_EQ(entries.size(), 10u);
  // The loop `bra .` has boundaries each 2 states, the request comes at a multiple of 8 from the
  // reset.
  for (std::size_t k = 1; k < entries.size(); ++k)
    EXPECT_NEAR(entries[k] - entries[k - 1], 18432, 2);
  EXPECT_NEAR(entries[9] - entries[0], 9 * 18432, 2);
}

TEST(Frt, FlagClearsOnlyAfterItWasReadAsOne) {
  // Wait for OCFA, write 0 (no effect), read, write 0 (clears).
  Program p;
  p.modules_on().out16(0xffff94, 9).out8(0xffff96, 0x00).nops(200);
  p.out8(0xffff91, 0x00);
  const std::uint32_t unread = end_of(p);
  p.in8(0xffff91).out8(0xffff91, 0x00);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, unread));
  EXPECT_EQ(chip.peek(0xffff91).value() & 0x08, 0x08);
  ASSERT_TRUE(run_to(chip, end_of(p) - 2));
  EXPECT_EQ(chip.peek(0xffff91).value() & 0x08, 0x00);
}

TEST(Frt, CountsAndCaptures) {
  Program p;
  p.modules_on().out8(0xffff96, 0x82).out16(0xffff92, 0);  // phi/32, capture A on rising edges
  const std::uint32_t at = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, at));
  const States start = chip.now();
  chip.run_until(start + 3200);
  const unsigned count = chip.peek16(0xffff92).value();
  EXPECT_NEAR(count, 100, 1);
  chip.set_input(Port::p6, 2, true);
  chip.run_until(start + 6400);
  EXPECT_EQ(chip.peek16(0xffff98), count);
  EXPECT_EQ(chip.peek(0xffff91).value() & 0x80, 0x80);
}

// TMR0 at phi/8, period 100 counts, high from match A to match B.
TEST(Tmr, OutputShareFollowsTheRegisters) {
  struct Case {
    std::uint8_t tcora, tcorb, tcr, tcsr;
    double share;
  };
  const Case cases[] = {
      {99, 24, 0x09, 0x06, 0.25},   // clear at A; A: high, B: low; high for counts 0..24
      {99, 24, 0x09, 0x09, 0.75},   // A: low, B: high
      {99, 200, 0x09, 0x06, 1.0},   // B never comes
      {199, 99, 0x11, 0x03, 0.0},   // clear at B before A ever matches: level stays low
      {99, 50, 0x09, 0x03, 0.5},    // toggle at A
      {255, 63, 0x01, 0x06, 0.25},  // free running 256 counts
      {0, 0, 0x09, 0x0c, 0.5},      // every count a match; toggle wins
  };
  for (const Case& c : cases) {
    Program p;
    p.modules_on().out8(0xffffcc, c.tcora).out8(0xffffce, c.tcorb).out8(0xffffca, c.tcsr);
    p.out8(0xffffc8, c.tcr);
    p.stay();
    Chip chip = make_chip(p);
    chip.run_until(200);
    EXPECT_TRUE(chip.tmo_driven(0));
    EXPECT_DOUBLE_EQ(chip.tmo_high_share(0), c.share) << int(c.tcora) << " " << int(c.tcorb);
    // The same by reading the pin at each state over whole periods, in the steady state.
    const States from = 8 * 2048 * 2;
    chip.run_until(from);
    const States span = 8 * 2 *
                        (((c.tcr >> 3 & 3) == 1)   ? c.tcora + 1
                         : ((c.tcr >> 3 & 3) == 2) ? c.tcorb + 1
                                                   : 256);
    States high = 0;
    for (States t = 0; t < span; t += 2) {
      chip.run_until(from + t);
      high += chip.output(Port::p6).level >> 4 & 1;
    }
    EXPECT_NEAR(static_cast<double>(high) / static_cast<double>(span / 2), c.share, 0.02);
  }
}

TEST(Tmr, PortDrivesThePinWhileNoOutputIsSelected) {
  Program p;
  p.out8(0xffffb9, 0x10).out8(0xffffbb, 0x10).stay();
  Chip chip = make_chip(p);
  EXPECT_FALSE(chip.tmo_driven(0));
  chip.run_until(100);
  EXPECT_TRUE(chip.tmo_driven(0));
  EXPECT_EQ(chip.tmo_high_share(0), 1.0);
}

TEST(Tmr, CascadeCountsSixteenBits) {
  Program p;  // TMR1 at phi/8, TMR0 counts its overflows
  p.modules_on().out8(0xffffc8, 0x04).out8(0xffffc9, 0x01).stay();
  Chip chip = make_chip(p);
  chip.run_until(8 * 256 * 7 + 500);
  EXPECT_EQ(chip.peek(0xffffd0), 7);
}

TEST(Pwm, PulseCountIsTheDataForEachValue) {
  for (unsigned data = 0; data < 256; ++data) {
    unsigned high = 0;
    for (unsigned count = 0; count < 256; ++count)
      high += pwm_pulse(static_cast<std::uint8_t>(data), count, true);
    EXPECT_EQ(high, data);
  }
  // Lower nibble 3 lengthens pulses 7, 11 and 15 by one count before their rising edge.
  EXPECT_TRUE(pwm_pulse(0x23, 7 * 16 + 13, true));
  EXPECT_FALSE(pwm_pulse(0x23, 3 * 16 + 13, true));
  EXPECT_TRUE(pwm_pulse(0x23, 3 * 16 + 14, true));
}

TEST(Pwm, DutyAndOwnershipOfThePin) {
  Program p;
  p.modules_on().out8(0xffffb0, 0xff);          // port 1 outputs, latches 0
  p.out8(0xffffd6, 0x22).out8(0xffffd7, 0x40);  // PWDR2 = 64
  p.out8(0xffffd6, 0xa3).out8(0xffffd7, 0x40);  // PWDR3 = 64, clock phi
  p.out8(0xffffd5, 0x08);                       // PW3 inverted
  p.out8(0xffffb2, 0x02);                       // P11 high
  const std::uint32_t before = end_of(p);
  p.out8(0xffffd3, 0x0c).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, before));
  EXPECT_EQ(chip.pw_high_counts(2), 0);
  EXPECT_EQ(chip.pw_high_counts(1), 256);
  std::vector<OutputChange> changes;
  chip.on_output([&](const OutputChange& c) { changes.push_back(c); });
  chip.run_until(chip.now() + 20);
  EXPECT_EQ(chip.pw_high_counts(2), 64);
  EXPECT_EQ(chip.pw_high_counts(3), 192);
  EXPECT_FALSE(chip.pw_driven(8));
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].unit, OutputChange::Unit::pwm);
  // The waveform at the pin over one conversion period of 256 states.
  const States from = chip.now();
  int high = 0;
  for (States t = 0; t < 256; t += 2) {
    chip.run_until(from + t);
    high += chip.output(Port::p1).level >> 2 & 1;
  }
  EXPECT_NEAR(high, 32, 16);
}

// phi/64, from TCNT = 0: overflow after 256 counts.
TEST(Wdt, ResetsTheChipWithRamKept) {
  Program p;
  p.words({0x7900, 0xa569, 0x6b80, 0xffa8});  // TCSR := WT/IT, TME, RST/NMI, phi/64
  p.stay();
  Chip chip = make_chip(p);
  chip.poke(kRamData, 0x77);
  std::vector<States> resets;
  chip.on_watchdog_reset([&](States at) { resets.push_back(at); });
  chip.run_until(256 * 64 - 100);
  EXPECT_EQ(resets.size(), 0u);
  chip.run_until(256 * 64 + 100 + 518);
  ASSERT_EQ(resets.size(), 1u);
  EXPECT_NEAR(resets[0], 256 * 64 + 518, 64);
  EXPECT_EQ(chip.reset_cause(), ResetCause::watchdog);
  EXPECT_EQ(chip.peek(kRamData), 0x77);
  EXPECT_EQ(chip.peek(0xffffc4).value() & 0x08, 0);  // XRST
}

TEST(Wdt, KeyedServiceKeepsItQuiet) {
  Program p;
  p.words({0x7900, 0xa569, 0x6b80, 0xffa8});
  const std::uint32_t loop = end_of(p);
  p.words({0x7900, 0x5a00, 0x6b80, 0xffa8});
  const auto back = static_cast<std::uint8_t>(loop - end_of(p) - 2);
  p.word(static_cast<std::uint16_t>(0x4000 | back));
  Chip chip = make_chip(p);
  chip.run_until(1'000'000);
  EXPECT_EQ(chip.reset_cause(), ResetCause::power_on);
  EXPECT_TRUE(chip.misuse().empty());
}

TEST(Wdt, WrongKeyAndByteWritesDoNothingAndAreReported) {
  Program p;
  p.words({0x7900, 0x1269, 0x6b80, 0xffa8}).out8(0xffffa8, 0x69).stay();
  Chip chip = make_chip(p);
  chip.run_until(100);
  EXPECT_EQ(chip.peek(0xffffa8), 0x00);
  ASSERT_EQ(chip.misuse().size(), 2u);
  EXPECT_NE(chip.misuse()[0].text.find("key"), std::string::npos);
  EXPECT_EQ(chip.misuse()[1].address, 0xffffa8u);
}

TEST(Wdt, IntervalModeRequestsAnInterrupt) {
  Program p;
  p.words({0x7900, 0xa520, 0x6b80, 0xffa8});  // TME, interval, phi/2
  p.enable_interrupts().stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, handler(25)));
  EXPECT_NEAR(chip.now(), 512 + 4 + 8 + 6, 6);
}

}  // namespace
}  // namespace kaz::h8s::testing
