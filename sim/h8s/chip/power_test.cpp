// Software standby, watch mode, medium speed.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kSbycr = 0xffff84, kIscrl = 0xfffeed, kIer = 0xffffc2, kBrr = 0xffffd9;

// FRT at phi/2 and IRQ0 on falling edges, then SLEEP with `sbycr`.
Program standing_by(std::uint8_t sbycr) {
  Program p;
  p.modules_on().out8(kBrr, 4).out8(kIscrl, 0x01).out8(kIer, 0x01).out8(0xffff96, 0x00);
  p.out8(kSbycr, sbycr).enable_interrupts().word(0x0180).stay();
  return p;
}

std::int64_t frc(Chip& chip) {
  return chip.peek16(0xffff92).value();
}

// Clocks are stopped until the oscillator has settled after the wake-up; then the interrupt follows.
TEST(Standby, StopsClocksAndSettles) {
  constexpr States settle[] = {8192, 16384, 32768, 65536, 131072, 262144};
  for (std::uint8_t sts = 0; sts < 6; ++sts) {
    Chip chip = make_chip(standing_by(static_cast<std::uint8_t>(0x80 | sts << 4)));
    chip.set_input(Port::p4, 2, true);
    chip.run_until(1000);
    EXPECT_TRUE(chip.asleep());
    const std::int64_t count = frc(chip);
    EXPECT_LT(count, 60);
    chip.run_until(1'000'000);
    EXPECT_EQ(chip.now(), 1'000'000);
    EXPECT_EQ(frc(chip), count);
    EXPECT_EQ(chip.peek(kBrr), 0xff);  // the serial channel has lost its registers
    EXPECT_EQ(chip.peek(0xffff96), 0x00);
    chip.set_input(Port::p4, 2, false);
    ASSERT_TRUE(run_to(chip, handler(16)));
    EXPECT_EQ(chip.now(), 1'000'000 + settle[sts] + 8) << int{sts};
    EXPECT_NEAR(static_cast<double>(frc(chip) - count), 4, 1);  // the exception's 8 states
  }
}

TEST(Standby, NmiWakesAndMaskedIrqDoesNot) {
  Program p;
  p.out8(kIscrl, 0x01).out8(kIer, 0x01).out8(kSbycr, 0x80).word(0x0180).stay();
  Chip chip = make_chip(p);
  chip.set_input(Port::p4, 2, true);
  const Stop stop = chip.run_until(1000);
  EXPECT_EQ(stop.reason, Stop::Reason::asleep_forever);
  Chip nmi = make_chip(standing_by(0x80));
  nmi.set_input(Port::p4, 2, true);
  nmi.run_until(5000);
  nmi.set_nmi(false);
  ASSERT_TRUE(run_to(nmi, handler(7)));
  EXPECT_EQ(nmi.now(), 5000 + 8192 + 8);
}

TEST(Standby, ResumesTheSameAfterSaving) {
  Chip chip = make_chip(standing_by(0x80));
  chip.set_input(Port::p4, 2, true);
  chip.run_until(5000);
  Chip copy = chip.clone();
  for (Chip* c : {&chip, &copy}) {
    c->set_input(Port::p4, 2, false);
    c->run_until(5000 + 4000);
    c->run_until(20'000);
  }
  EXPECT_EQ(chip.registers(), copy.registers());
  EXPECT_EQ(frc(chip), frc(copy));
}

// Watch mode: WDT1 counts the subclock on and wakes by its interval interrupt.
TEST(Standby, WatchModeWakesByWdt1) {
  Program p;
  p.out16(0xffffea, 0xa530).out8(kSbycr, 0x80).enable_interrupts().word(0x0180).stay();
  Options o;
  o.subclock_states = 500;
  Chip chip = make_chip(p, o);
  ASSERT_TRUE(run_to(chip, handler(26)));
  EXPECT_EQ(chip.now(), 256 * 2 * 500 + 8192 + 8);
}

// SCK2-0: the CPU at a part of the clock, timers at all of it.
TEST(MediumSpeed, CpuSlowsAndTimersDoNot) {
  for (std::uint8_t select = 0; select < 6; ++select) {
    Program p;
    p.modules_on().out8(0xffff96, 0x00).out8(kSbycr, select);
    const std::uint32_t nops = end_of(p);
    p.nops(100).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, nops));
    const States start = chip.now();
    const std::int64_t count = frc(chip);
    ASSERT_TRUE(run_to(chip, nops + 200));
    EXPECT_EQ(chip.now() - start, 100 << select);
    EXPECT_NEAR(static_cast<double>(frc(chip) - count), 50 << select, 1);
  }
}

TEST(Modes, ExpandedModeIsReported) {
  Chip chip = make_chip(Program().out8(0xffffc5, 0x80).stay());
  chip.run_until(100);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.peek(0xffffc5), 0x82);
}

}  // namespace
}  // namespace kaz::h8s::testing
